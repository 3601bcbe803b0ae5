//! State of a test, and the two steps of a stage: its acts, then its conclusion.

use super::board::BoardState;
use super::pace::Pace;
use super::plan::Plan;
use super::search::Search;
use super::{Context, Stage, TestRecord};
use super::{
    coil, conditioning, contact, fine, kelvin, operate, operate_fine, release, search, timing,
};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::threshold::Direction;

/// State of a test between two stages.
#[derive(Debug, Clone)]
pub(super) struct TestState {
    /// State of the interface board.
    pub board: BoardState,
    /// Data for the stages to come.
    pub plan: Plan,
    /// Results so far.
    pub record: TestRecord,
}

impl TestState {
    /// Returns the state before the first stage.
    pub fn new(context: &Context) -> Self {
        Self {
            board: BoardState::new(context),
            plan: Plan::default(),
            record: TestRecord::default(),
        }
    }

    /// Enters a stage: returns its acts and keeps the state in which they leave the board.
    pub fn enter(&mut self, stage: Stage, context: &Context) -> Vec<Act> {
        self.board.ramp = None;
        let (acts, board) = self.acts(stage, context);
        board.check(context);
        self.board = board;
        acts
    }

    fn acts(&self, stage: Stage, context: &Context) -> (Vec<Act>, BoardState) {
        let (board, record) = (self.board, &self.record);
        let interval = |direction| self.plan.interval(direction);
        match stage {
            Stage::Kelvin => (kelvin::acts(context), board),
            Stage::Conditioning => conditioning::acts(context, board),
            Stage::NcContact => contact::acts_nc(context, board),
            Stage::Coil => {
                let repeated = record.attempts(Parameter::CoilResistance) > 0;
                coil::acts(context, board, repeated)
            }
            Stage::Search(direction) => {
                let search = Search::under_way(context, &self.plan, record, direction);
                search::acts(context, board, record, search)
            }
            Stage::OperateCoarse => operate::acts_coarse(context, board),
            Stage::OperateFine(_) => {
                let interval = interval(Direction::Rising);
                operate_fine::acts(context, board, interval, Pace::of(record))
            }
            Stage::TimedOperate => timing::acts_operate(context, board),
            Stage::TimedRelease => timing::acts_release(context, board),
            Stage::ReleaseCoarse => {
                let operated = record.own.operate;
                let after_coarse = operated.is_some_and(|ramp| ramp.fine.is_none());
                release::acts_coarse(context, board, after_coarse)
            }
            Stage::ReleaseFine(_) => {
                release::acts_fine(context, board, interval(Direction::Falling))
            }
            Stage::Off => coil::acts_off(context, board, record.stopped()),
        }
    }

    /// Concludes a stage from its readings. Returns the stage to insert before the planned ones, if any.
    pub fn conclude(
        &mut self,
        stage: Stage,
        context: &Context,
        readings: &Readings,
    ) -> Option<Stage> {
        match stage {
            Stage::Kelvin => kelvin::conclude(readings, self),
            Stage::Conditioning => None,
            Stage::NcContact => contact::conclude_nc(context, readings, self),
            Stage::Coil => coil::conclude(context, readings, self),
            Stage::Search(direction) => search::conclude(context, readings, self, direction),
            Stage::OperateCoarse => operate::conclude_coarse(context, readings, self),
            Stage::OperateFine(attempt) => {
                fine::conclude(context, readings, self, (Direction::Rising, attempt))
            }
            Stage::TimedOperate => timing::conclude_operate(context, readings, self),
            Stage::TimedRelease => timing::conclude_release(context, readings, self),
            Stage::ReleaseCoarse => release::conclude_coarse(context, readings, self),
            Stage::ReleaseFine(attempt) => {
                fine::conclude(context, readings, self, (Direction::Falling, attempt))
            }
            Stage::Off => coil::conclude_off(readings, self),
        }
    }
}
