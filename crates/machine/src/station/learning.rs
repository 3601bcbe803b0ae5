//! Learning before and during a lot: factors from the references, and corrections from reference parts and parts of
//! the lot.

use super::Station;
use super::gates::Outcome;
use super::trouble::Alarm;
use super::turn::TurnOutput;
use crate::dut::device::{CalibrationFault, Made};
use crate::dut::{Calibration, Verdict};
use crate::handling::Place;
use crate::handling::ledger::PartRole;
use crate::instrument::act::Runner;
use units::RigTime;

impl Station {
    /// Computes the factors from the readings of the references.
    pub(super) fn conclude_references(
        &mut self,
        now: RigTime,
        runner: &Runner,
    ) -> Result<(), CalibrationFault> {
        let made = Made {
            at_us: self.plan.wall_clock_us(now),
            valid_us: self.plan.valid_us,
            simulated: self.plan.simulated,
        };
        self.device.conclude_references(&runner.readings, made)
    }

    /// Discards the calibration, so that the next start measures references and reference parts again.
    pub(super) fn recalibrate(&mut self) {
        self.plan.calibrated = false;
        self.referenced = false;
        self.prompts.calibrate_again();
        self.lot.plan_references(&self.plan.reference_serials);
        self.device.forget_calibration();
    }

    /// Learns from the parts judged in this turn, and applies the gates to them.
    pub(super) fn learn(&mut self, output: &mut TurnOutput) {
        let mut outcome = Outcome::default();
        for judged in &output.record.parts.judged {
            match &judged.part.role {
                PartRole::Reference(serial) if self.lot.gates.is_checking() => {
                    self.check(judged, serial, &mut outcome);
                }
                PartRole::Reference(_) | PartRole::Lot(_)
                    if judged.part.why_untested().is_some() => {}
                PartRole::Reference(serial) => {
                    let last = self.lot.reference_left.is_empty();
                    let learned = self.device.learn_reference(serial, &judged.record, last);
                    calibrated(learned, &mut output.record.calibrated, &mut outcome);
                }
                PartRole::Lot(_) => {
                    self.count_rejects(judged, &mut outcome);
                    let pass = judged.verdict == Verdict::Pass;
                    self.device.learn(&judged.record, pass);
                }
            }
        }
        let broken = self.device.broken_promises();
        let alarms = broken.iter().map(Alarm::promise_broken);
        outcome.trouble.extend(alarms);
        output.record.broken = broken;
        output.notes.trouble.extend(outcome.trouble);
        output.record.checked = outcome.checked;
    }

    /// Returns the serial number of the reference part in the nest; `None` for one that only serves a check.
    pub(super) fn teaching(&self) -> Option<&str> {
        match self.line.ledger.part(Place::NEST).map(|part| &part.role) {
            Some(PartRole::Reference(serial)) if !self.lot.gates.is_checking() => Some(serial),
            Some(PartRole::Reference(_) | PartRole::Lot(_)) | None => None,
        }
    }

    /// Completes the calibration without the last reference part, whose test was interrupted.
    pub(super) fn end_reference_run(&mut self, output: &mut TurnOutput) {
        if self.referenced && self.lot.reference_left.is_empty() && self.is_calibrating() {
            let mut outcome = Outcome::default();
            let complete = self.device.conclude_reference_parts().map(Some);
            calibrated(complete, &mut output.record.calibrated, &mut outcome);
            output.notes.trouble.extend(outcome.trouble);
        }
    }
}

fn calibrated(
    learned: Result<Option<Calibration>, CalibrationFault>,
    calibration: &mut Option<Calibration>,
    outcome: &mut Outcome,
) {
    match learned {
        Ok(complete) => *calibration = complete.or(calibration.take()),
        Err(why) => outcome.trouble.push(Alarm::calibration(&why.message())),
    }
}
