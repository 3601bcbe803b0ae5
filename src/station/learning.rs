//! What the station learns before and during a lot: factors from the references, lags from golden parts,
//! and from every good part where the next fine ramp goes.

use super::act::{Doing, Runner};
use super::ledger::Kind;
use super::moves::Move;
use super::trouble::Alarm;
use super::wants::{Inputs, Wants};
use super::{Phase, Station, golden, reference};
use crate::gauge::Calibration;
use crate::gauge::calibration::Lags;
use crate::gauge::verdict::Verdict;
use crate::units::RigTime;
use std::sync::Arc;

impl Station {
    pub(super) fn measure_references(
        &mut self,
        now: RigTime,
        inputs: &Inputs,
        mut runner: Box<Runner>,
        wants: &mut Wants,
    ) -> Phase {
        match runner.step(now, inputs.job.as_ref(), inputs.image) {
            Doing::Job(job) => wants.job = Some(job),
            Doing::Wait(until) => wants.wake_at = Some(until),
            Doing::Busy => {}
            Doing::Trouble(why) => wants.alarms.push(Alarm::calibration(&why)),
            Doing::Done => return self.conclude_references(now, &runner, wants),
        }
        Phase::Reference(runner)
    }

    fn conclude_references(&mut self, now: RigTime, runner: &Runner, wants: &mut Wants) -> Phase {
        let made_at = self.plan.epoch_us + i64::try_from(now.0).unwrap_or(i64::MAX);
        let (valid, gain) = (self.plan.valid_us, self.plan.voltage_gain);
        match reference::conclude(&self.bench, &runner.readings, made_at, valid, gain) {
            Ok(calibration) => {
                let calibration = Calibration {
                    simulated: self.plan.simulated,
                    ..calibration
                };
                self.bench.calibration = Arc::new(calibration);
                wants.motions.push(Move::ProbesDown);
                Phase::ReferenceDown
            }
            Err(why) => {
                wants.alarms.push(Alarm::calibration(&why));
                Phase::Ended
            }
        }
    }

    /// Golden parts teach the lags, every part the place of the fine ramp.
    pub(super) fn learn(&mut self, wants: &mut Wants) {
        for judged in &wants.judged {
            let findings = &judged.findings;
            // A slow or sticking part would spoil the place of the ramp for all that follow.
            if judged.verdict == Verdict::Pass || matches!(judged.part.kind, Kind::Golden(_)) {
                findings
                    .operate
                    .into_iter()
                    .for_each(|ramp| self.coarse.0.learn(ramp));
                findings
                    .release
                    .into_iter()
                    .for_each(|ramp| self.coarse.1.learn(ramp));
            }
            if let Kind::Golden(serial) = &judged.part.kind {
                let known = self.plan.golden.iter().find(|part| part.serial == *serial);
                let reference = self.bench.reference_temperature();
                let learned = match known {
                    Some(part) => self.golden_run.learn(part, reference, findings),
                    None => Err(format!("golden part {serial} has no certificate")),
                };
                if let Err(why) = learned {
                    wants.alarms.push(Alarm::calibration(&why));
                    return;
                }
            }
            let still_golden = matches!(judged.part.kind, Kind::Golden(_));
            match self.new_lags(still_golden) {
                Ok((lags, complete)) => {
                    let calibration = Calibration {
                        lags: Some(lags),
                        ..(*self.bench.calibration).clone()
                    };
                    if complete {
                        wants.calibrated = Some(calibration.clone());
                    }
                    self.bench.calibration = Arc::new(calibration);
                }
                Err(why) => wants.alarms.push(Alarm::calibration(&why)),
            }
        }
    }

    /// Lags for the next part, and whether the golden run is complete with this one.
    fn new_lags(&self, golden: bool) -> Result<(Lags, bool), String> {
        let bench = &self.bench;
        if !golden {
            let known = (bench.operate_lag(), bench.release_lag());
            let lags = Lags {
                operate: golden::place(known.0.fine_v, known.0.at_v, self.coarse.0),
                release: golden::place(known.1.fine_v, known.1.at_v, self.coarse.1),
            };
            return Ok((lags, false));
        }
        if self.golden_left.is_empty() {
            let lags = self
                .golden_run
                .lags(&self.plan.golden, &bench.accuracy, self.coarse)?;
            return Ok((lags, true));
        }
        let lags = Lags {
            operate: golden::interim(bench.operate_lag(), self.coarse.0),
            release: golden::interim(bench.release_lag(), self.coarse.1),
        };
        Ok((lags, false))
    }
}
