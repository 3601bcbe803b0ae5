//! Printable control charts of a parameter, or of the share of a bin.

use super::Paper;
use super::charts;
use super::page::{Format, head, page};
use super::words::{figure, parameter};
use maud::{Markup, PreEscaped, html};
use quality::chart::Chart;
use quality::rules::Signal;
use texts::{Lang, Message};

/// A control chart with its title and the names of its points.
#[derive(Debug, Clone)]
pub struct NamedChart<'a> {
    /// Parameter key or name of a bin.
    pub of: &'a str,
    /// Points, limits and signals.
    pub chart: &'a Chart,
    /// Names of the points; when empty, the points are numbered from 1.
    pub names: &'a [String],
}

/// Returns a page with the last `shown` points of every chart.
pub fn spc(paper: &Paper, about: &str, charts: &[NamedChart<'_>], shown: usize) -> String {
    let language = paper.language;
    let heading = language.text("paper-control_charts");
    let body = html! {
        (head(heading, about))
        @for it in charts {
            figure.wide {
                figcaption { (title(language, it)) (cut(language, it.chart.points.len(), shown)) }
                (PreEscaped(charts::control(it.chart, shown, it.names)))
            }
        }
        (legend(language, charts))
    };
    page(paper, Format::Landscape, heading, &body)
}

/// Returns the title of a chart: parameter or bin, and kind of chart.
fn title(language: Lang, it: &NamedChart<'_>) -> String {
    let share = Message::new("paper", "bin_share").with("bin", it.of);
    let of = match it.chart.kind {
        "share" => share.say(language),
        _ => parameter(language, it.of),
    };
    format!("{of} – {}", kind(language, it.chart.kind))
}

/// Returns the remark that only the last `shown` points are drawn; empty when all points are drawn.
fn cut(language: Lang, points: usize, shown: usize) -> String {
    let cut = Message::new("paper", "last_points")
        .with("shown", shown)
        .with("points", points);
    match points > shown {
        true => cut.say(language),
        false => String::new(),
    }
}

/// Returns the name of a kind of chart.
fn kind(language: Lang, kind: &str) -> &str {
    match kind {
        "individuals" => language.text("paper-individuals"),
        "moving range" => language.text("paper-moving_range"),
        "means" => language.text("paper-means"),
        "ranges" => language.text("paper-ranges"),
        "share" => language.text("paper-shares"),
        other => other,
    }
}

fn legend(language: Lang, charts: &[NamedChart<'_>]) -> Markup {
    html! { div.together {
        table {
            thead { tr {
                th { (language.text("paper-chart")) } th.n { (language.text("paper-points")) }
                th.n { (language.text("paper-centre")) } th { (language.text("paper-signals")) }
            } }
            tbody { @for it in charts { tr {
                td { (title(language, it)) }
                td.n { (it.chart.points.len()) } td.n { (figure(Some(it.chart.centre))) }
                td.text { (signals(language, &it.chart.signals)) }
            } } }
        }
        p.note { (language.text("paper-chart_note")) }
    } }
}

fn signals(language: Lang, signals: &[Signal]) -> String {
    if signals.is_empty() {
        return language.text("paper-spc_none").to_owned();
    }
    let one = |rule: u8| {
        let count = signals.iter().filter(|it| it.rule == rule).count();
        let name = language.text("paper-rule");
        (count > 0).then(|| format!("{name} {rule}{}{count}", language.colon()))
    };
    (1..=8)
        .filter_map(one)
        .collect::<Vec<_>>()
        .join(language.comma())
}
