//! Stages of the test in their order, and the characteristics that each measures.

use super::dc_stage::{self, DcStage};
use super::line::stage::{self as ac_stage, AcStage};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{OutputPlan, Plan};

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
    /// A stage that only parts for a DC load pass.
    Dc(DcStage),
    /// A stage that only parts for an AC load pass.
    Ac(AcStage),
    /// Known states of the fixture, before a finding about the output fails the part.
    Known,
    /// All sources off.
    SourcesOff,
    /// Everything disconnected and the socket discharged.
    Discharge,
}

/// Name of a stage in views; several stages share one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Label {
    /// Contact of the pins.
    Pins,
    /// Short check.
    Short,
    /// Control input.
    Input,
    /// References of the fixture.
    References,
    /// Leakage before conduction.
    Leakage,
    /// Conformity of the turn-off voltage.
    Blocks,
    /// Conformity of the turn-on voltage.
    Conducts,
    /// Searches for thresholds.
    Threshold,
    /// Turn-on and turn-off time.
    Timing,
    /// Resistance of a DC part.
    OnResistance,
    /// Drop of an AC part.
    OnState,
    /// Leakage after conduction.
    LeakageHot,
    /// End of the test.
    Discharge,
}

impl Label {
    /// Every label.
    pub const ALL: [Self; 13] = [
        Self::Pins,
        Self::Short,
        Self::Input,
        Self::References,
        Self::Leakage,
        Self::Blocks,
        Self::Conducts,
        Self::Threshold,
        Self::Timing,
        Self::OnResistance,
        Self::OnState,
        Self::LeakageHot,
        Self::Discharge,
    ];

    /// Returns the name in views, and the key under which the record keeps the time of the stage.
    const fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Pins => ("Pins", "pins"),
            Self::Short => ("Short", "short"),
            Self::Input => ("Input", "input"),
            Self::References => ("References", "references"),
            Self::Leakage => ("Leakage", "leakage"),
            Self::Blocks => ("Blocks", "blocks"),
            Self::Conducts => ("Conducts", "conducts"),
            Self::Threshold => ("Threshold", "threshold"),
            Self::Timing => ("Timing", "timing"),
            Self::OnResistance => ("OnResistance", "resistance"),
            Self::OnState => ("OnState", "on_state"),
            Self::LeakageHot => ("LeakageHot", "leakage_hot"),
            Self::Discharge => ("Discharge", "discharge"),
        }
    }

    /// Returns the name in views.
    pub const fn name(self) -> &'static str {
        self.names().0
    }
}

impl Stage {
    /// Returns every stage of parts with this output, those after a failure included.
    pub fn all(output: &OutputPlan) -> Vec<Self> {
        let own: Vec<Self> = match output {
            OutputPlan::Dc(_) => DcStage::ALL.map(Self::Dc).into(),
            OutputPlan::Ac(_) => AcStage::ALL.map(Self::Ac).into(),
        };
        let first = [Self::Contact, Self::Short, Self::Input, Self::Turned];
        let last = [Self::Known, Self::SourcesOff, Self::Discharge];
        first.into_iter().chain(own).chain(last).collect()
    }

    const fn label(self) -> Label {
        match self {
            Self::Contact => Label::Pins,
            Self::Short => Label::Short,
            Self::Input | Self::Turned => Label::Input,
            Self::Dc(stage) => stage.label(),
            Self::Ac(stage) => stage.label(),
            Self::Known => Label::References,
            Self::SourcesOff | Self::Discharge => Label::Discharge,
        }
    }

    /// Returns the name in views.
    pub const fn name(self) -> &'static str {
        self.label().names().0
    }

    /// Returns the key under which the record keeps the time of the stage.
    pub const fn key(self) -> &'static str {
        self.label().names().1
    }

    /// Returns true for the stages with which every test ends.
    pub fn ends(self) -> bool {
        matches!(self, Self::SourcesOff | Self::Discharge)
    }

    /// Returns the characteristics that a repetition of the stage measures again.
    pub const fn measures(self) -> &'static [Parameter] {
        match self {
            Self::Input => &[Parameter::InputCurrent, Parameter::ReverseCurrent],
            Self::Dc(stage) => stage.measures(),
            Self::Ac(stage) => stage.measures(),
            Self::Contact
            | Self::Short
            | Self::Turned
            | Self::Known
            | Self::SourcesOff
            | Self::Discharge => &[],
        }
    }
}

/// Returns the stages of a good part, without those that end the test, the safe ones first. The stages on the line come
/// only after those that show an output that blocks 5 V and a sound input.
pub fn order(plan: &Plan, is_referenced: bool, is_searched: bool) -> Vec<Stage> {
    let own = match &plan.output {
        OutputPlan::Dc(_) => dc_stage::order(plan, is_referenced, is_searched),
        OutputPlan::Ac(_) => ac_stage::order(is_referenced, is_searched),
    };
    let safe = [Stage::Contact, Stage::Short, Stage::Input];
    safe.into_iter().chain(own).collect()
}
