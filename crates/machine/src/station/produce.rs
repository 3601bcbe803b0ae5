//! One turn of the sequence that feeds, tests and sorts parts.

use super::Station;
use super::line::BatchTerms;
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
        inputs: Inputs,
        output: &mut TurnOutput,
        permits: Permits,
    ) {
        self.note_begin(output);
        match self.line.batch() {
            Some(_) => self.produce_batch(now, inputs, output, permits),
            None => self.feed(now, inputs, output, permits),
        }
        self.learn(output);
    }

    /// Performs one turn of the batch.
    fn produce_batch(
        &mut self,
        now: RigTime,
        inputs: Inputs,
        output: &mut TurnOutput,
        permits: Permits,
    ) {
        let lacking = self.lacking();
        let terms = BatchTerms {
            device: &self.device,
            lacking,
            attended: self.plan.attended,
            begins: permits.release,
            experiment: self.plan.experiment,
        };
        if let Some((batch, mut turn)) = self.line.batch_at(now, &inputs, output, terms) {
            batch.step(&mut turn);
        }
        if output.record.parts.found.is_some() {
            self.plan.experiment = None;
        }
        output.notes.take_over();
    }

    /// Performs one turn of the feeder.
    fn feed(
        &mut self,
        now: RigTime,
        mut inputs: Inputs,
        output: &mut TurnOutput,
        permits: Permits,
    ) {
        let job = inputs.job.take();
        let teaching = self.teaching().map(str::to_owned);
        let terms = TestTerms {
            thorough: self.is_thorough(),
            teaching: teaching.as_deref(),
            device: &self.device,
        };
        let before = output.rig.motions.len();
        let resting = self.machine.is_coming_to_rest();
        let reference = &mut self.lot.reference_left;
        let at = self.line.at(now, &inputs, output, reference, resting);
        let is_new =
            at.is_some_and(|(feeder, _, mut turn)| feeder.step(&mut turn, job, terms, permits));
        output.notes.take_over();
        let Some(own) = self.line.feeder_mut() else {
            return;
        };
        if is_new {
            own.mechanism.new_part();
        }
        if self.machine.mode == Mode::Maintenance {
            let motions = output.rig.motions.drain(before..);
            own.stepwise.extend(motions);
        }
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

    /// Returns true when calibration and reference parts are complete, and a prompt before the first part has no
    /// answer.
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
        let moving = self.line.is_moving();
        self.line.is_finished(false, recorded, output) && !moving && output.rig.motions.is_empty()
    }

    /// Returns true while the lot lacks parts, or its experiment has no result.
    pub(super) fn expects_more(&self) -> bool {
        self.plan.experiment.is_some() || self.lacking().is_none_or(|lacking| lacking > 0)
    }

    /// Returns the number of parts that the lot still lacks; `None` for an endless lot.
    fn lacking(&self) -> Option<u64> {
        let planned = self.lot.reference_planned + self.plan.count?;
        Some(planned.saturating_sub(self.line.ledger.own_parts()))
    }
}
