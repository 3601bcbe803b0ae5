//! One turn of the sequence that feeds, tests and sorts parts.

use super::Station;
use super::packml::Mode;
use super::turn::{Inputs, TurnOutput};
use crate::dut::prompt::PromptMoment;
use crate::handling::feeder::Permits;
use crate::handling::nest::TestTerms;
use units::RigTime;

/// Moment of the prompts before the first part.
const FIRST_PART: PromptMoment = PromptMoment::AfterCalibration;

impl Station {
    /// Performs one turn of the sequence.
    pub(super) fn produce(
        &mut self,
        now: RigTime,
        mut inputs: Inputs,
        output: &mut TurnOutput,
        permits: Permits,
    ) {
        self.note_begin(output);
        let job = inputs.job.take();
        let teaching = self.teaching().map(str::to_owned);
        let terms = TestTerms {
            thorough: self.is_thorough(),
            teaching: teaching.as_deref(),
            device: &self.device,
        };
        let before = output.rig.motions.len();
        let resting = self.machine.is_coming_to_rest();
        let (feeder, _, mut turn) =
            self.line
                .at(now, &inputs, output, &mut self.lot.reference_left, resting);
        if feeder.step(&mut turn, job, terms, permits) {
            self.line.mechanism.new_part();
        }
        output.notes.take_over();
        if self.machine.mode == Mode::Maintenance {
            let motions = output.rig.motions.drain(before..);
            self.line.stepwise.extend(motions);
        }
        self.learn(output);
    }

    fn note_begin(&mut self, output: &mut TurnOutput) {
        if !self.lot.began && self.is_calibration_over() && !self.prompts.is_due(FIRST_PART) {
            self.lot.began = true;
            output.record.lot_began = true;
        }
    }

    /// Returns true when calibration and reference parts are complete.
    pub(super) fn is_calibration_over(&self) -> bool {
        self.lot.reference_left.is_empty() && self.device.is_calibrated()
    }

    /// Returns true when the prompt before the first part still has no answer and is due as soon as the last reference
    /// part has left.
    pub(super) fn is_prompt_due(&self) -> bool {
        self.is_calibration_over() && self.prompts.is_due(FIRST_PART)
    }

    /// Opens the prompt before the first part once the machine rests; returns true while it is open.
    pub(super) fn asks_before_the_first_part(
        &mut self,
        inputs: &Inputs,
        output: &TurnOutput,
    ) -> bool {
        self.is_prompt_due()
            && self.rests_empty(inputs.recorded, output)
            && self.prompts.asks(FIRST_PART)
    }

    /// Returns true when no part is in nest, fingers or chute, every row is safely on the disk, and nothing moves.
    pub(super) fn rests_empty(&self, recorded: u64, output: &TurnOutput) -> bool {
        let moving = self.line.mechanism.moving().next().is_some();
        self.line.is_finished(false, recorded, output) && !moving && output.rig.motions.is_empty()
    }

    /// Returns true while the magazine is to deliver more parts of the lot.
    pub(super) fn expects_more(&self) -> bool {
        self.plan
            .count
            .is_none_or(|count| self.line.ledger.own_parts() < self.lot.reference_planned + count)
    }
}
