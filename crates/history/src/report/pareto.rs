//! Draws a Pareto of reasons or alarms, and lists rejects.

use super::plot::{GRID, LINE, QUIET};
use super::svg::Svg;
use super::words::{figure, percent, reason, span};
use crate::Part;
use crate::inquiry::pareto::{Ranked, Rejects};
use maud::{Markup, PreEscaped, html};
use texts::{Lang, Message};

/// Largest number of bars; a note below them counts the other entries.
const BARS: usize = 12;
/// Height of a bar with its gap, px. Bars lie between [`LEFT`] and [`RIGHT`], their figures between [`RIGHT`] and
/// [`WIDTH`].
const ROW: f64 = 20.0;
const LEFT: f64 = 330.0;
const RIGHT: f64 = 560.0;
const WIDTH: f64 = 760.0;
/// Longest name, in columns: an ASCII character takes one, any other two.
const NAME: usize = 54;

/// Returns a figure with a bar for each entry, its count, its share of `parts` if given, and the cumulative share;
/// empty when there are no entries.
pub(super) fn pareto(
    language: Lang,
    title: &str,
    entries: &[Ranked],
    parts: Option<u64>,
) -> Markup {
    let rest = entries.len() - entries.len().min(BARS);
    html! {
        @if !entries.is_empty() {
            figure.wide.pareto {
                figcaption { (title) }
                (PreEscaped(bars(language, &entries[..entries.len() - rest], parts)))
                @if rest > 0 { p.note { (Message::new("paper", "more_kinds").with("count", rest).say(language)) } }
            }
        }
    }
}

fn bars(language: Lang, entries: &[Ranked], parts: Option<u64>) -> String {
    let most = entries.first().map_or(1, |it| it.n.max(1)) as f64;
    let mut svg = Svg::new([WIDTH, ROW * entries.len() as f64 + 4.0]);
    for (at, it) in entries.iter().enumerate() {
        let top = 2.0 + ROW * at as f64;
        let text = top + 14.0;
        let name = match language {
            Lang::En => &it.en,
            Lang::Zh => &it.zh,
        };
        svg.text([LEFT - 6.0, text], "text-anchor=\"end\"", &cut(name));
        svg.rect([LEFT, top + 2.0], [RIGHT - LEFT, ROW - 4.0], GRID);
        let wide = (RIGHT - LEFT) * it.n as f64 / most;
        svg.rect([LEFT, top + 2.0], [wide, ROW - 4.0], LINE);
        let beside = match (parts, it.active_s) {
            (Some(parts), _) => format!("{} · {}", it.n, percent(it.n, parts)),
            (None, Some(active)) => format!("{} · {}", it.n, span(active)),
            (None, None) => it.n.to_string(),
        };
        svg.text([RIGHT + 8.0, text], "", &beside);
        let style = format!("text-anchor=\"end\" fill=\"{QUIET}\"");
        let running = format!("Σ {:.0} %", 100.0 * it.cumulative);
        svg.text([WIDTH - 4.0, text], &style, &running);
    }
    svg.inline()
}

/// Shortens a name that would run into the bars.
fn cut(name: &str) -> String {
    let mut columns = 0;
    let kept = name.chars().take_while(|it| {
        columns += if it.is_ascii() { 1 } else { 2 };
        columns <= NAME
    });
    let kept: String = kept.collect();
    match kept.len() < name.len() {
        true => format!("{kept}…"),
        false => kept,
    }
}

/// Returns the list of rejects, each with its reasons and the values that they are about.
pub(super) fn rejects(language: Lang, it: &Rejects) -> Markup {
    let say = |id| language.text(id);
    let more = it.rejects - it.first.len() as u64;
    html! {
        @if it.first.is_empty() {
            p { (say("paper-none")) }
        } @else {
            table {
                thead { tr {
                    th.n { (say("paper-runs_part")) } th { (say("paper-serial_number")) }
                    th { (say("paper-verdict")) } th { (say("paper-bin")) } th { (say("column-reasons")) }
                } }
                tbody { @for part in &it.first { tr {
                    td.n { (part.run) " / " (part.seq) }
                    td.text { (part.serial.as_deref().unwrap_or("–")) }
                    td { span class=(part.verdict) { (language.name("paper_verdict", &part.verdict)) } }
                    td { (part.bin.as_deref().map_or("–", |bin| language.name("bin", bin))) }
                    td.text { (reasons(language, part)) }
                } } }
            }
            @if more > 0 { p.note { (Message::new("paper", "more_rejects").with("count", more).say(language)) } }
        }
    }
}

fn reasons(language: Lang, part: &Part) -> Markup {
    let value = |key: &str| part.values.get(key).and_then(serde_json::Value::as_f64);
    html! {
        @for (at, it) in part.reason_codes.iter().enumerate() {
            @if at > 0 { br; }
            (reason(language, it))
            @if let Some(value) = it.characteristic().and_then(|of| value(of.key())) { (language.colon()) (figure(Some(value))) }
        }
    }
}
