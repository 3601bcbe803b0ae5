//! What the operation process card says of a relay.

use super::Parameter;
use super::measure::{SEAL, Stage};
use super::recipe::{Clamp, RelayRecipe};
use crate::dut::Characteristic;
use crate::dut::card::{Card, Demand, Piece, Step};
use crate::dut::words::Words;

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
    let conditioning = Words::of("operations before the test", "测前预动作次数");
    Card {
        rating: (Words::of("Coil, nominal", "线圈额定值"), rating),
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
        what: Words::of(
            "Check all five Kelvin connections and the pin map; NC contact",
            "检查五路开尔文连接与引脚；测常闭触点",
        ),
        tooling: Words::of("pin block, 1 A source", "探针座、1 A 恒流源"),
        drive: vec![text("1 A, ±")],
        demand: CardStep::Kelvin.demand(),
    }
}

fn coil(relay: &RelayRecipe) -> Step {
    Step {
        name: CardStep::Coil.name(),
        what: Words::of("Measure the coil below pickup", "低于动作值测线圈电阻"),
        tooling: Words::of("coil supply, current shunt", "线圈电源、分流器"),
        drive: vec![Piece::Figure(relay.test.prebias_v), text(" V")],
        demand: CardStep::Coil.demand(),
    }
}

fn operate_voltage(relay: &RelayRecipe) -> Step {
    let test = &relay.test;
    Step {
        name: CardStep::OperateVoltage.name(),
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
        demand: CardStep::OperateVoltage.demand(),
    }
}

fn operate_time(relay: &RelayRecipe) -> Step {
    Step {
        name: CardStep::OperateTime.name(),
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
        demand: CardStep::OperateTime.demand(),
    }
}

fn release_time(relay: &RelayRecipe) -> Step {
    let suppression = match relay.test.clamp {
        Clamp::Zener => Words::of("60 V zener", "60 V 稳压管"),
        Clamp::Diode => Words::of("diode", "二极管"),
    };
    Step {
        name: CardStep::ReleaseTime.name(),
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
        demand: CardStep::ReleaseTime.demand(),
    }
}

fn release_voltage(relay: &RelayRecipe) -> Step {
    Step {
        name: CardStep::ReleaseVoltage.name(),
        what: Words::of(
            "Release threshold: coarse ramp, then fine ramp",
            "释放电压：粗扫后细扫",
        ),
        tooling: RAMP,
        drive: vec![Piece::Figure(SEAL * relay.part.nominal_v), text(" V → 0")],
        demand: CardStep::ReleaseVoltage.demand(),
    }
}

fn unclamp() -> Step {
    Step {
        name: CardStep::Unclamp.name(),
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
