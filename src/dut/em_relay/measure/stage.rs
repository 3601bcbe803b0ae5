//! The stages of a test and their order.

use super::Context;
use crate::dut::em_relay::Parameter;

use crate::dut::em_relay::threshold::Direction;
use std::collections::VecDeque;

/// One stage of the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Five Kelvin bits and the resting contacts.
    Kelvin,
    /// NC contact at rest, both polarities.
    NcContact,
    /// Coil resistance at the pre-bias.
    Coil,
    /// One trial of a search by levels, towards operate or release.
    Search(Direction),
    /// Coarse ramp from the pre-bias.
    OperateCoarse,
    /// Fine ramp from just below the coarse estimate; the number of the attempt widens it.
    OperateFine(u8),
    /// Step to nominal with both gates, and NO contact on that closure.
    TimedOperate,
    /// Drive off with both gates, and NC contact on that closure.
    TimedRelease,
    /// Coarse falling ramp from a sealed armature.
    ReleaseCoarse,
    /// Fine falling ramp; the number of the attempt widens it.
    ReleaseFine(u8),
    /// Everything off, coil current gone.
    Off,
}

/// Stages of a good part: what comes before the strategies, what they ask for, what comes after.
pub(super) fn order(context: &Context) -> VecDeque<Stage> {
    let (operate, release) = (
        context.strategy(Parameter::OperateVoltage),
        context.strategy(Parameter::ReleaseVoltage),
    );
    let mut stages = VecDeque::from([
        Stage::NcContact,
        Stage::TimedOperate,
        Stage::TimedRelease,
        Stage::Coil,
    ]);
    stages.push_back(match operate.ramps() {
        true => Stage::OperateCoarse,
        false => Stage::Search(Direction::Rising),
    });
    stages.push_back(match release.ramps() {
        true => Stage::ReleaseCoarse,
        false => Stage::Search(Direction::Falling),
    });
    stages.extend(operate.always_fine().then_some(Stage::OperateFine(0)));
    stages.extend(release.always_fine().then_some(Stage::ReleaseFine(0)));
    stages.push_back(Stage::Off);
    stages
}

impl Stage {
    /// The direction of a fine ramp.
    pub(super) fn is_fine(self) -> Option<Direction> {
        match self {
            Self::OperateFine(_) => Some(Direction::Rising),
            Self::ReleaseFine(_) => Some(Direction::Falling),
            Self::Kelvin
            | Self::NcContact
            | Self::Coil
            | Self::Search(_)
            | Self::OperateCoarse
            | Self::TimedOperate
            | Self::TimedRelease
            | Self::ReleaseCoarse
            | Self::Off => None,
        }
    }

    /// One of every name.
    pub const ALL: [Self; 11] = [
        Self::Kelvin,
        Self::NcContact,
        Self::Coil,
        Self::Search(Direction::Rising),
        Self::OperateCoarse,
        Self::OperateFine(0),
        Self::TimedOperate,
        Self::TimedRelease,
        Self::ReleaseCoarse,
        Self::ReleaseFine(0),
        Self::Off,
    ];

    /// Its name in views, whatever the attempt.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kelvin => "Kelvin",
            Self::NcContact => "NcContact",
            Self::Coil => "Coil",
            Self::Search(_) => "Search",
            Self::OperateCoarse => "OperateCoarse",
            Self::OperateFine(_) => "OperateFine",
            Self::TimedOperate => "TimedOperate",
            Self::TimedRelease => "TimedRelease",
            Self::ReleaseCoarse => "ReleaseCoarse",
            Self::ReleaseFine(_) => "ReleaseFine",
            Self::Off => "Off",
        }
    }

    /// The account on which the record books its time.
    pub fn measures(self) -> &'static str {
        match self {
            Self::Kelvin => "kelvin",
            Self::NcContact => "nc_contact",
            Self::Coil => "coil",
            Self::OperateCoarse | Self::OperateFine(_) | Self::Search(Direction::Rising) => {
                "operate"
            }
            Self::ReleaseCoarse | Self::ReleaseFine(_) | Self::Search(Direction::Falling) => {
                "release"
            }
            Self::TimedOperate => "timed_operate",
            Self::TimedRelease => "timed_release",
            Self::Off => "off",
        }
    }
}
