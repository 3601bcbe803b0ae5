//! The operation process card of a relay.

use super::Parameter;
use super::measure::{SEAL, Stage};
use super::recipe::{RelayRecipe, Suppression};
use crate::dut::Characteristic;
use crate::dut::card::{Card, Demand, Piece, Step, TextId};

/// A step of the card.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CardStep {
    /// Feed from the magazine into the nest.
    Load,
    /// Close the jaws, raise the probes.
    Clamp,
    /// Kelvin check of the pins, NC contact at rest.
    Kelvin,
    /// Timed operation.
    OperateTime,
    /// Timed release.
    ReleaseTime,
    /// Coil resistance.
    Coil,
    /// Operate threshold.
    OperateVoltage,
    /// Release threshold.
    ReleaseVoltage,
    /// Coil off, probes down, jaws open.
    Unclamp,
    /// Carry from the nest into a bin.
    Sort,
}

/// Names of the steps in the order of the card.
pub const STEPS: [&str; 10] = [
    CardStep::Load.name(),
    CardStep::Clamp.name(),
    CardStep::Kelvin.name(),
    CardStep::OperateTime.name(),
    CardStep::ReleaseTime.name(),
    CardStep::Coil.name(),
    CardStep::OperateVoltage.name(),
    CardStep::ReleaseVoltage.name(),
    CardStep::Unclamp.name(),
    CardStep::Sort.name(),
];

impl CardStep {
    /// Returns the name of the step in `card.toml`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Clamp => "clamp",
            Self::Kelvin => "kelvin",
            Self::OperateTime => "operate_time",
            Self::ReleaseTime => "release_time",
            Self::Coil => "coil",
            Self::OperateVoltage => "operate_voltage",
            Self::ReleaseVoltage => "release_voltage",
            Self::Unclamp => "unclamp",
            Self::Sort => "sort",
        }
    }

    const fn text(self) -> TextId {
        match self {
            Self::Load => "card-load",
            Self::Clamp => "card-clamp",
            Self::Kelvin => "card-kelvin",
            Self::OperateTime => "card-operate_time",
            Self::ReleaseTime => "card-release_time",
            Self::Coil => "card-coil",
            Self::OperateVoltage => "card-operate_voltage",
            Self::ReleaseVoltage => "card-release_voltage",
            Self::Unclamp => "card-unclamp",
            Self::Sort => "card-sort",
        }
    }

    /// Returns the pieces that say how the step drives the coil or feeds the contact.
    fn drive(self, relay: &RelayRecipe) -> Vec<Piece> {
        let (test, nominal) = (&relay.test, Piece::Figure(relay.part.nominal_v));
        let prebias = Piece::Figure(test.prebias_v);
        match self {
            Self::Load | Self::Clamp | Self::Unclamp | Self::Sort => Vec::new(),
            Self::Kelvin => vec![literal("1 A, ±")],
            Self::OperateTime => vec![literal("0 → "), nominal, literal(" V")],
            Self::ReleaseTime => {
                let suppression = match test.suppression {
                    Suppression::Zener => "card-zener",
                    Suppression::Diode => "card-diode",
                };
                vec![nominal, literal(" → 0 V, "), Piece::Text(suppression)]
            }
            Self::Coil => vec![prebias, literal(" V")],
            Self::OperateVoltage => {
                let top = Piece::Figure(test.prebias_v + test.coarse_span_v);
                vec![prebias, literal(" → "), top, literal(" V")]
            }
            Self::ReleaseVoltage => {
                let seal = Piece::Figure(SEAL * relay.part.nominal_v);
                vec![seal, literal(" V → 0")]
            }
        }
    }

    fn of(self, relay: &RelayRecipe) -> Step {
        let all = Parameter::ALL.into_iter();
        let own = all.filter(|parameter| parameter.facts().card.contains(&self));
        let own: Vec<_> = own.map(Characteristic::from).collect();
        Step {
            drive: self.drive(relay),
            demand: match own.is_empty() {
                true => Demand::Sensors,
                false => Demand::Within(own),
            },
            ..Step::handling(self.name(), self.text())
        }
    }
}

/// Returns the card of a recipe.
pub fn card(relay: &RelayRecipe) -> Card {
    let part = &relay.part;
    let rating = vec![
        Piece::Figure(part.nominal_v),
        literal(" V, "),
        Piece::Figure(part.nominal_coil_ohm),
        literal(" Ω"),
    ];
    let conditioning = "card-conditioning";
    Card {
        rating: ("card-rated_coil", rating),
        steps: steps(relay),
        counts: vec![(conditioning, relay.test.conditioning_operations)],
    }
}

fn steps(relay: &RelayRecipe) -> Vec<Step> {
    let strategy = relay.test.strategy;
    let strategy = [strategy.operate_voltage_v, strategy.release_voltage_v];
    let mut steps = vec![CardStep::Load, CardStep::Clamp];
    for stage in Stage::planned(&relay.test, strategy) {
        let step = stage.card_step();
        if !steps.contains(&step) {
            steps.push(step);
        }
    }
    steps.push(CardStep::Sort);
    steps.into_iter().map(|step| step.of(relay)).collect()
}

fn literal(same: &'static str) -> Piece {
    Piece::Literal(same)
}
