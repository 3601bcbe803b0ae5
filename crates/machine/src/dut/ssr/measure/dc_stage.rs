//! Stages that test a part for a DC load, after the checks that every part passes.

use super::stage::{Label, Stage};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::search::Direction;

/// Stages of parts for a DC load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DcStage {
    /// Leakage of the fixture without the output.
    OpenFixture,
    /// Leakage before the output has conducted.
    ColdLeakage,
    /// Second short check, after a leakage over range: the control has turned the output on for good.
    StuckShort,
    /// The output must block at the turn-off voltage.
    Blocks,
    /// The output must block a guard band below the turn-off limit, and without control.
    BlocksBeyond,
    /// The output must conduct at the turn-on voltage.
    Conducts,
    /// The output must conduct a guard band above the turn-on limit.
    ConductsBeyond,
    /// One step of a search.
    Threshold(Direction),
    /// The ends of both searches once more.
    SearchEnds,
    /// Times of one control pulse.
    Timing,
    /// Resistance, drop and drift.
    Resistance,
    /// Leakage after conduction.
    HotLeakage,
}

impl DcStage {
    /// Every stage.
    pub const ALL: [Self; 13] = [
        Self::OpenFixture,
        Self::ColdLeakage,
        Self::StuckShort,
        Self::Blocks,
        Self::BlocksBeyond,
        Self::Conducts,
        Self::ConductsBeyond,
        Self::Threshold(Direction::Rising),
        Self::Threshold(Direction::Falling),
        Self::SearchEnds,
        Self::Timing,
        Self::Resistance,
        Self::HotLeakage,
    ];

    /// Returns the label, which names the stage in views and gives the key of its time.
    pub const fn label(self) -> Label {
        match self {
            Self::OpenFixture => Label::References,
            Self::ColdLeakage => Label::Leakage,
            Self::StuckShort => Label::Short,
            Self::Blocks | Self::BlocksBeyond => Label::Blocks,
            Self::Conducts | Self::ConductsBeyond => Label::Conducts,
            Self::Threshold(_) | Self::SearchEnds => Label::Threshold,
            Self::Timing => Label::Timing,
            Self::Resistance => Label::OnResistance,
            Self::HotLeakage => Label::LeakageHot,
        }
    }

    /// Returns the characteristics that a repetition of the stage measures again.
    pub const fn measures(self) -> &'static [Parameter] {
        use Parameter::{
            Drift, Drop, LeakageCold, LeakageHot, OnResistance, TurnOffTime, TurnOnTime,
        };
        match self {
            Self::ColdLeakage => &[LeakageCold],
            Self::Timing => &[TurnOnTime, TurnOffTime],
            Self::Resistance => &[Drop, OnResistance, Drift],
            Self::HotLeakage => &[LeakageHot],
            Self::OpenFixture
            | Self::StuckShort
            | Self::Blocks
            | Self::BlocksBeyond
            | Self::Conducts
            | Self::ConductsBeyond
            | Self::Threshold(_)
            | Self::SearchEnds => &[],
        }
    }
}

/// Returns the stages that a good part passes behind the checks of every part.
pub fn order(plan: &Plan, is_referenced: bool, is_searched: bool) -> Vec<Stage> {
    let open = (!is_referenced).then_some(DcStage::OpenFixture);
    let conducts = plan.turn_on_v.map(|_| DcStage::Conducts);
    let searches = [Direction::Rising, Direction::Falling].map(DcStage::Threshold);
    let searches = searches.into_iter().filter(|_| is_searched);
    let first = [DcStage::ColdLeakage, DcStage::Blocks];
    let last = [DcStage::Timing, DcStage::Resistance, DcStage::HotLeakage];
    let all = open
        .into_iter()
        .chain(first)
        .chain(conducts)
        .chain(searches);
    all.chain(last).map(Stage::Dc).collect()
}
