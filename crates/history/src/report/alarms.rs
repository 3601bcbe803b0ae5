//! Printable list of alarms with state (ISA-18.2), acknowledgement and shelving.

use super::page::{Format, head, page};
use super::words::span;
use super::{Paper, pareto};
use crate::{Alarm, AlarmState, inquiry};
use maud::{Markup, html};
use texts::Lang;

/// Returns the page; `about` is its subtitle.
pub fn list(paper: &Paper, about: &str, alarms: &[Alarm]) -> String {
    let language = paper.language;
    let title = language.text("paper-alarm_list");
    let body = html! { (head(title, about)) (ranked(language, alarms)) (table(paper, alarms)) };
    page(paper, Format::Portrait, title, &body)
}

/// Returns the alarms by code, with their counts and the time for which they were active.
pub(super) fn ranked(language: Lang, alarms: &[Alarm]) -> Markup {
    let title = language.text("paper-alarms_ranked");
    pareto::pareto(language, title, &inquiry::pareto::by_code(alarms), None)
}

pub(super) fn table(paper: &Paper, alarms: &[Alarm]) -> Markup {
    let language = paper.language;
    let say = |id| language.text(id);
    html! {
        @if alarms.is_empty() {
            p { (say("paper-none")) }
        } @else {
            table {
                thead { tr {
                    th { (say("paper-raised")) } th.n { (say("paper-duration")) }
                    th { (say("paper-state")) } th { (say("paper-lot")) }
                    th { (say("paper-code")) } th { (say("paper-message")) }
                } }
                tbody { @for it in alarms { tr {
                    td { (paper.time(it.raised)) }
                    td.n { @match it.cleared {
                        Some(at) => { (span((at.0 - it.raised.0) as f64 / 1e6)) }
                        None => { (say("paper-to_the_end")) }
                    } }
                    td.state { (state(paper, it)) }
                    td.text { (it.lot.as_deref().unwrap_or("–")) @if let Some(run) = it.run { " / " (run) } }
                    td { (it.code) }
                    td.text { (text(paper.language, it)) @if let Some(line) = &it.line { " (" (line) ")" } }
                } } }
            }
        }
    }
}

/// Returns the message in the language of the page; a Chinese page shows the Chinese cause and the English message when
/// arguments are missing.
fn text(language: Lang, alarm: &Alarm) -> Markup {
    html! {
        @match (language, &alarm.text_zh, alarm.cause_zh) {
            (Lang::Zh, Some(text), _) => { (text) }
            (Lang::Zh, None, Some(cause)) => { (cause) br; (alarm.text) }
            (Lang::Zh, None, None) | (Lang::En, _, _) => { (alarm.text) }
        }
    }
}

/// Returns state, acknowledgement and shelving as one cell.
fn state(paper: &Paper, alarm: &Alarm) -> Markup {
    let (say, comma) = (|id| paper.language.text(id), paper.language.comma());
    let name = match alarm.state {
        AlarmState::Unacknowledged => say("paper-unacknowledged"),
        AlarmState::Acknowledged => say("paper-acknowledged"),
        AlarmState::ReturnedUnacknowledged => say("paper-returned_unacknowledged"),
        AlarmState::Normal => say("paper-normal"),
    };
    html! {
        (name)
        @if let Some(at) = alarm.acknowledged {
            br; (say("paper-acknowledged_at")) " " (paper.time(at))
            @if let Some(by) = &alarm.acknowledged_by { (comma) (by) }
        }
        @if let Some(shelf) = &alarm.shelf {
            br; (say("paper-shelved_until")) " " (paper.time(shelf.until)) (comma) (shelf.by) (paper.language.colon()) (shelf.reason)
        }
    }
}
