//! The list of alarms, each with its state by ISA-18.2: seen by whom, shelved why.

use super::Paper;
use super::page::{Format, head, page};
use super::words::{Language, span};
use crate::{Alarm, AlarmState};
use maud::{Markup, html};

/// A page of alarms; `about` says of what.
pub fn list(paper: &Paper, about: &str, alarms: &[Alarm]) -> String {
    let language = paper.language;
    let title = language.of("Alarm list", "报警清单");
    let body = html! { (head(title, about)) (table(paper, alarms)) };
    page(language, Format::Portrait, title, &paper.made, &body)
}

pub(super) fn table(paper: &Paper, alarms: &[Alarm]) -> Markup {
    let language = paper.language;
    let of = |en, zh| language.of(en, zh);
    html! {
        @if alarms.is_empty() {
            p { (of("None.", "无。")) }
        } @else {
            table {
                thead { tr {
                    th { (of("Raised", "发生时间")) } th.n { (of("Stood", "持续")) }
                    th { (of("State", "状态")) } th { (of("Lot", "批次")) }
                    th { (of("Code", "代码")) } th { (of("Message", "内容")) }
                } }
                tbody { @for it in alarms { tr {
                    td { (paper.time(it.raised)) }
                    td.n { @match it.cleared {
                        Some(at) => { (span((at.0 - it.raised.0) as f64 / 1e6)) }
                        None => { (of("to the end", "至结束")) }
                    } }
                    td.state { (state(paper, it)) }
                    td.text { (it.lot.as_deref().unwrap_or("–")) @if let Some(run) = it.run { " / " (run) } }
                    td { (it.code) }
                    td.text { @if let (Language::Zh, Some(cause)) = (paper.language, it.cause_zh) { (cause) br; }
                        (it.text) @if let Some(line) = &it.line { " (" (line) ")" } }
                } } }
            }
        }
    }
}

/// The state by ISA-18.2, who acknowledged when, and how it was shelved.
fn state(paper: &Paper, alarm: &Alarm) -> Markup {
    let of = |en, zh| paper.language.of(en, zh);
    let name = match alarm.state {
        AlarmState::Unacknowledged => of("unacknowledged", "未确认"),
        AlarmState::Acknowledged => of("acknowledged", "已确认"),
        AlarmState::ReturnedUnacknowledged => of("returned, unacknowledged", "已恢复，未确认"),
        AlarmState::Normal => of("normal", "已恢复"),
    };
    html! {
        (name)
        @if let Some(at) = alarm.acknowledged {
            br; (of("seen", "确认")) " " (paper.time(at))
            @if let Some(by) = &alarm.acknowledged_by { ", " (by) }
        }
        @if let Some(shelf) = &alarm.shelf {
            br; (of("shelved until", "搁置至")) " " (paper.time(shelf.until)) ", " (shelf.by) ": " (shelf.reason)
        }
    }
}
