//! What the operation process card says of a relay.

use super::Parameter;
use super::measure::{SEAL, Stage};
use super::recipe::{Clamp, RelayRecipe};
use crate::dut::Characteristic;
use crate::dut::card::{Card, Demand, Piece, Step, TextId};

/// A step of the card.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CardStep {
    /// From the magazine into the nest.
    Load,
    /// Jaws and probes.
    Clamp,
    /// Pins and NC contact at rest.
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
    /// Off, probes and jaws.
    Unclamp,
    /// From the nest into a bin.
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
    /// Its name in `card.toml`.
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

    /// The limits of the characteristics that belong to it.
    fn demand(self) -> Demand {
        let all = Parameter::ALL.into_iter();
        let own = all.filter(|parameter| parameter.facts().card.contains(&self));
        Demand::Within(own.map(Characteristic::from).collect())
    }

    fn of(self, relay: &RelayRecipe) -> Step {
        match self {
            Self::Load => Step::load(),
            Self::Clamp => Step::clamp(),
            Self::Kelvin => kelvin(),
            Self::OperateTime => operate_time(relay),
            Self::ReleaseTime => release_time(relay),
            Self::Coil => coil(relay),
            Self::OperateVoltage => operate_voltage(relay),
            Self::ReleaseVoltage => release_voltage(relay),
            Self::Unclamp => unclamp(),
            Self::Sort => Step::sort(),
        }
    }
}

/// The card of a recipe.
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

/// The steps in the order in which the test enters their stages.
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

fn kelvin() -> Step {
    Step {
        name: CardStep::Kelvin.name(),
        what: "card-check_all_five_kelvin_connections",
        tooling: "card-pin_block_1_source",
        drive: vec![text("1 A, ±")],
        demand: CardStep::Kelvin.demand(),
    }
}

fn coil(relay: &RelayRecipe) -> Step {
    Step {
        name: CardStep::Coil.name(),
        what: "card-measure_coil_below_pickup",
        tooling: "card-coil_supply_current_shunt",
        drive: vec![Piece::Figure(relay.test.prebias_v), text(" V")],
        demand: CardStep::Coil.demand(),
    }
}

fn operate_voltage(relay: &RelayRecipe) -> Step {
    let test = &relay.test;
    Step {
        name: CardStep::OperateVoltage.name(),
        what: "card-operate_threshold_coarse_ramp_then",
        tooling: RAMP,
        drive: vec![
            Piece::Figure(test.prebias_v),
            text(" → "),
            Piece::Figure(test.prebias_v + test.coarse_span_v),
            text(" V"),
        ],
        demand: CardStep::OperateVoltage.demand(),
    }
}

fn operate_time(relay: &RelayRecipe) -> Step {
    Step {
        name: CardStep::OperateTime.name(),
        what: "card-timed_operate_with_bounce_no",
        tooling: TIMER,
        drive: vec![
            text("0 → "),
            Piece::Figure(relay.part.nominal_v),
            text(" V"),
        ],
        demand: CardStep::OperateTime.demand(),
    }
}

fn release_time(relay: &RelayRecipe) -> Step {
    let suppression = match relay.test.clamp {
        Clamp::Zener => "card-60_v_zener",
        Clamp::Diode => "card-diode",
    };
    Step {
        name: CardStep::ReleaseTime.name(),
        what: "card-timed_release_with_bounce_nc",
        tooling: TIMER,
        drive: vec![
            Piece::Figure(relay.part.nominal_v),
            text(" → 0 V, "),
            Piece::Text(suppression),
        ],
        demand: CardStep::ReleaseTime.demand(),
    }
}

fn release_voltage(relay: &RelayRecipe) -> Step {
    Step {
        name: CardStep::ReleaseVoltage.name(),
        what: "card-release_threshold_coarse_ramp_then",
        tooling: RAMP,
        drive: vec![Piece::Figure(SEAL * relay.part.nominal_v), text(" V → 0")],
        demand: CardStep::ReleaseVoltage.demand(),
    }
}

fn unclamp() -> Step {
    Step {
        name: CardStep::Unclamp.name(),
        what: "card-coil_off_current_1_ma_pin_block",
        tooling: "card-probe_lift_jaws",
        drive: Vec::new(),
        demand: Demand::Seen("card-down_open_their_sensors"),
    }
}

const RAMP: TextId = "card-coil_supply_gated_counter";
const TIMER: TextId = "card-counters_1_source";

fn text(same: &'static str) -> Piece {
    Piece::Literal(same)
}
