//! Results from outside of the rig on paper, and whether the lot is acceptable by them.

use super::Paper;
use super::certificate::rounded;
use super::lot::limits;
use super::words::parameter;
use crate::{ExternalResult, ExternalStanding};
use maud::{Markup, html};
use quality::Limits;
use texts::{Lang, Message};

/// Returns a box that says whether the lot is acceptable; empty for a lot that has and needs no such results.
pub(super) fn standing(language: Lang, standing: Option<&ExternalStanding>) -> Markup {
    let Some(it) = standing else {
        return html! {};
    };
    let class = if it.acceptable { "pass" } else { "fail" };
    html! {
        div class={ "verdict " (class) } { (sentence(language, it)) }
    }
}

/// Returns the standing of a lot in one sentence.
pub fn sentence(language: Lang, it: &ExternalStanding) -> String {
    let id = if it.acceptable {
        "external_acceptable"
    } else {
        "external_not_acceptable"
    };
    let names = it.missing.iter().map(|key| parameter(language, key));
    let missing = match it.missing.is_empty() {
        true => "–".to_owned(),
        false => names.collect::<Vec<_>>().join(language.comma()),
    };
    Message::new("paper", id)
        .with("pass", it.pass)
        .with("fail", it.fail)
        .with("undecided", it.undecided)
        .with("missing", missing)
        .say(language)
}

/// Returns the table of these results; empty without any.
pub(super) fn table<'a>(
    paper: &Paper,
    results: impl IntoIterator<Item = &'a ExternalResult>,
) -> Markup {
    let say = |id| paper.language.text(id);
    let mut results = results.into_iter().peekable();
    if results.peek().is_none() {
        return html! {};
    }
    html! {
        h2 { (say("paper-external")) }
        table {
            thead { tr {
                th { (say("paper-sample")) } th { (say("paper-parameter")) }
                th.n { (say("paper-value")) } th.n { "U" } th.n { (say("paper-limits")) }
                th { (say("paper-verdict")) } th { (say("paper-measured_at")) } th { (say("paper-entered_by")) }
            } }
            tbody { @for it in results { (row(paper, it)) } }
        }
        p.note { (say("paper-external_note")) }
    }
}

fn row(paper: &Paper, it: &ExternalResult) -> Markup {
    let language = paper.language;
    let (value, doubt) = rounded(Some(it.value), it.uncertainty);
    let verdict = language.name("paper_verdict", it.verdict.name());
    html! { tr {
        td.text { (it.sample().unwrap_or_else(|| language.text("paper-lot").to_owned())) }
        td { (parameter(language, &it.key)) }
        td.n { (value) } td.n { (doubt) }
        td.n { (limits(Limits { low: it.low, high: it.high })) }
        td {
            @if it.superseded { s { (verdict) } " " (language.text("paper-superseded")) }
            @else { span class=(it.verdict.name()) { (verdict) } }
        }
        td { (paper.time(it.measured)) } td.text { (it.who) }
    } }
}

/// Returns the remark that says what the rig does not test.
pub(super) fn remark(language: Lang, has_results: bool) -> Markup {
    let id = if has_results {
        "paper-not_tested_by_rig"
    } else {
        "paper-not_tested"
    };
    html! { p.remark { (language.text(id)) } }
}
