//! What the operation process card says of a relay.

use super::Parameter;
use super::recipe::{Clamp, RelayRecipe};
use crate::dut::card::{Card, Demand, Piece, Step, TextId};

/// Steps in the order of the card.
pub const STEPS: [&str; 10] = [
    "load",
    "clamp",
    "kelvin",
    "coil",
    "operate_voltage",
    "operate_time",
    "release_time",
    "release_voltage",
    "unclamp",
    "sort",
];

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

fn steps(relay: &RelayRecipe) -> Vec<Step> {
    vec![
        Step::load(),
        Step::clamp(),
        kelvin(),
        coil(relay),
        operate_voltage(relay),
        operate_time(relay),
        release_time(relay),
        release_voltage(relay),
        unclamp(),
        Step::sort(),
    ]
}

fn kelvin() -> Step {
    Step {
        name: "kelvin",
        what: "card-check_all_five_kelvin_connections",
        tooling: "card-pin_block_1_source",
        drive: vec![text("1 A, ±")],
        demand: within(&[Parameter::ContactResistanceNc]),
    }
}

fn coil(relay: &RelayRecipe) -> Step {
    Step {
        name: "coil",
        what: "card-measure_coil_below_pickup",
        tooling: "card-coil_supply_current_shunt",
        drive: vec![Piece::Figure(relay.test.prebias_v), text(" V")],
        demand: within(&[Parameter::CoilResistance]),
    }
}

fn operate_voltage(relay: &RelayRecipe) -> Step {
    let test = &relay.test;
    Step {
        name: "operate_voltage",
        what: "card-operate_threshold_coarse_ramp_then",
        tooling: RAMP,
        drive: vec![
            Piece::Figure(test.prebias_v),
            text(" → "),
            Piece::Figure(test.prebias_v + test.coarse_span_v),
            text(" V"),
        ],
        demand: within(&[Parameter::OperateVoltage]),
    }
}

fn operate_time(relay: &RelayRecipe) -> Step {
    Step {
        name: "operate_time",
        what: "card-timed_operate_with_bounce_no",
        tooling: TIMER,
        drive: vec![
            text("0 → "),
            Piece::Figure(relay.part.nominal_v),
            text(" V"),
        ],
        demand: within(&[
            Parameter::OperateTime,
            Parameter::OperateBounce,
            Parameter::ContactResistanceNo,
        ]),
    }
}

fn release_time(relay: &RelayRecipe) -> Step {
    let suppression = match relay.test.clamp {
        Clamp::Zener => "card-60_v_zener",
        Clamp::Diode => "card-diode",
    };
    Step {
        name: "release_time",
        what: "card-timed_release_with_bounce_nc",
        tooling: TIMER,
        drive: vec![
            Piece::Figure(relay.part.nominal_v),
            text(" → 0 V, "),
            Piece::Text(suppression),
        ],
        demand: within(&[
            Parameter::ReleaseTime,
            Parameter::ReleaseBounce,
            Parameter::ContactResistanceNc,
        ]),
    }
}

fn release_voltage(relay: &RelayRecipe) -> Step {
    Step {
        name: "release_voltage",
        what: "card-release_threshold_coarse_ramp_then",
        tooling: RAMP,
        drive: vec![Piece::Figure(relay.part.nominal_v), text(" V → 0")],
        demand: within(&[Parameter::ReleaseVoltage]),
    }
}

fn unclamp() -> Step {
    Step {
        name: "unclamp",
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

fn within(parameters: &[Parameter]) -> Demand {
    Demand::Within(parameters.iter().map(|it| (*it).into()).collect())
}
