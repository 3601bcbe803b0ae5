//! State of a test between its stages: position of the fixture, searches, results. Each stage lists its acts, then
//! concludes from what they have read.

use super::board::Position;
use super::dc_stage::DcStage;
use super::given::Given;
use super::line::stage::AcStage;
use super::line::{self, Level, conforms, looped, references, staircase, train};
use super::search_ends::{self, SearchEnds};
use super::stage::Stage;
use super::{conformity, contact, discharge, input, known, leakage, resistance, threshold, timing};
use crate::dut::Reason;
use crate::dut::record::TestRecord;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_plan::AcPlan;
use crate::dut::ssr::learned::Learned;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{DcPlan, OutputPlan, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::references::{Fixture, OpenFixture, References};
use crate::dut::ssr::search::Search;
use crate::gauge::{Budget, Judgement, Reading};
use crate::instrument::act::Act;
use crate::instrument::query::Query;
use crate::instrument::readings::Readings;
use crate::rig::sample::Sample;
use units::{RigTime, Unit};

/// State of a test between its stages.
#[derive(Debug, Default)]
pub struct State {
    /// Results so far.
    pub record: TestRecord,
    /// Connections of the fixture.
    pub position: Position,
    /// Voltage to which the AC source is set.
    pub level: Level,
    /// Corrections by the references of the fixture; `None` while there are none.
    pub references: Option<References>,
    /// Readings of the references so far, while they are measured.
    pub shown: references::Shown,
    /// Finding that holds unless the next stage finds another cause.
    pub suspected: Option<Finding>,
    /// Failure of the output that holds unless known states of the fixture show another cause.
    pub doubted: Option<Reason>,
    /// Thresholds of earlier parts.
    pub learned: Learned,
    /// Search under way.
    pub search: Option<Search>,
    /// Ends of the searches that are over.
    pub ends: SearchEnds,
    /// Upper end of the interval that holds the turn-on voltage, V.
    pub turn_on_v: Option<f64>,
    /// Judgements of limits that the conformity tests have proven.
    pub proven: Vec<(Parameter, Judgement)>,
    /// Thresholds at whose limits the output switches, but later than its time limit.
    pub late: Vec<Parameter>,
    /// True for a part of which the test leaves out the sampled characteristics.
    pub is_no_sample: bool,
    /// State of the pulse source in this test.
    pub pulses: Pulses,
    /// Currents of the open fixture; `None` until they are measured.
    pub open: Option<OpenFixture>,
    /// Number of checks of the socket so far at the end of the test.
    pub looks: u32,
    /// True once the socket is proven to be discharged and below 30 V.
    pub is_discharged: bool,
}

/// State of the pulse source in a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pulses {
    /// The output of the pulse source is off: no program of this test has switched it on.
    #[default]
    Off,
    /// The source holds the pulses of this test, and waits for its trigger.
    Ready,
    /// The trigger has started the pulses.
    Sent,
}

/// Stage that follows a concluded stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// The next planned stage.
    Planned,
    /// This stage, before the next planned one.
    Insert(Stage),
}

/// A value of a characteristic with its unit and budget.
pub type Found = (Parameter, f64, Unit, Budget);

/// Returns the plan of a DC output. Only stages of DC parts call this.
///
/// # Panics
/// Panics for the plan of an AC output.
fn dc_of(plan: &Plan) -> &DcPlan {
    match &plan.output {
        OutputPlan::Dc(dc) => dc,
        OutputPlan::Ac(_) => panic!("a stage of DC parts with the plan of an AC part"),
    }
}

/// Returns the plan of an AC output. Only stages of AC parts call this.
///
/// # Panics
/// Panics for the plan of a DC output.
fn ac_of(plan: &Plan) -> &AcPlan {
    match &plan.output {
        OutputPlan::Ac(ac) => ac,
        OutputPlan::Dc(_) => panic!("a stage of AC parts with the plan of a DC part"),
    }
}

impl State {
    /// Returns the query that prepares the pulses at the control input; `None` when the source already holds them. The
    /// pulse source begins only at its trigger.
    pub fn prepare_pulses(&mut self, plan: &Plan, points: &Points) -> Option<Query> {
        if std::mem::replace(&mut self.pulses, Pulses::Ready) == Pulses::Ready {
            return None;
        }
        let input_ma = self.record.result(Parameter::InputCurrent);
        let input_a = input_ma.map_or(0.0, |it| it.value / 1e3);
        Some(match &plan.output {
            OutputPlan::Dc(_) => points.train(plan, input_a),
            OutputPlan::Ac(ac) => points.pulses(plan, ac, input_a),
        })
    }

    /// Returns the query that switches the pulse source off; none when it is off.
    pub fn end_pulses(&mut self, points: &Points) -> Option<Query> {
        let before = std::mem::take(&mut self.pulses);
        (before != Pulses::Off).then(|| points.off(Device::PulseSource))
    }

    /// Returns the acts of a stage, and takes over the position in which they leave the fixture.
    pub fn acts(&mut self, stage: Stage, plan: &Plan, points: &Points) -> Vec<Act> {
        match stage {
            Stage::Contact => contact::acts(self, points),
            Stage::Short => contact::short_acts(points),
            Stage::Input => input::acts(self, plan, points),
            Stage::Turned => input::turned_acts(self, plan, points),
            Stage::Dc(stage) => self.dc_acts(stage, plan, points),
            Stage::Ac(stage) => self.ac_acts(stage, plan, points),
            Stage::Known => known::acts(self, plan, points),
            Stage::SourcesOff => discharge::off_acts(self, points),
            Stage::Discharge => discharge::acts(self, points),
        }
    }

    fn dc_acts(&mut self, stage: DcStage, plan: &Plan, points: &Points) -> Vec<Act> {
        let dc = dc_of(plan);
        match stage {
            DcStage::OpenFixture => leakage::open_acts(self, dc, points),
            DcStage::ColdLeakage | DcStage::HotLeakage => {
                leakage::acts(self, stage, plan, dc, points)
            }
            DcStage::StuckShort => contact::stuck_acts(self, points),
            DcStage::Blocks => conformity::block_acts(self, plan, points),
            DcStage::BlocksBeyond => conformity::block_beyond_acts(plan, points),
            DcStage::Conducts => conformity::conduct_acts(plan, points, -plan.guard_v),
            DcStage::ConductsBeyond => conformity::conduct_beyond_acts(plan, points),
            DcStage::Threshold(direction) => threshold::acts(self, direction, plan, points),
            DcStage::SearchEnds => search_ends::acts(self, plan, points),
            DcStage::Timing => timing::acts(self, plan, points),
            DcStage::Resistance => resistance::acts(self, plan, dc, points),
        }
    }

    fn ac_acts(&mut self, stage: AcStage, plan: &Plan, points: &Points) -> Vec<Act> {
        let ac = ac_of(plan);
        match stage {
            AcStage::Reference(it) => references::acts(self, it, plan, ac, points),
            AcStage::Leakage | AcStage::LeakageHot => {
                line::leakage::acts(self, stage, plan, ac, points)
            }
            AcStage::Blocks(shift) => conforms::block_acts(self, shift, plan, ac, points),
            AcStage::Conducts(shift) => conforms::conduct_acts(self, shift, plan, ac, points),
            AcStage::Threshold(way) => staircase::acts(self, way, plan, ac, points),
            AcStage::Train => train::acts(self, plan, ac, points),
            AcStage::LoopReady => line::ready_acts(self, ac, points),
            AcStage::Loop => looped::acts(self, plan, ac, points),
        }
    }

    /// Draws the conclusions of a stage from its readings; returns the stage that follows.
    pub fn conclude(
        &mut self,
        stage: Stage,
        plan: &Plan,
        (points, now): (&Points, RigTime),
        readings: &Readings,
    ) -> Next {
        let given = Given { points, readings };
        let next = self.concluded(stage, plan, (&given, now));
        next.unwrap_or_else(|why| {
            self.record.stop(why);
            Next::Planned
        })
    }

    /// Concludes; fails with the reason that ends the test.
    fn concluded(
        &mut self,
        stage: Stage,
        plan: &Plan,
        (given, now): (&Given, RigTime),
    ) -> Result<Next, Reason> {
        Ok(match stage {
            Stage::Contact => contact::conclude(&mut self.record, given),
            Stage::Short => contact::conclude_short(&mut self.record, plan, given),
            Stage::Input => input::conclude(self, plan, given)?,
            Stage::Turned => input::conclude_turned(self, given)?,
            Stage::Dc(stage) => self.conclude_dc(stage, plan, (given, now))?,
            Stage::Ac(stage) => self.conclude_ac(stage, plan, (given, now))?,
            Stage::Known => known::conclude(self, plan, given)?,
            Stage::SourcesOff => Next::Planned,
            Stage::Discharge => discharge::conclude(self, given),
        })
    }

    fn conclude_dc(
        &mut self,
        stage: DcStage,
        plan: &Plan,
        (given, now): (&Given, RigTime),
    ) -> Result<Next, Reason> {
        let dc = dc_of(plan);
        let next = match stage {
            DcStage::OpenFixture => leakage::conclude_open(self, dc, given, now),
            DcStage::ColdLeakage | DcStage::HotLeakage => {
                return leakage::conclude(self, stage, plan, dc, given);
            }
            DcStage::StuckShort => Ok(contact::conclude_stuck(self, given)),
            DcStage::Blocks => conformity::conclude_blocks(self, plan, dc, given),
            DcStage::BlocksBeyond => conformity::conclude_blocks_beyond(self, plan, dc, given),
            DcStage::Conducts => conformity::conclude_conducts(self, plan, given),
            DcStage::ConductsBeyond => conformity::conclude_conducts_beyond(self, plan, given),
            DcStage::Threshold(direction) => threshold::conclude(self, direction, plan, given),
            DcStage::SearchEnds => search_ends::conclude(self, given),
            DcStage::Timing => timing::conclude(self, plan, given),
            DcStage::Resistance => resistance::conclude(self, plan, dc, given),
        };
        Ok(next?)
    }

    fn conclude_ac(
        &mut self,
        stage: AcStage,
        plan: &Plan,
        (given, now): (&Given, RigTime),
    ) -> Result<Next, Reason> {
        line::switched(given)?;
        let ac = ac_of(plan);
        Ok(match stage {
            AcStage::Reference(it) => references::conclude(self, it, ac, given, now)?,
            AcStage::Leakage | AcStage::LeakageHot => {
                line::leakage::conclude(self, stage, plan, ac, given)?
            }
            AcStage::Blocks(shift) => conforms::conclude_blocks(self, shift, plan, ac, given)?,
            AcStage::Conducts(shift) => conforms::conclude_conducts(self, shift, plan, ac, given)?,
            AcStage::Threshold(way) => staircase::conclude(self, way, plan, ac, given)?,
            AcStage::Train => train::conclude(self, plan, ac, given)?,
            AcStage::LoopReady => line::conclude_ready(self, ac, given),
            AcStage::Loop => looped::conclude(self, plan, ac, given)?,
        })
    }

    /// Adds results, which have no reply of a module behind them.
    pub fn found(&mut self, results: impl IntoIterator<Item = Found>) {
        for (of, value, unit, budget) in results {
            if !self.measures(of) {
                continue;
            }
            let reading = Reading {
                value,
                unit,
                budget: budget.covering(),
            };
            self.record.found::<Sample>(of, reading, []);
        }
    }

    /// Takes a failure of the output off the record, so that known states of the fixture decide first; returns true when
    /// there was one.
    pub fn doubts(&mut self, stage: Stage) -> bool {
        let about = |it: &Finding| it.is_about_output();
        let failure = self.record.why_failed().filter(|_| stage != Stage::Known);
        let is_doubted = failure.and_then(Finding::of).is_some_and(|it| about(&it));
        if is_doubted {
            self.doubted = self.record.take_failure();
        }
        is_doubted
    }

    /// Returns true when the test measures the characteristic of this part.
    pub fn measures(&self, of: Parameter) -> bool {
        !(self.is_no_sample && of.is_sampled())
    }

    /// Returns the corrections that the fixture has shown.
    pub fn fixture(&self) -> Fixture {
        Fixture {
            references: self.references,
            open: self.open,
        }
    }

    /// Returns the proven judgement of a limit; `None` without a proof.
    pub fn proof(&self, of: Parameter) -> Option<Judgement> {
        let mut all = self.proven.iter();
        all.find_map(|(known, judgement)| (*known == of).then_some(*judgement))
    }
}
