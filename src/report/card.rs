//! The operation process card of a recipe: what is done to a part, with what, by which figures, in which
//! time. The form is the customary one of machining (header, steps, tooling, parameters, time quota,
//! sign-off), its columns for spindle and feed replaced by drive, limits and decision.
//!
//! Steps and their order are those of the station ([`STEPS`]); limits and drive come from the recipe; the
//! plant's own figures from `card.toml` ([`CardSettings`]).

use super::page::{Format, page};
use super::words::{Language, figure};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::recipe::Clamp;
use crate::dut::recipe::{DeviceRecipe, Recipe};
use crate::gauge::Rule;
use maud::{Markup, html};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Steps of the card in their order, by the names of `card.toml`.
pub const STEPS: &[&str] = &[
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

/// Planned times of one step, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
pub struct Quota {
    /// The step itself.
    pub machine_s: f64,
    /// Beside it.
    pub auxiliary_s: f64,
}

/// What the plant adds to the recipe, from `card.toml`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct CardSettings {
    /// Workshop.
    pub workshop: String,
    /// Number of the operation in the process.
    pub operation_no: String,
    /// Type of the rig.
    pub equipment_model: String,
    /// Its inventory number.
    pub equipment_no: String,
    /// Number of nest and pin block.
    pub fixture_no: String,
    /// Parts tested at the same time.
    pub pieces_at_once: u32,
    /// Preparing and ending a lot, min.
    pub preparation_min: f64,
    /// Time quota by step.
    pub quota: BTreeMap<String, Quota>,
}

/// One line of the card.
struct Step {
    what: String,
    tooling: &'static str,
    drive: String,
    demand: String,
}

/// The card as one page of HTML, A4 lengthwise.
pub fn card(language: Language, recipe: &Recipe, plant: &CardSettings, made: &str) -> String {
    let title = language.of("Operation process card", "检验工序卡");
    let body = html! {
        (header(language, recipe, plant))
        (steps(language, recipe, plant))
        p.note { (remarks(language, recipe)) }
        p.remark { (language.not_tested()) }
        (signatures(language))
    };
    page(language, Format::Landscape, title, made, &body)
}

fn header(language: Language, recipe: &Recipe, plant: &CardSettings) -> Markup {
    let of = |en, zh| language.of(en, zh);
    let DeviceRecipe::EmRelay(relay) = &recipe.device;
    let (part, quota) = (&relay.part, total(plant));
    let [x, y, z] = part.body_mm;
    html! {
        table.card {
            tr {
                th.title colspan="4" rowspan="2" { (of("Operation process card", "检验工序卡")) }
                th { (of("Product type", "产品型号")) } td { (recipe.name) }
                th { (of("Drawing no.", "零(部)件图号")) } td {}
            }
            tr {
                th { (of("Product", "产品名称")) } td { (of(&recipe.title_en, &recipe.title_zh)) }
                th { (of("Page", "页次")) } td { (of("1 of 1", "共 1 页 第 1 页")) }
            }
            tr {
                th { (of("Workshop", "车间")) } th { (of("Operation no.", "工序号")) }
                th colspan="2" { (of("Operation", "工序名称")) }
                th { (of("Coil, nominal", "线圈额定值")) } th { (of("Body x, y, z / mm", "外形尺寸 mm")) }
                th { (of("Pins / mm", "引脚长 mm")) } th { (of("Reference temp.", "基准温度")) }
            }
            tr {
                td { (plant.workshop) } td { (plant.operation_no) }
                td colspan="2" { (of("Performance test and sorting", "性能检测与分选")) }
                td { (figure(Some(part.nominal_v))) " V, " (figure(Some(part.nominal_coil_ohm))) " Ω" }
                td { (figure(Some(x))) " × " (figure(Some(y))) " × " (figure(Some(z))) }
                td { (figure(Some(part.pin_length_mm))) } td { (figure(Some(part.reference_temperature_c))) " °C" }
            }
            tr {
                th { (of("Equipment", "设备名称")) } th { (of("Type", "设备型号")) }
                th { (of("No.", "设备编号")) } th { (of("Parts at once", "同时加工件数")) }
                th { (of("Fixture", "夹具名称")) } th { (of("Fixture no.", "夹具编号")) }
                th { (of("Preparation / min", "准终工时 min")) } th { (of("Per part / s", "单件工时 s")) }
            }
            tr {
                td { (of("Relay performance tester", "继电器性能测试机")) } td { (plant.equipment_model) }
                td { (plant.equipment_no) } td { (plant.pieces_at_once) }
                td { (of("Nest, Kelvin pin block", "测试座、开尔文探针")) } td { (plant.fixture_no) }
                td { (figure(Some(plant.preparation_min))) } td { (format!("{quota:.2}")) }
            }
        }
    }
}

/// Sum of all quotas, s.
fn total(plant: &CardSettings) -> f64 {
    plant
        .quota
        .values()
        .map(|it| it.machine_s + it.auxiliary_s)
        .sum()
}

fn steps(language: Language, recipe: &Recipe, plant: &CardSettings) -> Markup {
    let of = |en, zh| language.of(en, zh);
    html! {
        table.card {
            thead {
                tr {
                    th rowspan="2" { (of("No.", "序号")) }
                    th rowspan="2" { (of("Step", "工步内容")) }
                    th rowspan="2" { (of("Tooling", "工艺装备")) }
                    th rowspan="2" { (of("Drive", "激励条件")) }
                    th rowspan="2" { (of("Demand", "技术要求")) }
                    th colspan="2" { (of("Time quota / s", "时间定额 s")) }
                }
                tr { th { (of("machine", "机动")) } th { (of("auxiliary", "辅助")) } }
            }
            tbody {
                @for (number, name) in (1..).zip(STEPS) {
                    @let step = step(language, recipe, name);
                    @let quota = plant.quota.get(*name).copied().unwrap_or_default();
                    tr {
                        td { (number) } td.text { (step.what) } td.text { (step.tooling) }
                        td.text { (step.drive) } td.text { (step.demand) }
                        td { (format!("{:.2}", quota.machine_s)) } td { (format!("{:.2}", quota.auxiliary_s)) }
                    }
                }
            }
        }
    }
}

fn step(language: Language, recipe: &Recipe, name: &str) -> Step {
    let of = |en: &'static str, zh: &'static str| language.of(en, zh);
    let demand = |parameters: &[Parameter]| demands(language, recipe, parameters);
    let DeviceRecipe::EmRelay(relay) = &recipe.device;
    let (nominal, test) = (figure(Some(relay.part.nominal_v)), &relay.test);
    let number = |value: f64| figure(Some(value));
    let none = String::new();
    let (what, tooling, drive, demand) = match name {
        "load" => (
            of(
                "Let one part into the pocket, push it into the nest",
                "放行一件，推入测试座",
            ),
            of("escapement, pusher", "隔料器、推料缸"),
            none,
            of("part present", "有件到位").to_owned(),
        ),
        "clamp" => (
            of(
                "Close both jaws, raise the pin block",
                "两侧夹爪夹紧，探针上升",
            ),
            of("jaws, probe lift", "夹爪、探针升降缸"),
            none,
            of("closed and up by their sensors", "传感器确认").to_owned(),
        ),
        "kelvin" => (
            of(
                "Check all five Kelvin connections and the pin map; NC contact",
                "检查五路开尔文连接与引脚；测常闭触点",
            ),
            of("pin block, 1 A source", "探针座、1 A 恒流源"),
            "1 A, ±".to_owned(),
            demand(&[Parameter::ContactResistanceNc]),
        ),
        "coil" => (
            of("Measure the coil below pickup", "低于动作值测线圈电阻"),
            of("coil supply, current shunt", "线圈电源、分流器"),
            format!("{} V", number(test.prebias_v)),
            demand(&[Parameter::CoilResistance]),
        ),
        "operate_voltage" => (
            of(
                "Operate threshold: coarse ramp, then fine ramp",
                "动作电压：粗扫后细扫",
            ),
            of("coil supply, gated counter", "线圈电源、门控计数器"),
            format!(
                "{} → {} V",
                number(test.prebias_v),
                number(test.prebias_v + test.coarse_span_v)
            ),
            demand(&[Parameter::OperateVoltage]),
        ),
        "operate_time" => (
            of(
                "Timed operate with bounce; NO contact on that closure",
                "额定激励动作时间与回跳；测常开触点",
            ),
            of("counters, 1 A source", "计数器、1 A 恒流源"),
            format!("0 → {nominal} V"),
            demand(&[
                Parameter::OperateTime,
                Parameter::OperateBounce,
                Parameter::ContactResistanceNo,
            ]),
        ),
        "release_time" => (
            of(
                "Timed release with bounce; NC contact on that closure",
                "释放时间与回跳；再测常闭触点",
            ),
            of("counters, 1 A source", "计数器、1 A 恒流源"),
            format!("{nominal} → 0 V, {}", suppression(language, test.clamp)),
            demand(&[
                Parameter::ReleaseTime,
                Parameter::ReleaseBounce,
                Parameter::ContactResistanceNc,
            ]),
        ),
        "release_voltage" => (
            of(
                "Release threshold: coarse ramp, then fine ramp",
                "释放电压：粗扫后细扫",
            ),
            of("coil supply, gated counter", "线圈电源、门控计数器"),
            format!("{nominal} V → 0"),
            demand(&[Parameter::ReleaseVoltage]),
        ),
        "unclamp" => (
            of(
                "Coil off, current < 1 mA; pin block down, jaws open",
                "断电，电流 < 1 mA；探针下降，夹爪松开",
            ),
            of("probe lift, jaws", "探针升降缸、夹爪"),
            none,
            of("down and open by their sensors", "传感器确认").to_owned(),
        ),
        _ => (
            of(
                "Carry the part to the bin of its verdict, confirm by beam",
                "按判定送入料箱，光电确认",
            ),
            of("gripper, sort axis", "气爪、分选轴"),
            none,
            of("one count of the beam", "光电计数为一").to_owned(),
        ),
    };
    Step {
        what: what.to_owned(),
        tooling,
        drive,
        demand,
    }
}

fn suppression(language: Language, clamp: Clamp) -> &'static str {
    match clamp {
        Clamp::Zener => language.of("60 V zener", "60 V 稳压管"),
        Clamp::Diode => language.of("diode", "二极管"),
    }
}

fn demands(language: Language, recipe: &Recipe, parameters: &[Parameter]) -> String {
    let one = |parameter: &Parameter| {
        let limit = recipe.limits.of(*parameter);
        let name = language.parameter(parameter.name());
        match (limit.low, limit.high) {
            (None, None) => None,
            (Some(low), None) => Some(format!("{name} ≥ {}", figure(Some(low)))),
            (None, Some(high)) => Some(format!("{name} ≤ {}", figure(Some(high)))),
            (Some(low), Some(high)) => {
                let (low, high) = (figure(Some(low)), figure(Some(high)));
                Some(format!("{name} {low} … {high}"))
            }
        }
    };
    let all: Vec<String> = parameters.iter().filter_map(one).collect();
    all.join("; ")
}

fn remarks(language: Language, recipe: &Recipe) -> String {
    let DeviceRecipe::EmRelay(relay) = &recipe.device;
    let decision = &recipe.decision;
    let rule = match decision.rule {
        Rule::GuardBand => language.of(
            "Decision: limits are moved inwards by the expanded uncertainty U (k = 2)",
            "判定规则：限值按扩展不确定度 U（k = 2）向内收缩",
        ),
        Rule::Simple => language.of("Decision: bare value", "判定规则：直接比较测得值"),
    };
    let repeats = language.of("slow repetitions near a limit", "近限值复测次数");
    let conditioning = language.of("operations before the test", "测前预动作次数");
    let recipe_text = language.of("recipe SHA-256", "工艺文件 SHA-256");
    format!(
        "{rule}; {repeats} {}; {conditioning} {}; {recipe_text} {}",
        decision.slow_repeats,
        relay.test.conditioning_operations,
        recipe.hash.get(..16).unwrap_or(&recipe.hash)
    )
}

fn signatures(language: Language) -> Markup {
    let of = |en, zh| language.of(en, zh);
    let change = [
        of("Mark", "标记"),
        of("Places", "处数"),
        of("Change note no.", "更改文件号"),
        of("Signature", "签字"),
        of("Date", "日期"),
    ];
    html! {
        table.card.sign {
            tr {
                @for name in change { th { (name) } }
                th { (of("Drawn up (date)", "编制(日期)")) }
                th { (of("Checked (date)", "审核(日期)")) }
                th { (of("Countersigned (date)", "会签(日期)")) }
            }
            tr.blank { @for _ in 0..8 { td {} } }
            tr.blank { @for _ in 0..8 { td {} } }
        }
    }
}
