//! Stages of the test in their order, and the characteristics that each measures.

use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::search::Direction;

/// Stages of the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Probes up, force and sense probe of each pin on metal.
    Contact,
    /// Short check of the output in both polarities.
    Short,
    /// Input current, and that of the reversed input.
    Input,
    /// Looks for the LED at the pins of the output, after the input has shown none.
    Turned,
    /// Leakage before the output has conducted.
    ColdLeakage,
    /// Short check once more, after a leakage without bounds: the control has turned the output on for ever.
    StuckShort,
    /// The output must block at the turn-off voltage.
    Blocks,
    /// The same a guard band beyond the limit, and without control.
    BlocksBeyond,
    /// The output must conduct at the turn-on voltage.
    Conducts,
    /// The same a guard band beyond the limit.
    ConductsBeyond,
    /// One step of a search.
    Threshold(Direction),
    /// Times of one control pulse.
    Timing,
    /// Resistance, drop and drift.
    Resistance,
    /// Leakage after conduction.
    HotLeakage,
    /// Sources off.
    SourcesOff,
    /// Everything disconnected, the socket discharged.
    Discharge,
}

impl Stage {
    /// Every stage.
    pub const ALL: [Self; 17] = [
        Self::Contact,
        Self::Short,
        Self::Input,
        Self::Turned,
        Self::ColdLeakage,
        Self::StuckShort,
        Self::Blocks,
        Self::BlocksBeyond,
        Self::Conducts,
        Self::ConductsBeyond,
        Self::Threshold(Direction::Rising),
        Self::Threshold(Direction::Falling),
        Self::Timing,
        Self::Resistance,
        Self::HotLeakage,
        Self::SourcesOff,
        Self::Discharge,
    ];
    /// Names of the stages in views, each once.
    pub const NAMES: [&'static str; 11] = [
        "Pins",
        "Short",
        "Input",
        "Leakage",
        "Blocks",
        "Conducts",
        "Threshold",
        "Timing",
        "OnResistance",
        "LeakageHot",
        "Discharge",
    ];

    /// Returns the name in views.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Contact => "Pins",
            Self::Short | Self::StuckShort => "Short",
            Self::Input | Self::Turned => "Input",
            Self::ColdLeakage => "Leakage",
            Self::Blocks | Self::BlocksBeyond => "Blocks",
            Self::Conducts | Self::ConductsBeyond => "Conducts",
            Self::Threshold(_) => "Threshold",
            Self::Timing => "Timing",
            Self::Resistance => "OnResistance",
            Self::HotLeakage => "LeakageHot",
            Self::SourcesOff | Self::Discharge => "Discharge",
        }
    }

    /// Returns the key under which the record keeps the time of the stage.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Contact => "pins",
            Self::Short | Self::StuckShort => "short",
            Self::Input | Self::Turned => "input",
            Self::ColdLeakage => "leakage",
            Self::Blocks | Self::BlocksBeyond => "blocks",
            Self::Conducts | Self::ConductsBeyond => "conducts",
            Self::Threshold(_) => "threshold",
            Self::Timing => "timing",
            Self::Resistance => "resistance",
            Self::HotLeakage => "leakage_hot",
            Self::SourcesOff | Self::Discharge => "discharge",
        }
    }

    /// Returns true for the stages with which every test ends.
    pub fn ends(self) -> bool {
        matches!(self, Self::SourcesOff | Self::Discharge)
    }

    /// Returns the characteristics that a repetition of the stage measures again.
    pub const fn measures(self) -> &'static [Parameter] {
        use Parameter::{
            Drift, Drop, InputCurrent, LeakageCold, LeakageHot, OnResistance, ReverseCurrent,
            TurnOffTime, TurnOnTime,
        };
        match self {
            Self::Input => &[InputCurrent, ReverseCurrent],
            Self::ColdLeakage => &[LeakageCold],
            Self::Timing => &[TurnOnTime, TurnOffTime],
            Self::Resistance => &[Drop, OnResistance, Drift],
            Self::HotLeakage => &[LeakageHot],
            Self::Contact
            | Self::Short
            | Self::StuckShort
            | Self::Turned
            | Self::Blocks
            | Self::BlocksBeyond
            | Self::Conducts
            | Self::ConductsBeyond
            | Self::Threshold(_)
            | Self::SourcesOff
            | Self::Discharge => &[],
        }
    }
}

/// Returns the stages that a good part passes, safe first, without those that end the test.
pub fn order(plan: &Plan) -> Vec<Stage> {
    let conducts = plan.turn_on_v.map(|_| Stage::Conducts);
    let searches = [Direction::Rising, Direction::Falling].map(Stage::Threshold);
    let searches = searches.into_iter().filter(|_| plan.searches);
    let first = [
        Stage::Contact,
        Stage::Short,
        Stage::Input,
        Stage::ColdLeakage,
        Stage::Blocks,
    ];
    let last = [Stage::Timing, Stage::Resistance, Stage::HotLeakage];
    let all = first.into_iter().chain(conducts).chain(searches);
    all.chain(last).collect()
}
