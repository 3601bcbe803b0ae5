//! The state `Resetting`: homes every actuator, then resumes the sequence to discharge the parts found inside.

use super::Station;
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
        if self.line.recovery.drive_reset(now) {
            self.line.mechanism.drive_reset(now);
        }
        let reference = &mut self.lot.reference_left;
        let (feeder, recovery, mut turn) = self.line.at(now, &inputs, output, reference, false);
        let home = recovery.step(&mut turn, feeder.is_releasing());
        output.notes.take_over();
        if home {
            let moves = self.line.mechanism.moving().next();
            assert_eq!(moves, None, "home while an actuator moves");
            self.line.homed = true;
            self.resume(now, output);
        }
    }

    /// Resumes the sequence with the parts inside.
    fn resume(&mut self, now: RigTime, output: &mut TurnOutput) {
        self.line.feeder.resume(&self.line.ledger);
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
