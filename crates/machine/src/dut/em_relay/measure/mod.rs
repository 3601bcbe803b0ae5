//! Test of one part: the order of its stages, and which of them it repeats or omits.
//!
//! ```text
//! kelvin -> conditioning -> NC contact -> timed operate + NO contact -> timed release + NC contact -> coil
//!        -> operate coarse -> release coarse -> operate fine -> release fine -> off -> verdict
//! ```
//! Conditioning runs when the recipe demands operations before the first measurement. Each release follows the
//! operation before it, so that a part operates three times and not five. The times come first: they show a contact
//! that does not move at nominal voltage, and operate time and coil resistance predict the overshoot of the ramps
//! ([`crate::dut::em_relay::overshoot`]). After such a contact the test still measures the coil, because it may
//! be the cause.
//!
//! A stage consists of acts and a conclusion; `state.rs` calls both. The acts build on the state of the board
//! (`board.rs`) and return the state that they leave. The conclusion writes results into the record (`record.rs`) and
//! data for later stages into the plan (`plan.rs`), and may insert a stage before the planned ones.
//!
//! While something settles or converts, a stage prepares the next one (arming, counters, selections); the mark and the
//! last counter readings therefore remain valid across stages. The board switches the contact source off 2 ms before it
//! changes drive, selection or direction; acts that make such a change wait for it ([`INTERLOCK`]).
//!
//! The recipe selects the strategy of each threshold ([`crate::dut::em_relay::strategy`]): the diagram shows
//! `coarse_fine`; a search (`search/mod.rs`) replaces the ramps.
//!
//! A stage that finds an open coil or a contact that does not move records the finding, and the test goes straight to
//! `off`. Confirmation measurements repeat results inside the guard band: the same stage `slow_repeats` times,
//! averaged. A mean that is still inside it fails.

mod board;
mod coil;
mod conditioning;
mod contact;
pub mod context;
mod fine;
mod indication;
mod kelvin;
mod operate;
mod operate_fine;
mod pace;
mod plan;
mod ramp;
mod record;
mod release;
mod search;
mod stage;
mod state;
mod timing;
mod verdict;

use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::finding::Contact;
use crate::dut::em_relay::points::DigitalOut;
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::{Finding, Parameter};
use crate::dut::procedure::{MEASURING, Progress, TestProcedure};
use crate::dut::record::{Own, Stop};
use crate::dut::{self, Characteristic, Kind};
use crate::gauge::Judgement;
use crate::instrument::act::{JobDone, Runner, RunnerState};
use crate::rig::image::Image;
use crate::rig::sample::CountSample;
use crate::rig::supply::RangeMismatch;
use board::Armature;
pub use context::Context;
pub use record::{Observed, Ramp, TestRecord};
pub use release::SEAL;
pub use stage::Stage;
use stage::order;
use state::TestState;
use std::collections::VecDeque;
use texts::Message;
pub use timing::{BOUNCE_WINDOW, LONGEST_OPERATION};
use units::{RigTime, Span};

/// Time without drive after which release, bounce and swing of the armature are over.
const OFF: Span = Span::ms(12);
/// Delay of the board before it changes drive, selection or direction while the source is on.
const INTERLOCK: Span = Span::ms(2);

/// Stages that confirmation measurements repeat, in the order of the test.
const SLOW: [Stage; 5] = [
    Stage::TimedOperate,
    Stage::TimedRelease,
    Stage::Coil,
    Stage::OperateFine(0),
    Stage::ReleaseFine(0),
];

/// Longest remaining time of a ramp that the previous test of the part has left running: a ramp over a new interval
/// takes 0.45 s.
const CUT_OFF: Span = Span::ms(550);

/// A test under way.
#[derive(Debug)]
pub struct Test {
    context: Context,
    state: TestState,
    stages: VecDeque<Stage>,
    stage: Stage,
    runner: Runner,
    slow_done: bool,
    gates: Option<[CountSample; 2]>,
    began: RigTime,
    /// Tests of this part so far, including this one.
    number: u8,
    /// Selected supply range and the one that was read back; `None` while the two agree.
    range_mismatch: Option<RangeMismatch>,
}

impl Test {
    /// Begins with the Kelvin check; the probes are up.
    pub fn begin(context: Context, now: RigTime) -> Self {
        let mut state = TestState::new(&context);
        let acts = state.enter(Stage::Kelvin, &context);
        let runner = Runner::new(context.wired(acts), now);
        Self {
            stages: order(&context),
            context,
            state,
            began: now,
            number: 1,
            range_mismatch: None,
            stage: Stage::Kelvin,
            runner,
            slow_done: false,
            gates: None,
        }
    }

    /// Marks this as a further test of the same part, during which a ramp of the previous test may still run.
    pub fn another(mut self, number: u8) -> Self {
        self.number = number;
        self.state.board.still_ramping = CUT_OFF;
        self
    }

    /// Gives up the stage under way because its acts did not leave the board as planned.
    fn abandon(&mut self, why: Message) {
        let seen = std::mem::take(&mut self.runner.readings.trace);
        self.state.record.trace.append(seen);
        self.state.record.trouble(why);
        self.state.board.armature = Armature::Unknown;
    }

    fn enter(&mut self, stage: Stage, now: RigTime) {
        self.stage = stage;
        let acts = self.state.enter(stage, &self.context);
        self.runner = Runner::after(self.context.wired(acts), now, &self.runner);
    }

    fn conclude(&mut self, now: RigTime) {
        let record = &mut self.state.record;
        record.spent.add(self.runner.spent());
        record.took(self.stage.measures(), now.since(self.began));
        self.began = now;
        let mut read = std::mem::take(&mut self.runner.readings);
        record.trace.append(std::mem::take(&mut read.trace));
        let readings = Readings::of(&read, &self.context.points, self.gates.take());
        self.gates = readings.gates.last().cloned();
        let mut boards = readings.boards.iter();
        let mismatch = boards.find_map(|board| self.context.range_mismatch(board.range));
        if let Some(mismatch) = mismatch {
            let finding = Finding::OtherSupplyRange.with(mismatch.to_string());
            self.state.record.stop(finding);
            self.range_mismatch.get_or_insert(mismatch);
        }
        let again = self.state.conclude(self.stage, &self.context, &readings);
        if self.state.record.stopped() && self.stage != Stage::Off {
            self.stages = VecDeque::from([Stage::Off]);
        } else if let Some(stage) = again {
            if matches!(self.stage, Stage::Search(_)) {
                // The search places the fine ramp that is already planned.
                self.stages.retain(|waiting| {
                    stage.is_fine().is_none() || waiting.is_fine() != stage.is_fine()
                });
            }
            self.stages.push_front(stage);
        }
    }

    /// Plans another timed closure of both contacts while the recipe asks for one.
    fn add_closure(&mut self) {
        let record = &self.state.record;
        let sampling = self.context.relay.test.strategy.contact;
        let closures = record.attempts(Parameter::OperateTime) as u64;
        if self.slow_done || record.stopped() || closures >= sampling.closures.into() {
            return;
        }
        let clear = |contact| contact::is_clear(&self.context, &self.state, contact);
        if sampling.stops_early && clear(Contact::No) && clear(Contact::Nc) {
            return;
        }
        self.stages.push_front(Stage::TimedRelease);
        self.stages.push_front(Stage::TimedOperate);
    }

    /// Plans, once per test, the stages to repeat. These are the stages with a result inside the guard band, or in a
    /// thorough test all of them. Calibration also repeats the fine ramps of a reference part, to find the scatter of
    /// operations.
    fn add_slow_repeats(&mut self) {
        if self.slow_done || self.state.record.stopped() {
            return;
        }
        self.slow_done = true;
        let conditional = |judgement: &Judgement| matches!(judgement, Judgement::Conditional(_));
        let is_calibrating = self.context.teaching.is_some();
        let again: Vec<Stage> = verdict::judged(&self.context, &self.state.record)
            .iter()
            .map(|(parameter, judgement)| (parameter.facts().stage, judgement))
            .filter(|(stage, judgement)| {
                let is_fine_of_reference = is_calibrating && stage.is_fine().is_some();
                self.context.thorough || is_fine_of_reference || conditional(judgement)
            })
            .map(|(stage, _)| stage)
            .collect();
        // Repeats follow the order of the test: a fine release ramp right after the timed operation would start from
        // another flux than the ramps that taught its overshoot.
        for _ in 0..self.context.recipe.decision.slow_repeats {
            let round = SLOW.iter().rev().filter(|stage| again.contains(stage));
            round.for_each(|stage| self.stages.push_front(*stage));
        }
    }
}

impl TestProcedure for Test {
    fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> Progress {
        let mut done = done;
        loop {
            match self.runner.step(now, done.take(), image) {
                RunnerState::Done => {}
                RunnerState::Trouble(why) => {
                    self.abandon(why);
                    if self.stage == Stage::Off {
                        return Progress::Judged;
                    }
                    self.enter(Stage::Off, now);
                    self.stages.clear();
                    continue;
                }
                other @ (RunnerState::Job(_) | RunnerState::Busy | RunnerState::Wait(_)) => {
                    return Progress::Running(other);
                }
            }
            self.conclude(now);
            if self.stages.front() == Some(&Stage::Off) {
                self.add_closure();
            }
            if self.stages.front() == Some(&Stage::Off) {
                self.add_slow_repeats();
            }
            let Some(stage) = self.stages.pop_front() else {
                return Progress::Judged;
            };
            self.enter(stage, now);
        }
    }

    fn kind(&self) -> Kind {
        Kind::EmRelay
    }

    fn range_mismatch(&self) -> Option<&RangeMismatch> {
        self.range_mismatch.as_ref()
    }

    fn number(&self) -> u8 {
        self.number
    }

    fn stage(&self) -> &'static str {
        self.stage.name()
    }

    fn why_stopped(&self) -> Option<&Stop> {
        self.state.record.why_stopped()
    }

    fn judgements(&self) -> Vec<(Characteristic, Judgement)> {
        let judged = verdict::judged(&self.context, &self.state.record);
        let general = |(parameter, judgement): (Parameter, _)| (parameter.into(), judgement);
        judged.into_iter().map(general).collect()
    }

    fn record(&self) -> dut::TestRecord {
        self.state.record.clone().of_any_kind(Own::EmRelay)
    }

    fn take_record(&mut self) -> dut::TestRecord {
        std::mem::take(&mut self.state.record).of_any_kind(Own::EmRelay)
    }

    /// Returns the longest time that the measuring stages and the conditioning take together.
    fn longest(&self) -> Span {
        MEASURING + conditioning::longest(self.context.relay.test.conditioning_operations)
    }
}

fn set(outputs: &[(DigitalOut, bool)]) -> Act {
    Act::Board(outputs.to_vec())
}

#[cfg(test)]
mod tests;
