//! What the station learns before and during a lot: factors from the references, lags from golden parts,
//! and from every good part where the next fine ramp goes.

use super::gates::{Gates, Told};
use super::trouble::Alarm;
use super::wants::Wants;
use super::{Plan, Station};
use crate::dut::em_relay::Calibration;
use crate::dut::em_relay::calibration::Lags;
use crate::dut::em_relay::measure::bench::UNTAUGHT_FINE_V;
use crate::dut::em_relay::settings::GoldenPart;
use crate::dut::em_relay::{golden, reference};
use crate::dut::verdict::Verdict;
use crate::handling::ledger::Kind;
use crate::handling::wants::Judged;
use crate::handling::{Ledger, Place};
use crate::instrument::act::Runner;
use crate::units::RigTime;
use std::collections::VecDeque;
use std::sync::Arc;

impl Station {
    /// Factors from the references.
    pub(super) fn conclude_references(
        &mut self,
        now: RigTime,
        runner: &Runner,
    ) -> Result<(), String> {
        let made_at = self.plan.epoch_us + i64::try_from(now.0).unwrap_or(i64::MAX);
        let (valid, gain) = (self.plan.valid_us, self.plan.voltage_gain);
        let calibration = reference::conclude(&self.bench, &runner.readings, made_at, valid, gain)?;
        self.bench.calibration = Arc::new(Calibration {
            simulated: self.plan.simulated,
            ..calibration
        });
        Ok(())
    }

    /// References and golden parts are measured again with the next start; the golden parts have to lie in front.
    pub(super) fn recalibrate(&mut self) {
        self.plan.calibrated = false;
        self.referenced = false;
        let all: VecDeque<_> = self.plan.golden.iter().cloned().collect();
        self.lot.golden_planned += all.len().saturating_sub(self.lot.golden_left.len()) as u64;
        self.lot.golden_left = all;
        self.golden_run = golden::GoldenRun::default();
        self.bench.calibration = Arc::new(Calibration {
            lags: None,
            ..(*self.bench.calibration).clone()
        });
    }

    /// What the parts judged in this turn say of the rig and of the lot.
    pub(super) fn learn(&mut self, wants: &mut Wants) {
        let mut told = Told::default();
        for judged in &wants.record.parts.judged {
            match &judged.part.kind {
                Kind::Golden(serial) if self.lot.gates.is_checking() => {
                    self.check(judged, serial, &mut told);
                }
                Kind::Golden(_) | Kind::Lot(_) if judged.part.interrupted.is_some() => {}
                Kind::Golden(_) => self.learn_from(judged, &mut wants.record.calibrated, &mut told),
                Kind::Lot(_) => {
                    self.count_discards(judged, &mut told);
                    self.follow_probes(judged);
                    self.learn_from(judged, &mut wants.record.calibrated, &mut told);
                }
            }
        }
        wants.notes.trouble.extend(told.trouble);
        wants.record.checked = told.checked;
    }

    /// Golden parts teach the lags, every part the place of the fine ramp.
    fn learn_from(
        &mut self,
        judged: &Judged,
        calibrated: &mut Option<Calibration>,
        told: &mut Told,
    ) {
        let findings = &judged.findings;
        // A slow or sticking part would spoil the place of the ramp for all that follow.
        if judged.verdict == Verdict::Pass || matches!(judged.part.kind, Kind::Golden(_)) {
            let lot = matches!(judged.part.kind, Kind::Lot(_));
            let both = [
                (findings.operate, &mut self.coarse.0, &mut self.of_lot.0),
                (findings.release, &mut self.coarse.1, &mut self.of_lot.1),
            ];
            for (ramp, law, of_lot) in both {
                if let Some((coarse, fine)) = ramp.and_then(|it| Some((it.coarse, it.fine?))) {
                    law.learn(&coarse, fine);
                    if lot {
                        of_lot.learn(&coarse, fine);
                    }
                }
            }
        }
        if let Kind::Golden(serial) = &judged.part.kind {
            let known = self.plan.golden.iter().find(|part| part.serial == *serial);
            let reference = self.bench.reference_temperature();
            let learned = match known {
                Some(part) => self.golden_run.learn(part, reference, findings),
                None => Err(format!("golden part {serial} has no certificate")),
            };
            if let Err(why) = learned {
                told.trouble.push(Alarm::calibration(&why));
                return;
            }
        }
        let still_golden = matches!(judged.part.kind, Kind::Golden(_));
        self.take_lags(still_golden, calibrated, told);
    }

    /// Certificate of the golden part in the nest, while golden parts teach and are not checked.
    pub(super) fn teaching<'a>(
        plan: &'a Plan,
        gates: &Gates,
        ledger: &Ledger,
    ) -> Option<&'a GoldenPart> {
        match ledger.part(Place::NEST).map(|part| &part.kind) {
            Some(Kind::Golden(serial)) if !gates.is_checking() => {
                plan.golden.iter().find(|part| part.serial == *serial)
            }
            Some(Kind::Golden(_) | Kind::Lot(_)) | None => None,
        }
    }

    /// The last golden part was interrupted: what the others taught has to do, or the calibration has failed.
    pub(super) fn end_golden_run(&mut self, wants: &mut Wants) {
        if self.referenced && self.lot.golden_left.is_empty() && self.is_calibrating() {
            let mut told = Told::default();
            self.take_lags(true, &mut wants.record.calibrated, &mut told);
            wants.notes.trouble.extend(told.trouble);
        }
    }

    fn take_lags(&mut self, golden: bool, calibrated: &mut Option<Calibration>, told: &mut Told) {
        match self.new_lags(golden) {
            Ok((lags, complete)) => {
                let calibration = Calibration {
                    lags: Some(lags),
                    probe_contact_ohm: match golden {
                        true => self.golden_run.probe_contact_ohm(),
                        false => self.bench.calibration.probe_contact_ohm,
                    },
                    ..(*self.bench.calibration).clone()
                };
                if complete {
                    *calibrated = Some(calibration.clone());
                }
                self.bench.calibration = Arc::new(calibration);
            }
            Err(why) => told.trouble.push(Alarm::calibration(&why)),
        }
    }

    /// Lags for the next part, and whether the golden run is complete with this one.
    fn new_lags(&self, golden: bool) -> Result<(Lags, bool), String> {
        let bench = &self.bench;
        if !golden {
            let known = (bench.operate_lag(), bench.release_lag());
            let lags = Lags {
                operate: known.0.taught(self.coarse.0, self.of_lot.0),
                release: known.1.taught(self.coarse.1, self.of_lot.1),
            };
            return Ok((lags, false));
        }
        if self.lot.golden_left.is_empty() {
            let lags = self
                .golden_run
                .lags(&self.plan.golden, &bench.accuracy, self.coarse)?;
            return Ok((lags, true));
        }
        let fine_v = self.golden_run.fine_v().unwrap_or(UNTAUGHT_FINE_V);
        let lags = Lags {
            operate: golden::interim(self.coarse.0, fine_v.0),
            release: golden::interim(self.coarse.1, fine_v.1),
        };
        Ok((lags, false))
    }
}
