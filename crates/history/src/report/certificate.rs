//! Certificate of one part: results with uncertainty and limits, the calibration, and what was not tested.

use super::data_matrix::data_matrix;
use super::lot::{limits, source};
use super::page::{Format, facts, head, page, sign_off};
use super::words::{doubt_decimals, figure, parameter, short_hash};
use super::{Paper, batch, curves, external, words};
use crate::{Batch, ExternalResult, ExternalStanding, LotSummary, Measurement, Part};
use maud::{Markup, PreEscaped, html};
use quality::Limits;
use texts::Lang;

/// Returns the certificate of `part`, which must have its measurements; `run` is the run that tested the part,
/// `tested_in` its batch, if any. A part of a lot that is not acceptable by its results from outside of the rig gets a
/// record instead.
pub fn certificate(
    paper: &Paper,
    part: &Part,
    run: &LotSummary,
    tested_in: Option<&Batch>,
    (results_of_lot, standing): (&[ExternalResult], Option<&ExternalStanding>),
) -> String {
    let language = paper.language;
    let acceptable = standing.is_none_or(|it| it.acceptable);
    let title = match part.verdict.as_str() {
        "pass" if acceptable => language.text("paper-test_certificate"),
        _ => language.text("paper-test_record"),
    };
    let own = |it: &&ExternalResult| it.is_of_lot() || it.is_on(part);
    let number = format!("{}-{}-{:06}", part.lot, part.run, part.seq);
    let body = html! {
        (head(title, &format!("{} {number}", language.text("paper-number"))))
        (facts(&about(paper, part, run)))
        @if let Some(symbol) = part.serial.as_deref().and_then(data_matrix) {
            figure.symbol { (PreEscaped(symbol)) figcaption { (part.serial.as_deref().unwrap_or_default()) } }
        }
        div class={ "verdict " (part.verdict) } { (language.name("paper_verdict", &part.verdict)) }
        @for reason in &part.reason_codes { p { (words::reason(language, reason)) } }
        (results(language, part))
        p.note { (language.text("paper-uncertainty_note")) }
        (external::table(paper, results_of_lot.iter().filter(own)))
        (external::standing(language, standing))
        @if let Some(it) = tested_in { (batch::of_part(paper, it, part.seq)) }
        (curves::of_part(paper, part))
        (external::remark(language, !results_of_lot.is_empty()))
        (sign_off(language))
    };
    page(paper, Format::Portrait, &format!("{title} {number}"), &body)
}

fn about(paper: &Paper, part: &Part, run: &LotSummary) -> Vec<(&'static str, String)> {
    let language = paper.language;
    let say = |id| language.text(id);
    let none = || "–".to_owned();
    let bin = |bin: &Option<String>| {
        let name = |bin: &String| language.name("bin", bin).to_owned();
        bin.as_ref().map_or_else(none, name)
    };
    vec![
        (say("paper-lot_run"), format!("{} / {}", part.lot, part.run)),
        (say("paper-part"), part.seq.to_string()),
        (
            say("paper-serial_number"),
            part.serial.clone().unwrap_or_else(none),
        ),
        (say("paper-certificate_tested"), paper.time(part.time)),
        (say("paper-recipe"), part.recipe.clone()),
        (say("paper-recipe_sha_256"), short_hash(&run.recipe_hash)),
        (
            say("paper-measured_on"),
            source(language, &run.source).to_owned(),
        ),
        (
            say("paper-calibration_sha_256"),
            run.calibration_hash
                .as_deref()
                .map_or_else(none, short_hash),
        ),
        (say("paper-bin"), bin(&part.bin)),
        (say("paper-landed_bin"), bin(&part.landed_bin)),
    ]
}

fn results(language: Lang, part: &Part) -> Markup {
    let say = |id| language.text(id);
    html! {
        table {
            thead { tr {
                th { (say("paper-parameter")) } th.n { (say("paper-attempt")) }
                th.n { (say("paper-value")) } th.n { "U" }
                th.n { (say("paper-limits")) } th { (say("paper-verdict")) }
            } }
            tbody { @for it in last_attempts(&part.measurements) {
                tr {
                    td { (parameter(language, &it.parameter)) } td.n { (it.attempt) }
                    @let (value, doubt) = rounded(it.value, it.uncertainty);
                    td.n { (value) } td.n { (doubt) }
                    td.n { (limits(Limits { low: it.low, high: it.high })) }
                    td { span class=(it.verdict) { (language.name("paper_verdict", &it.verdict)) } }
                }
            } }
        }
    }
}

/// Rounds the uncertainty to two significant digits and the value to the same decimal place (GUM 7.2.6).
pub(super) fn rounded(value: Option<f64>, uncertainty: Option<f64>) -> (String, String) {
    let Some(doubt) = uncertainty.filter(|it| it.is_finite() && *it > 0.0) else {
        return (figure(value), figure(uncertainty));
    };
    let decimals = doubt_decimals(doubt);
    let value = value.map_or_else(|| figure(None), |it| format!("{it:.decimals$}"));
    (value, format!("{doubt:.decimals$}"))
}

/// Returns the last attempt of each parameter.
fn last_attempts(all: &[Measurement]) -> impl Iterator<Item = &Measurement> {
    let superseded = |it: &Measurement| {
        all.iter()
            .any(|other| other.parameter == it.parameter && other.attempt > it.attempt)
    };
    all.iter().filter(move |it| !superseded(it))
}
