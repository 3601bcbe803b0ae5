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

    /// Returns the limits of its characteristics, or the sensors that confirm it.
    fn demand(self) -> Demand {
        if self == Self::Unclamp {
            return Demand::Sensors("card-down_open_their_sensors");
        }
        let all = Parameter::ALL.into_iter();
        let own = all.filter(|parameter| parameter.facts().card.contains(&self));
        Demand::Within(own.map(Characteristic::from).collect())
    }

    fn of(self, relay: &RelayRecipe) -> Step {
        let (part, test) = (&relay.part, &relay.test);
        let nominal = Piece::Figure(part.nominal_v);
        let prebias = Piece::Figure(test.prebias_v);
        let (what, tooling, drive) = match self {
            Self::Load => return Step::load(),
            Self::Clamp => return Step::clamp(),
            Self::Sort => return Step::sort(),
            Self::Kelvin => (
                "card-check_all_five_kelvin_connections",
                "card-pin_block_1_source",
                vec![text("1 A, ±")],
            ),
            Self::OperateTime => (
                "card-timed_operate_with_bounce_no",
                TIMER,
                vec![text("0 → "), nominal, text(" V")],
            ),
            Self::ReleaseTime => (
                "card-timed_release_with_bounce_nc",
                TIMER,
                vec![nominal, text(" → 0 V, "), suppression(test.suppression)],
            ),
            Self::Coil => (
                "card-measure_coil_below_pickup",
                "card-coil_supply_current_shunt",
                vec![prebias, text(" V")],
            ),
            Self::OperateVoltage => {
                let top = Piece::Figure(test.prebias_v + test.coarse_span_v);
                let drive = vec![prebias, text(" → "), top, text(" V")];
                ("card-operate_threshold_coarse_ramp_then", RAMP, drive)
            }
            Self::ReleaseVoltage => {
                let drive = vec![Piece::Figure(SEAL * part.nominal_v), text(" V → 0")];
                ("card-release_threshold_coarse_ramp_then", RAMP, drive)
            }
            Self::Unclamp => (
                "card-coil_off_current_1_ma_pin_block",
                "card-probe_lift_jaws",
                Vec::new(),
            ),
        };
        Step {
            name: self.name(),
            what,
            tooling,
            drive,
            demand: self.demand(),
        }
    }
}

/// Returns the card of a recipe.
pub fn card(relay: &RelayRecipe) -> Card {
    let part = &relay.part;
    let rating = vec![
        Piece::Figure(part.nominal_v),
        text(" V, "),
        Piece::Figure(part.nominal_coil_ohm),
        text(" Ω"),
    ];
    let conditioning = "card-operations_before_test";
    Card {
        rating: ("card-coil_nominal", rating),
        steps: steps(relay),
        counts: vec![(conditioning, relay.test.conditioning_operations)],
    }
}

/// Returns the steps in the order in which the test enters their stages.
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

fn suppression(suppression: Suppression) -> Piece {
    Piece::Text(match suppression {
        Suppression::Zener => "card-60_v_zener",
        Suppression::Diode => "card-diode",
    })
}

const RAMP: TextId = "card-coil_supply_gated_counter";
const TIMER: TextId = "card-counters_1_source";

fn text(literal: &'static str) -> Piece {
    Piece::Literal(literal)
}
