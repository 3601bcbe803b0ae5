//! The stages of a test and their order.

use super::Context;
use crate::dut::em_relay::card::CardStep;
use crate::dut::em_relay::recipe::TestPlan;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::em_relay::{Parameter, Strategy};
use std::collections::VecDeque;

/// One stage of the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Five Kelvin bits and both contacts at rest.
    Kelvin,
    /// Operations before the first measurement, if the recipe demands any.
    Conditioning,
    /// Resistance of the NC contact at rest, with all polarities.
    NcContact,
    /// Coil resistance at the pre-bias.
    Coil,
    /// One trial of a search by levels, towards operate or release.
    Search(Direction),
    /// Coarse ramp from the pre-bias.
    OperateCoarse,
    /// Fine ramp from just below the coarse estimate, with the number of the attempt, from 0; later ones search a wider
    /// interval.
    OperateFine(u8),
    /// Steps the coil to nominal voltage. Counter gate 0 measures the operate time, gate 1 the bounce. Then the stage
    /// measures the resistance of the closed NO contact.
    TimedOperate,
    /// Switches the coil off. Counter gate 0 measures the release time, gate 1 the bounce. Then the stage measures the
    /// resistance of the closed NC contact.
    TimedRelease,
    /// Coarse falling ramp from a sealed armature.
    ReleaseCoarse,
    /// Fine falling ramp, with the number of the attempt, from 0; later ones search a wider interval.
    ReleaseFine(u8),
    /// Outputs off, coil current decayed.
    Off,
}

/// Returns the stages of a good part on this rig after the pin check.
pub(super) fn order(context: &Context) -> VecDeque<Stage> {
    let strategy = [Parameter::OperateVoltage, Parameter::ReleaseVoltage];
    let strategy = strategy.map(|parameter| context.strategy(parameter));
    Stage::planned(&context.relay.test, strategy)
        .skip(1)
        .collect()
}

impl Stage {
    /// Returns the stages of a good part in their order, with those that the strategies of both thresholds require.
    pub fn planned(
        test: &TestPlan,
        [operate, release]: [Strategy; 2],
    ) -> impl Iterator<Item = Self> {
        let conditioning = test.conditioning_operations > 0;
        let rising = match operate.ramps() {
            true => Self::OperateCoarse,
            false => Self::Search(Direction::Rising),
        };
        let falling = match release.ramps() {
            true => Self::ReleaseCoarse,
            false => Self::Search(Direction::Falling),
        };
        let stages = [
            Some(Self::Kelvin),
            conditioning.then_some(Self::Conditioning),
            Some(Self::NcContact),
            Some(Self::TimedOperate),
            Some(Self::TimedRelease),
            Some(Self::Coil),
            Some(rising),
            Some(falling),
            operate.always_fine().then_some(Self::OperateFine(0)),
            release.always_fine().then_some(Self::ReleaseFine(0)),
            Some(Self::Off),
        ];
        stages.into_iter().flatten()
    }

    /// Returns the step of the process card that lists this stage.
    pub fn card_step(self) -> CardStep {
        match self {
            Self::Kelvin | Self::Conditioning | Self::NcContact => CardStep::Kelvin,
            Self::TimedOperate => CardStep::OperateTime,
            Self::TimedRelease => CardStep::ReleaseTime,
            Self::Coil => CardStep::Coil,
            Self::OperateCoarse | Self::OperateFine(_) | Self::Search(Direction::Rising) => {
                CardStep::OperateVoltage
            }
            Self::ReleaseCoarse | Self::ReleaseFine(_) | Self::Search(Direction::Falling) => {
                CardStep::ReleaseVoltage
            }
            Self::Off => CardStep::Unclamp,
        }
    }

    /// Returns the direction of a fine ramp; `None` for other stages.
    pub(super) fn is_fine(self) -> Option<Direction> {
        match self {
            Self::OperateFine(_) => Some(Direction::Rising),
            Self::ReleaseFine(_) => Some(Direction::Falling),
            Self::Kelvin
            | Self::Conditioning
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

    /// Every stage once, with the first attempt and one direction.
    pub const ALL: [Self; 12] = [
        Self::Kelvin,
        Self::Conditioning,
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

    /// Returns the name in views, the same for every attempt.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kelvin => "Kelvin",
            Self::Conditioning => "Conditioning",
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

    /// Returns the key under which the record adds up the time of the stage.
    pub fn measures(self) -> &'static str {
        match self {
            Self::Kelvin => "kelvin",
            Self::Conditioning => "conditioning",
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
