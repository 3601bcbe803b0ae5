//! Test of one part: the order of its stages, safe first.
//!
//! ```text
//! pins -> short check -> input -> leakage -> blocks at V_off -> conducts at V_on -> thresholds -> times
//!      -> resistance -> leakage again -> sources off -> discharge -> verdict
//! ```
//! A finding ends the measuring stages; a figure outside its limit does not. A finding about the output fails the part
//! only after [`known`] states of the fixture have shown no other cause. Every test ends with the discharge, whatever has
//! ended it. A part that has failed is tested once more, from the pins to the discharge. When the second test passes it, the
//! part is void: a contact has opened for some milliseconds.
//!
//! When a job fails, the fixture disconnects the sources first, by modules whose watchdog needs no instrument, and the
//! instruments follow. A socket that is not proven to be below 30 V is trouble of the rig.
//!
//! A result inside the guard band, and in a thorough test every result, is measured again at once, `slow_repeats` times.

mod board;
mod conformity;
mod contact;
mod dc_stage;
mod discharge;
mod given;
mod input;
mod known;
mod leakage;
pub(super) mod line;
pub(super) mod ramp;
mod resistance;
mod search_ends;
mod stage;
mod state;
mod threshold;
mod timing;

pub use stage::{Label, Stage};
pub use state::State;

use super::Finding;
use super::device::Device;
use super::parameter::Parameter;
use super::plan::OutputPlan;
use crate::dut::device::TestOrder;
use crate::dut::procedure::{Progress, TestProcedure};
use crate::dut::record::{Own, Stop, TestRecord};
use crate::dut::{Characteristic, Kind, Verdict};
use crate::gauge::{Judgement, Side};
use crate::instrument::act::{JobDone, Runner, RunnerState};
use crate::rig::image::Image;
use crate::rig::supply::RangeMismatch;
use state::Next;
use std::collections::VecDeque;
use texts::Message;
use units::RigTime;

/// Keys under which rows say whether the part obeys at the limits of its thresholds, by characteristic.
const CONFORMS: [(Parameter, &str); 2] = [
    (Parameter::TurnOnVoltage, "v_on_conforms"),
    (Parameter::TurnOffVoltage, "v_off_conforms"),
];

/// A test under way.
#[derive(Debug)]
pub struct Test {
    device: Device,
    state: State,
    stage: Stage,
    stages: VecDeque<Stage>,
    runner: Runner,
    /// State at the end of a first test that has failed the part, while the second test is under way.
    failed: Option<Box<State>>,
    thorough: bool,
    number: u8,
    /// Repetitions left for the stage under way; none before its first result.
    repeats_left: Option<u32>,
    began: RigTime,
}

/// Returns the state at the begin of a test, and its stages: the probes are up.
fn planned(device: &Device, now: RigTime) -> (State, VecDeque<Stage>) {
    let references = device.fixture.references.filter(|it| it.hold(now));
    let open = device.fixture.open.filter(|it| it.holds(now));
    let is_referenced = match device.plan.output {
        OutputPlan::Dc(_) => open.is_some(),
        OutputPlan::Ac(_) => references.is_some(),
    };
    let is_searched = device.judged < device.plan.searched;
    let stages = stage::order(&device.plan, is_referenced, is_searched);
    let mut stages = VecDeque::from(stages);
    stages.extend([Stage::SourcesOff, Stage::Discharge]);
    let state = State {
        learned: device.learned,
        references,
        open,
        is_no_sample: device.plan.sampling.is_some_and(|it| device.judged >= it),
        ..State::default()
    };
    (state, stages)
}

impl Test {
    /// Begins with the pins; the probes are up.
    pub fn begin(device: Device, order: &TestOrder, now: RigTime) -> Self {
        let (mut state, mut stages) = planned(&device, now);
        let stage = stages.pop_front().unwrap_or(Stage::Discharge);
        let acts = state.acts(stage, &device.plan, &device.points);
        Self {
            runner: Runner::new(acts, now),
            failed: None,
            device,
            state,
            stage,
            stages,
            thorough: order.thorough,
            number: order.number,
            repeats_left: None,
            began: now,
        }
    }

    /// Decides after the last stage: begins a second test of a failed part, or compares both tests. The part fails when
    /// both fail it; the first one counts.
    fn compare(&mut self, now: RigTime) {
        let fails = matches!(self.verdict(), Verdict::Fail(_));
        if let Some(mut other) = self.failed.take() {
            if fails {
                std::mem::swap(&mut self.state, &mut other);
            } else if self.verdict() == Verdict::Pass {
                self.state.record.stop(Finding::Unsteady);
            }
            self.state.record.add_time(&other.record);
        } else if fails {
            let (state, stages) = planned(&self.device, now);
            self.failed = Some(Box::new(std::mem::replace(&mut self.state, state)));
            self.stages = stages;
        }
    }

    fn enter(&mut self, stage: Stage, now: RigTime) {
        if stage != self.stage {
            self.repeats_left = None;
        }
        self.stage = stage;
        let acts = self
            .state
            .acts(stage, &self.device.plan, &self.device.points);
        self.runner = Runner::new(acts, now);
    }

    fn book(&mut self, now: RigTime) {
        let record = &mut self.state.record;
        record.spent.add(self.runner.spent());
        record.took(self.stage.key(), now.since(self.began));
        let seen = std::mem::take(&mut self.runner.readings.trace);
        record.trace.append(seen.of_stage(self.stage.name()));
        self.began = now;
    }

    /// Ends the measuring after a failed job: the modules disconnect first.
    fn abandon(&mut self, why: Message) {
        self.state.record.trouble(why);
        self.stages.clear();
        let (ends, is_last) = (self.stage.ends(), self.stage == Stage::Discharge);
        if !ends {
            self.stages.extend([Stage::Discharge, Stage::SourcesOff]);
        } else if !is_last && !self.state.is_discharged {
            self.stages.push_back(Stage::Discharge);
        }
    }

    fn conclude(&mut self, now: RigTime) {
        self.book(now);
        let readings = std::mem::take(&mut self.runner.readings);
        let (plan, points) = (&self.device.plan, &self.device.points);
        let next = self
            .state
            .conclude(self.stage, plan, (points, now), &readings);
        if self.stage.ends() {
            if let Next::Insert(stage) = next {
                self.stages.push_front(stage);
            }
            return;
        }
        if self.state.doubts(self.stage) {
            self.stages = VecDeque::from([Stage::Known, Stage::SourcesOff, Stage::Discharge]);
        } else if self.state.record.stopped() {
            self.stages = VecDeque::from([Stage::SourcesOff, Stage::Discharge]);
        } else if let Next::Insert(stage) = next {
            self.stages.push_front(stage);
        } else if self.repeats() {
            self.stages.push_front(self.stage);
        }
    }

    /// Returns true when the stage under way must measure again, and counts it.
    fn repeats(&mut self) -> bool {
        let measured = self.stage.measures();
        let is_near = |(of, judgement): &(Characteristic, Judgement)| {
            let own = measured.iter().any(|it| Characteristic::from(*it) == *of);
            own && matches!(judgement, Judgement::Conditional(_))
        };
        let left = match self.repeats_left {
            Some(left) => left,
            None if measured.is_empty() => 0,
            None if self.thorough || self.judgements().iter().any(is_near) => {
                self.device.recipe.decision.slow_repeats
            }
            None => 0,
        };
        self.repeats_left = Some(left.saturating_sub(1));
        left > 0
    }
}

impl Test {
    /// Returns the proven judgement of the limit of a threshold; `None` without a proof.
    fn proof(&self, of: Parameter) -> Option<Judgement> {
        self.state.proof(of).or_else(|| self.proof_of_late(of))
    }

    /// Returns the failure of a threshold at whose limit the output switches, but too late. Returns `None` unless its
    /// time at the nominal voltage is proven right: otherwise the time fails, not the threshold.
    fn proof_of_late(&self, of: Parameter) -> Option<Judgement> {
        let (time, side) = match of {
            Parameter::TurnOffVoltage => (Parameter::TurnOffTime, Side::Low),
            _turn_on => (Parameter::TurnOnTime, Side::High),
        };
        let time = self.state.record.judged(&self.device.recipe, [time]);
        let is_right = matches!(time[..], [(_, Judgement::Pass)]);
        let is_late = self.state.late.contains(&of);
        (is_late && is_right).then_some(Judgement::Fail(side))
    }

    /// Returns, for each threshold, true when the part switches at its limit; leaves out a threshold within the guard
    /// band, and one that the test has not reached.
    fn conforms(&self) -> Vec<(&'static str, bool)> {
        let found = self.why_stopped().and_then(Stop::proven);
        let obeys = |of: Parameter| match self.proof(of) {
            Some(Judgement::Pass) => Some(true),
            Some(Judgement::Fail(_)) => Some(false),
            Some(Judgement::Conditional(_) | Judgement::Void) => None,
            None => (found == Some(of.into())).then_some(false),
        };
        let all = CONFORMS.into_iter();
        all.filter_map(|(of, key)| Some((key, obeys(of)?)))
            .collect()
    }
}

impl TestProcedure for Test {
    fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> Progress {
        let mut done = done;
        loop {
            match self.runner.step(now, done.take(), image) {
                RunnerState::Done => self.conclude(now),
                RunnerState::Trouble(why) => {
                    self.book(now);
                    self.abandon(why);
                }
                waiting @ (RunnerState::Job(_) | RunnerState::Busy | RunnerState::Wait(_)) => {
                    return Progress::Running(waiting);
                }
            }
            if self.stages.is_empty() {
                self.compare(now);
            }
            let Some(stage) = self.stages.pop_front() else {
                return Progress::Judged;
            };
            self.enter(stage, now);
        }
    }

    fn kind(&self) -> Kind {
        Kind::Ssr
    }

    fn range_mismatch(&self) -> Option<&RangeMismatch> {
        None
    }

    fn is_live(&self) -> bool {
        !self.state.is_discharged
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

    /// Judges each result; what the conformity tests have proven takes the place of a judged voltage.
    fn judgements(&self) -> Vec<(Characteristic, Judgement)> {
        let judge = |of: Parameter| match self.proof(of) {
            Some(judgement) => vec![(of, judgement)],
            None if self.state.late.contains(&of) => Vec::new(),
            None => self.state.record.judged(&self.device.recipe, [of]),
        };
        let all = Parameter::ALL.into_iter().flat_map(judge);
        all.map(|(of, judgement)| (of.into(), judgement)).collect()
    }

    /// Returns the verdict. A characteristic without a limit fails no part, whether measured or not.
    fn verdict(&self) -> Verdict {
        let judged = self
            .device
            .plan
            .judged
            .iter()
            .filter(|it| self.state.measures(**it));
        let expected: Vec<Characteristic> = judged.map(|it| (*it).into()).collect();
        Verdict::after(self.why_stopped(), &expected, self.judgements())
    }

    fn record(&self) -> TestRecord {
        let mut record = self.state.record.clone();
        record.own = Own::Ssr(self.state.fixture());
        record.conforms = self.conforms();
        record
    }

    fn take_record(&mut self) -> TestRecord {
        let conforms = self.conforms();
        let mut record = std::mem::take(&mut self.state.record);
        record.conforms = conforms;
        record.own = Own::Ssr(self.state.fixture());
        record
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod line_tests;
