//! The test of one part: the order of its stages, and when it repeats or leaves out some.
//!
//! ```text
//! kelvin -> conditioning -> NC contact -> timed operate + NO contact -> timed release + NC contact -> coil
//!        -> operate coarse -> release coarse -> operate fine -> release fine -> off -> verdict
//! ```
//! Conditioning takes part where the recipe asks for operations before the first measurement.
//! Each release follows on the operation before it, so that a part operates three times and not five.
//! The times come first: a relay that is late on a step is late on a ramp, and its times and its coil predict by how much
//! ([`crate::dut::em_relay::overshoot`]), which places the fine ramps. The test so finds a contact that does not move at nominal
//! voltage before any ramp, and still measures the coil, which may be the cause.
//!
//! A stage consists of acts and a conclusion; `state.rs` calls both. The acts begin from the state of the board (`board.rs`)
//! and come with the state that they leave. The conclusion writes results into the record (`record.rs`) and what later
//! stages go by into the plan (`plan.rs`), and may put a stage before the planned ones.
//!
//! A stage does what needs no waiting (arming, counters, selections) while something else settles or converts;
//! a mark therefore outlives the stage that set it, and so does the last reading of the counters.
//! The board takes the source off by itself, 2 ms ahead of a change of drive, selection or direction;
//! the acts that make such a change wait for it ([`INTERLOCK`]).
//!
//! The recipe says how to find a threshold ([`crate::dut::em_relay::strategy`]): the line above is that of
//! `coarse_fine`, a search (`search/mod.rs`) takes the place of the ramps.
//!
//! A stage that finds the part unfit for the rest (open coil, contact that does not move) says why
//! and the test goes straight to `off`. Confirmation measurements repeat results inside the guard band: the same stage
//! `slow_repeats` times, averaged. What is then still conditional fails.

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

use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::points::DigitalOut;
use crate::dut::em_relay::readings::Readings;
use crate::dut::procedure::{MEASURING, Progress, TestProcedure};
use crate::dut::record::{Own, Stop};
use crate::dut::{self, Characteristic, Kind};
use crate::gauge::Judgement;
use crate::instrument::act::{Doing, JobDone, Runner};
use crate::rig::image::Image;
use crate::rig::sample::CountSample;
use board::Armature;
pub use context::Context;
pub use record::{Observed, Ramp, TestRecord};
pub use release::SEAL;
pub use stage::Stage;
use stage::order;
use state::TestState;
use std::collections::VecDeque;
use units::{RigTime, Span};

/// Release, bounce and the swing of the armature are over after this long without drive.
const OFF: Span = Span::ms(12);
/// A change of drive, selection or direction comes so late while the source is on.
const INTERLOCK: Span = Span::ms(2);

/// Stages of confirmation measurements in the order of the test.
const SLOW: [Stage; 5] = [
    Stage::TimedOperate,
    Stage::TimedRelease,
    Stage::Coil,
    Stage::OperateFine(0),
    Stage::ReleaseFine(0),
];

/// Longest time that a ramp which the test before has cut off still runs: one that was placed anew takes 0.3 s.
const CUT_OFF: Span = Span::ms(400);

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
    /// Tests of this part so far, this one included.
    number: u8,
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
            stage: Stage::Kelvin,
            runner,
            slow_done: false,
            gates: None,
        }
    }

    /// The same as another test of a part that was tested just now: a ramp that was cut off may still run.
    pub fn another(mut self, number: u8) -> Self {
        self.number = number;
        self.state.board.still_ramping = CUT_OFF;
        self
    }

    /// Gives up the stage under way: its acts have not left the board as they were to.
    fn abandon(&mut self, why: String) {
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

    /// Draws the conclusions of the stage that has just ended.
    fn conclude(&mut self, now: RigTime) {
        let record = &mut self.state.record;
        record.spent.add(self.runner.spent());
        record.took(self.stage.measures(), now.since(self.began));
        self.began = now;
        let mut read = std::mem::take(&mut self.runner.readings);
        record.trace.append(std::mem::take(&mut read.trace));
        let readings = Readings::of(&read, &self.context.points, self.gates.take());
        self.gates = readings.gates.last().cloned();
        let again = self.state.conclude(self.stage, &self.context, &readings);
        if self.state.record.stopped() && self.stage != Stage::Off {
            self.stages = VecDeque::from([Stage::Off]);
        } else if let Some(stage) = again {
            if matches!(self.stage, Stage::Search(_)) {
                // The ramp that the search has placed is the one that was to come anyway.
                self.stages.retain(|waiting| {
                    stage.is_fine().is_none() || waiting.is_fine() != stage.is_fine()
                });
            }
            self.stages.push_front(stage);
        }
    }

    /// Another timed closure of both contacts, while the recipe asks for one.
    fn add_closure(&mut self) {
        let record = &self.state.record;
        let sampling = self.context.relay.test.strategy.contact;
        let closures = record.attempts(Parameter::ContactResistanceNo) as u64;
        if self.slow_done || record.stopped() || closures >= sampling.closures.into() {
            return;
        }
        let clear = |parameter| contact::is_clear(&self.context, &self.state, parameter);
        if sampling.stops_early
            && clear(Parameter::ContactResistanceNo)
            && clear(Parameter::ContactResistanceNc)
        {
            return;
        }
        self.stages.push_front(Stage::TimedRelease);
        self.stages.push_front(Stage::TimedOperate);
    }

    /// Repeats the stages whose results lie inside the guard band (of a thorough test: all), once per test.
    fn add_slow_repeats(&mut self) {
        if self.slow_done || self.state.record.stopped() {
            return;
        }
        self.slow_done = true;
        let doubtful = |judgement: &Judgement| matches!(judgement, Judgement::Conditional(_));
        let again: Vec<Stage> = verdict::judged(&self.context, &self.state.record)
            .iter()
            .filter(|(_, judgement)| self.context.thorough || doubtful(judgement))
            .map(|(parameter, _)| parameter.facts().stage)
            .collect();
        // In the order of the test: a fine release ramp right after the timed operation would start from
        // another flux than the one its overshoot was learned from.
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
                Doing::Done => {}
                Doing::Trouble(why) => {
                    self.abandon(why);
                    if self.stage == Stage::Off {
                        return Progress::Judged;
                    }
                    self.enter(Stage::Off, now);
                    self.stages.clear();
                    continue;
                }
                other @ (Doing::Job(_) | Doing::Busy | Doing::Wait(_)) => {
                    return Progress::Doing(other);
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

    /// The stages that measure, and the conditioning.
    fn longest(&self) -> Span {
        MEASURING + conditioning::longest(self.context.relay.test.conditioning_operations)
    }
}

/// One write of the interface board.
fn set(outputs: &[(DigitalOut, bool)]) -> Act {
    Act::Board(outputs.to_vec())
}

#[cfg(test)]
mod tests;
