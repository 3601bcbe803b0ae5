//! Stages that test a part for an AC load, after the checks that every part passes.

use super::super::stage::{Label, Stage};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::search::Direction;

/// Control voltage of a conformity test, relative to the limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shift {
    /// A guard band before the limit, on the side that is harder for the part.
    Within,
    /// A guard band beyond the limit.
    Beyond,
    /// Far beyond the limit: without control, or at the nominal voltage.
    Far,
    /// As far beyond the limit as `Far`, after a longer time.
    Late,
}

/// A reference of the fixture and what it reveals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// A short circuit: the zero of the clamped channel.
    Zero,
    /// Open, fed by the SMU: the gain of the clamped channel.
    Gain,
    /// 1 kohm on the line: gain and delay of the voltage channel relative to the current channel.
    Ratio,
    /// Open, on the line: the admittance of the fixture.
    Stray,
}

impl Reference {
    /// Every reference in its order.
    pub const ALL: [Self; 4] = [Self::Zero, Self::Gain, Self::Ratio, Self::Stray];
}

/// Stages of parts for an AC load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AcStage {
    /// A reference of the fixture, in place of the part.
    Reference(Reference),
    /// Leakage on the line before the part has conducted.
    Leakage,
    /// The part must block at the turn-off voltage.
    Blocks(Shift),
    /// The part must conduct at the turn-on voltage, in both polarities.
    Conducts(Shift),
    /// One step of the search for a threshold.
    Threshold(Direction),
    /// Train of pulses that meet the mains at several phases.
    Train,
    /// The AC source goes to the voltage of the loop.
    LoopReady,
    /// Drop at the rated current.
    Loop,
    /// Leakage after the part has conducted.
    LeakageHot,
}

impl AcStage {
    /// Every stage.
    pub const ALL: [Self; 19] = [
        Self::Reference(Reference::Zero),
        Self::Reference(Reference::Gain),
        Self::Reference(Reference::Ratio),
        Self::Reference(Reference::Stray),
        Self::Leakage,
        Self::Blocks(Shift::Within),
        Self::Blocks(Shift::Beyond),
        Self::Blocks(Shift::Far),
        Self::Conducts(Shift::Within),
        Self::Conducts(Shift::Beyond),
        Self::Conducts(Shift::Far),
        Self::Blocks(Shift::Late),
        Self::Conducts(Shift::Late),
        Self::Threshold(Direction::Rising),
        Self::Threshold(Direction::Falling),
        Self::Train,
        Self::LoopReady,
        Self::Loop,
        Self::LeakageHot,
    ];

    /// Returns the label, which names the stage in views and gives the key of its time.
    pub const fn label(self) -> Label {
        match self {
            Self::Reference(_) => Label::References,
            Self::Leakage => Label::Leakage,
            Self::Blocks(_) => Label::Blocks,
            Self::Conducts(_) => Label::Conducts,
            Self::Threshold(_) => Label::Threshold,
            Self::Train => Label::Timing,
            Self::LoopReady | Self::Loop => Label::OnState,
            Self::LeakageHot => Label::LeakageHot,
        }
    }

    /// Returns the characteristics that a repetition of the stage measures again.
    pub const fn measures(self) -> &'static [Parameter] {
        use Parameter::{
            DcOffset, Distortion, Drift, Drop, DropRms, HalfWave, LeakageCapacitive, LeakageCold,
            LeakageHot, LeakageResistive, Retrigger, TurnOffTime, TurnOnTime, ZeroCross,
        };
        match self {
            Self::Leakage => &[LeakageCold, LeakageResistive, LeakageCapacitive],
            Self::Train => &[TurnOnTime, TurnOffTime, ZeroCross, Retrigger],
            Self::Loop => &[Drop, DropRms, DcOffset, Distortion, HalfWave, Drift],
            Self::LeakageHot => &[LeakageHot],
            Self::Reference(_)
            | Self::Blocks(_)
            | Self::Conducts(_)
            | Self::Threshold(_)
            | Self::LoopReady => &[],
        }
    }
}

/// Returns the stages of a good part, after the checks of every part. The loop comes after the train, because its
/// current heats the part; the second leakage comes after the loop.
pub fn order(is_referenced: bool, is_searched: bool) -> Vec<Stage> {
    let references = Reference::ALL.map(AcStage::Reference).into_iter();
    let references = references.filter(|_| !is_referenced);
    let searches = [Direction::Rising, Direction::Falling].map(AcStage::Threshold);
    let searches = searches.into_iter().filter(|_| is_searched);
    let first = [
        AcStage::Leakage,
        AcStage::Blocks(Shift::Within),
        AcStage::Conducts(Shift::Within),
    ];
    let last = [
        AcStage::Train,
        AcStage::LoopReady,
        AcStage::Loop,
        AcStage::LeakageHot,
    ];
    let all = references.chain(first).chain(searches).chain(last);
    all.map(Stage::Ac).collect()
}
