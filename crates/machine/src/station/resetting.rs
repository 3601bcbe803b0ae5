//! The state `Resetting`. With a feeder it homes every actuator, then resumes the sequence to discharge the parts found
//! inside; with a rack it cools the rack, and a person unloads the parts of an interrupted batch.

use super::Station;
use super::line::{BatchTerms, Handling};
use super::turn::{Inputs, TurnOutput};
use crate::dut::Reason;
use crate::handling::Place;
use crate::handling::output::{Interrupted, Judged};
use crate::rig::bin::Bin;
use units::RigTime;

/// Reason for a part that a reset finds inside and that nothing interrupted before.
const BY_A_RESET: &str = "reset";

impl Station {
    /// Performs a turn of `Resetting`.
    pub(super) fn reset(&mut self, now: RigTime, inputs: Inputs, output: &mut TurnOutput) {
        if !self.alarms.sensed {
            return;
        }
        if self.line.homed {
            return self.finish(now, inputs, output, false);
        }
        if self.line.batch().is_some() {
            return self.home_rack(now, inputs, output);
        }
        if let Some(own) = self.line.feeder_mut()
            && own.recovery.drive_reset(now)
        {
            own.mechanism.drive_reset(now);
        }
        let reference = &mut self.lot.reference_left;
        let at = self.line.at(now, &inputs, output, reference, false);
        let home = at.is_some_and(|(feeder, recovery, mut turn)| {
            recovery.step(&mut turn, feeder.is_releasing())
        });
        output.notes.take_over();
        if home {
            assert!(!self.line.is_moving(), "home while an actuator moves");
            self.line.homed = true;
            self.resume(now, output);
        }
    }

    /// Cools the rack and lets a person take out the parts of an interrupted batch.
    fn home_rack(&mut self, now: RigTime, inputs: Inputs, output: &mut TurnOutput) {
        let terms = BatchTerms {
            device: &self.device,
            lacking: None,
            attended: self.plan.attended,
            begins: false,
            experiment: None,
        };
        let at = self.line.batch_at(now, &inputs, output, terms);
        let home = at.is_some_and(|(batch, mut turn)| batch.home(&mut turn));
        output.notes.take_over();
        if home {
            self.line.homed = true;
            output.rig.wake_at = Some(now);
        }
    }

    /// Resumes the sequence with the parts inside.
    fn resume(&mut self, now: RigTime, output: &mut TurnOutput) {
        if let Handling::Feeder(own) = &mut self.line.handling {
            own.feeder.resume(&self.line.ledger);
        }
        if self.lot.gates.is_checking() {
            self.begin_check();
        }
        self.end_reference_run(output);
        self.resume_gripped(now, output);
        self.resume_nested(output);
        output.rig.wake_at = Some(now);
    }

    /// Interrupts the part in the nest. A part with a bin was judged and then put back into the nest: it goes to
    /// retest, and its row records the reason.
    fn resume_nested(&mut self, output: &mut TurnOutput) {
        let Some(part) = self.line.ledger.part_mut(Place::NEST) else {
            return;
        };
        let why = part.interrupt(BY_A_RESET);
        if part.bin.is_some_and(|bin| bin != Bin::RETEST) {
            part.bin = Some(Bin::RETEST);
            let ordinal = part.ordinal;
            let interrupted = &mut output.record.parts.interrupted;
            interrupted.push(Interrupted { ordinal, why });
        }
    }

    /// Sends the part in the gripper to retest; its row records the reason.
    fn resume_gripped(&mut self, now: RigTime, output: &mut TurnOutput) {
        let Some(part) = self.line.ledger.part_mut(Place::Gripper) else {
            return;
        };
        let is_recorded = part.interrupted.is_some();
        let why = part.interrupt(BY_A_RESET);
        if part.bin.replace(Bin::RETEST).is_none() {
            let judged = Judged::untested(part.clone(), Reason::interrupted(&why), now);
            output.record.parts.judged.push(judged);
        } else if !is_recorded {
            let ordinal = part.ordinal;
            let interrupted = &mut output.record.parts.interrupted;
            interrupted.push(Interrupted { ordinal, why });
        }
    }
}
