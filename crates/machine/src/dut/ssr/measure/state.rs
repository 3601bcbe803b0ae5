//! State of a test between its stages: position of the fixture, searches, results. Each stage lists its acts, then
//! concludes from what they have read.

use super::board::Position;
use super::given::{Given, NotDelivered};
use super::stage::Stage;
use super::{conformity, contact, discharge, input, leakage, resistance, threshold, timing};
use crate::dut::record::TestRecord;
use crate::dut::ssr::Finding;
use crate::dut::ssr::learned::Learned;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::Points;
use crate::dut::ssr::search::Search;
use crate::gauge::{Budget, Judgement, Reading};
use crate::instrument::act::Act;
use crate::instrument::readings::Readings;
use crate::rig::sample::Sample;
use units::Unit;

/// State of a test between its stages.
#[derive(Debug, Default)]
pub struct State {
    /// Results so far.
    pub record: TestRecord,
    /// Connections of the fixture.
    pub position: Position,
    /// Finding that holds unless the next stage finds another cause.
    pub suspected: Option<Finding>,
    /// Thresholds of earlier parts.
    pub learned: Learned,
    /// Search under way.
    pub search: Option<Search>,
    /// Upper end of the interval that holds the turn-on voltage, V.
    pub turn_on_v: Option<f64>,
    /// What the conformity tests have proven about limits.
    pub proven: Vec<(Parameter, Judgement)>,
    /// Number of looks at the socket at the end of the test.
    pub looks: u32,
    /// True once the socket is proven to be discharged and below 30 V.
    pub is_discharged: bool,
}

/// What a stage demands after its conclusion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// The next planned stage.
    Planned,
    /// This stage first.
    Insert(Stage),
}

/// A value of a characteristic with its unit and budget.
pub type Found = (Parameter, f64, Unit, Budget);

impl State {
    /// Returns the acts of a stage, and takes over the position in which they leave the fixture.
    pub fn acts(&mut self, stage: Stage, plan: &Plan, points: &Points) -> Vec<Act> {
        match stage {
            Stage::Contact => contact::acts(points),
            Stage::Short => contact::short_acts(points),
            Stage::StuckShort => contact::stuck_acts(self, points),
            Stage::Input => input::acts(self, plan, points),
            Stage::Turned => input::turned_acts(self, plan, points),
            Stage::ColdLeakage => leakage::acts(self, &plan.leakage_cold, plan, points),
            Stage::HotLeakage => leakage::acts(self, &plan.leakage_hot, plan, points),
            Stage::Blocks => conformity::block_acts(self, plan, points),
            Stage::BlocksBeyond => conformity::block_beyond_acts(plan, points),
            Stage::Conducts => conformity::conduct_acts(plan, points, -plan.guard_v),
            Stage::ConductsBeyond => conformity::conduct_acts(plan, points, plan.guard_v),
            Stage::Threshold(direction) => threshold::acts(self, direction, plan, points),
            Stage::Timing => timing::acts(self, plan, points),
            Stage::Resistance => resistance::acts(self, plan, points),
            Stage::SourcesOff => discharge::off_acts(points),
            Stage::Discharge => discharge::acts(self, points),
        }
    }

    /// Concludes from the readings of a stage.
    pub fn conclude(
        &mut self,
        stage: Stage,
        plan: &Plan,
        points: &Points,
        readings: &Readings,
    ) -> Next {
        let given = Given { points, readings };
        let next = match stage {
            Stage::Contact => Ok(contact::conclude(&mut self.record, &given)),
            Stage::Short => Ok(contact::conclude_short(&mut self.record, plan, &given)),
            Stage::StuckShort => Ok(contact::conclude_stuck(self, &given)),
            Stage::Input => input::conclude(self, plan, &given),
            Stage::Turned => input::conclude_turned(self, &given),
            Stage::ColdLeakage | Stage::HotLeakage => leakage::conclude(self, stage, plan, &given),
            Stage::Blocks => conformity::conclude_blocks(self, plan, &given),
            Stage::BlocksBeyond => conformity::conclude_blocks_beyond(self, &given),
            Stage::Conducts => conformity::conclude_conducts(self, &given),
            Stage::ConductsBeyond => conformity::conclude_conducts_beyond(self, &given),
            Stage::Threshold(direction) => threshold::conclude(self, direction, plan, &given),
            Stage::Timing => timing::conclude(self, plan, &given),
            Stage::Resistance => resistance::conclude(self, plan, &given),
            Stage::SourcesOff => Ok(Next::Planned),
            Stage::Discharge => Ok(discharge::conclude(self, &given)),
        };
        next.unwrap_or_else(|NotDelivered(device)| {
            self.record.stop(Finding::NotDelivered.with(device.name()));
            Next::Planned
        })
    }

    /// Adds results, which have no reply of a module behind them.
    pub fn found(&mut self, results: impl IntoIterator<Item = Found>) {
        for (of, value, unit, budget) in results {
            let reading = Reading {
                value,
                unit,
                budget,
            };
            self.record.found::<Sample>(of, reading, []);
        }
    }

    /// Returns what is proven about a limit.
    pub fn proof(&self, of: Parameter) -> Option<Judgement> {
        let mut all = self.proven.iter();
        all.find_map(|(known, judgement)| (*known == of).then_some(*judgement))
    }
}
