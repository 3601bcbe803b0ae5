//! The certificate of one part: every result with its uncertainty and limits, what they rest on, and the
//! line that says what was not tested.

use super::Paper;
use super::lot::{limits, source};
use super::page::{Format, facts, head, page, sign_off};
use super::words::{Language, figure};
use crate::{LotSummary, Measurement, Part};
use maud::{Markup, html};
use quality::Limits;

/// The certificate of `part`, which must carry its measurements, of the run `run`.
pub fn certificate(paper: &Paper, part: &Part, run: &LotSummary) -> String {
    let language = paper.language;
    let title = language.of("Test certificate", "检验合格证明书");
    let title = match part.verdict.as_str() {
        "pass" => title,
        _ => language.of("Test record", "检验记录"),
    };
    let number = format!("{}-{}-{:06}", part.lot, part.run, part.seq);
    let body = html! {
        (head(title, &format!("{} {number}", language.of("No.", "编号"))))
        (facts(&about(paper, part, run)))
        div class={ "verdict " (part.verdict) } { (language.verdict(&part.verdict)) }
        @for reason in &part.reason_codes { p { (language.reason(reason)) } }
        (results(language, part))
        p.note { (language.of(
            "U: expanded uncertainty, k = 2. Resistances and thresholds at the reference temperature of the recipe. \
             A value is proven when it lies inside its limit by at least U, unless the recipe says otherwise.",
            "U 为扩展不确定度（k = 2）。电阻与动作/释放电压已换算至工艺规定的基准温度。除工艺另有规定外，测得值在限值之内且余量不小于 U 方判合格。"
        )) }
        p.remark { (language.not_tested()) }
        (sign_off(language))
    };
    page(
        language,
        Format::Portrait,
        &format!("{title} {number}"),
        &paper.made,
        &body,
    )
}

fn about(paper: &Paper, part: &Part, run: &LotSummary) -> Vec<(&'static str, String)> {
    let language = paper.language;
    let of = |en: &'static str, zh: &'static str| language.of(en, zh);
    let none = || "–".to_owned();
    let short = |hash: &str| hash.get(..16).unwrap_or(hash).to_owned();
    vec![
        (
            of("Lot / run", "批次 / 运行"),
            format!("{} / {}", part.lot, part.run),
        ),
        (of("Part", "件号"), part.seq.to_string()),
        (
            of("Serial number", "序列号"),
            part.serial.clone().unwrap_or_else(none),
        ),
        (of("Tested", "检验时间"), paper.time(part.time)),
        (of("Recipe", "工艺文件"), part.recipe.clone()),
        (
            of("Recipe SHA-256", "工艺 SHA-256"),
            short(&run.recipe_hash),
        ),
        (
            of("Measured on", "数据来源"),
            source(language, &run.source).to_owned(),
        ),
        (
            of("Calibration SHA-256", "校准 SHA-256"),
            run.calibration_hash.as_deref().map_or_else(none, short),
        ),
        (
            of("Bin", "料箱"),
            part.bin
                .as_deref()
                .map_or_else(none, |bin| language.bin(bin).to_owned()),
        ),
        (
            of("Seen in bin", "落箱确认"),
            part.landed_bin
                .as_deref()
                .map_or_else(none, |bin| language.bin(bin).to_owned()),
        ),
    ]
}

fn results(language: Language, part: &Part) -> Markup {
    let of = |en, zh| language.of(en, zh);
    html! {
        table {
            thead { tr {
                th { (of("Parameter", "参数")) } th.n { (of("Attempt", "次数")) }
                th.n { (of("Value", "测得值")) } th.n { "U" }
                th.n { (of("Limits", "限值")) } th { (of("Verdict", "判定")) }
            } }
            tbody { @for it in last_attempts(&part.measurements) {
                tr {
                    td { (language.parameter(&it.parameter)) } td.n { (it.attempt) }
                    @let (value, doubt) = rounded(it.value, it.uncertainty);
                    td.n { (value) } td.n { (doubt) }
                    td.n { (limits(Limits { low: it.low, high: it.high })) }
                    td { span class=(it.verdict) { (language.verdict(&it.verdict)) } }
                }
            } }
        }
    }
}

/// The uncertainty to two significant digits, the value to the same place (GUM 7.2.6).
fn rounded(value: Option<f64>, uncertainty: Option<f64>) -> (String, String) {
    let Some(doubt) = uncertainty.filter(|it| it.is_finite() && *it > 0.0) else {
        return (figure(value), figure(uncertainty));
    };
    let decimals = (1.0 - doubt.log10().floor()).clamp(0.0, 9.0) as usize;
    let value = value.map_or_else(|| figure(None), |it| format!("{it:.decimals$}"));
    (value, format!("{doubt:.decimals$}"))
}

/// Attempts that were superseded are in the history, not on paper.
fn last_attempts(all: &[Measurement]) -> impl Iterator<Item = &Measurement> {
    let superseded = |it: &Measurement| {
        all.iter()
            .any(|other| other.parameter == it.parameter && other.attempt > it.attempt)
    };
    all.iter().filter(move |it| !superseded(it))
}
