//! The operation process card of a recipe: what is done to a part, with what, by which figures, in which
//! time. The form is the customary one of machining (header, steps, tooling, parameters, time quota,
//! sign-off), its columns for spindle and feed replaced by drive, limits and decision.
//!
//! Steps, rating and drive come from the kind ([`Card`]), limits from the recipe, the plant's own figures from `card.toml`
//! ([`CardSettings`]).

use super::page::{Format, page};
use super::words::{Language, figure};
use machine::dut::card::{Card, CardSettings, Demand, Piece};
use machine::dut::{Characteristic, Recipe};
use machine::gauge::Rule;
use maud::{Markup, html};

/// The card as one page of HTML, A4 lengthwise.
pub fn card(language: Language, recipe: &Recipe, plant: &CardSettings, made: &str) -> String {
    let title = language.of("Operation process card", "检验工序卡");
    let kind = Card::of(recipe);
    let body = html! {
        (header(language, recipe, &kind, plant))
        (steps(language, recipe, &kind, plant))
        p.note { (remarks(language, recipe, &kind)) }
        p.remark { (language.not_tested()) }
        (signatures(language))
    };
    page(language, Format::Landscape, title, made, &body)
}

fn header(language: Language, recipe: &Recipe, kind: &Card, plant: &CardSettings) -> Markup {
    let of = |en, zh| language.of(en, zh);
    let ((rating, rated), quota) = (&kind.rating, total(plant));
    let body = recipe.body();
    let [x, y, z] = body.size_mm;
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
                th { (language.say(*rating)) } th { (of("Body x, y, z / mm", "外形尺寸 mm")) }
                th { (of("Pins / mm", "引脚长 mm")) } th { (of("Reference temp.", "基准温度")) }
            }
            tr {
                td { (plant.workshop) } td { (plant.operation_no) }
                td colspan="2" { (of("Performance test and sorting", "性能检测与分选")) }
                td { (joined(language, rated)) }
                td { (figure(Some(x))) " × " (figure(Some(y))) " × " (figure(Some(z))) }
                td { (figure(Some(body.pin_length_mm))) } td { (figure(Some(recipe.reference_temperature_c()))) " °C" }
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

fn steps(language: Language, recipe: &Recipe, kind: &Card, plant: &CardSettings) -> Markup {
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
                @for (number, step) in (1..).zip(&kind.steps) {
                    @let quota = plant.quota.get(step.name).copied().unwrap_or_default();
                    tr {
                        td { (number) } td.text { (language.say(step.what)) }
                        td.text { (language.say(step.tooling)) }
                        td.text { (joined(language, &step.drive)) }
                        td.text { (demanded(language, recipe, &step.demand)) }
                        td { (format!("{:.2}", quota.machine_s)) } td { (format!("{:.2}", quota.auxiliary_s)) }
                    }
                }
            }
        }
    }
}

fn joined(language: Language, pieces: &[Piece]) -> String {
    let one = |piece: &Piece| match piece {
        Piece::Figure(value) => figure(Some(*value)),
        Piece::Text(words) => language.say(*words).to_owned(),
    };
    pieces.iter().map(one).collect()
}

fn demanded(language: Language, recipe: &Recipe, demand: &Demand) -> String {
    match demand {
        Demand::Seen(words) => language.say(*words).to_owned(),
        Demand::Within(characteristics) => demands(language, recipe, characteristics),
    }
}

fn demands(language: Language, recipe: &Recipe, characteristics: &[Characteristic]) -> String {
    let one = |characteristic: &Characteristic| {
        let limit = recipe.limits.of(*characteristic);
        let name = language.parameter(characteristic.key());
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
    let all: Vec<String> = characteristics.iter().filter_map(one).collect();
    all.join("; ")
}

fn remarks(language: Language, recipe: &Recipe, kind: &Card) -> String {
    let decision = &recipe.decision;
    let rule = match decision.rule {
        Rule::GuardBand => language.of(
            "Decision: limits are moved inwards by the expanded uncertainty U (k = 2)",
            "判定规则：限值按扩展不确定度 U（k = 2）向内收缩",
        ),
        Rule::Simple => language.of("Decision: bare value", "判定规则：直接比较测得值"),
    };
    let repeats = language.of("slow repetitions near a limit", "近限值复测次数");
    let counts = kind.counts.iter();
    let counts: String = counts
        .map(|(words, count)| format!("; {} {count}", language.say(*words)))
        .collect();
    let recipe_text = language.of("recipe SHA-256", "工艺文件 SHA-256");
    format!(
        "{rule}; {repeats} {}{counts}; {recipe_text} {}",
        decision.slow_repeats,
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
