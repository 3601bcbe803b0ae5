//! What the operation process card says of a relay.

use super::Parameter;
use super::recipe::{Clamp, RelayRecipe};
use crate::dut::card::{Card, Demand, Piece, Step};
use crate::dut::words::Words;

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
    let conditioning = Words::of("operations before the test", "测前预动作次数");
    Card {
        rating: (Words::of("Coil, nominal", "线圈额定值"), rating),
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
        what: Words::of(
            "Check all five Kelvin connections and the pin map; NC contact",
            "检查五路开尔文连接与引脚；测常闭触点",
        ),
        tooling: Words::of("pin block, 1 A source", "探针座、1 A 恒流源"),
        drive: vec![text("1 A, ±")],
        demand: within(&[Parameter::ContactResistanceNc]),
    }
}

fn coil(relay: &RelayRecipe) -> Step {
    Step {
        name: "coil",
        what: Words::of("Measure the coil below pickup", "低于动作值测线圈电阻"),
        tooling: Words::of("coil supply, current shunt", "线圈电源、分流器"),
        drive: vec![Piece::Figure(relay.test.prebias_v), text(" V")],
        demand: within(&[Parameter::CoilResistance]),
    }
}

fn operate_voltage(relay: &RelayRecipe) -> Step {
    let test = &relay.test;
    Step {
        name: "operate_voltage",
        what: Words::of(
            "Operate threshold: coarse ramp, then fine ramp",
            "动作电压：粗扫后细扫",
        ),
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
        what: Words::of(
            "Timed operate with bounce; NO contact on that closure",
            "额定激励动作时间与回跳；测常开触点",
        ),
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
        Clamp::Zener => Words::of("60 V zener", "60 V 稳压管"),
        Clamp::Diode => Words::of("diode", "二极管"),
    };
    Step {
        name: "release_time",
        what: Words::of(
            "Timed release with bounce; NC contact on that closure",
            "释放时间与回跳；再测常闭触点",
        ),
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
        what: Words::of(
            "Release threshold: coarse ramp, then fine ramp",
            "释放电压：粗扫后细扫",
        ),
        tooling: RAMP,
        drive: vec![Piece::Figure(relay.part.nominal_v), text(" V → 0")],
        demand: within(&[Parameter::ReleaseVoltage]),
    }
}

fn unclamp() -> Step {
    Step {
        name: "unclamp",
        what: Words::of(
            "Coil off, current < 1 mA; pin block down, jaws open",
            "断电，电流 < 1 mA；探针下降，夹爪松开",
        ),
        tooling: Words::of("probe lift, jaws", "探针升降缸、夹爪"),
        drive: Vec::new(),
        demand: Demand::Seen(Words::of("down and open by their sensors", "传感器确认")),
    }
}

const RAMP: Words = Words::of("coil supply, gated counter", "线圈电源、门控计数器");
const TIMER: Words = Words::of("counters, 1 A source", "计数器、1 A 恒流源");

fn text(same: &'static str) -> Piece {
    Piece::Text(Words::same(same))
}

fn within(parameters: &[Parameter]) -> Demand {
    Demand::Within(parameters.iter().map(|it| (*it).into()).collect())
}
