//! Printable comparison of lots: figures, tests of equality, histograms over one another.

use super::Paper;
use super::page::{Format, head, page};
use super::plot::{LIMIT, Plot, ticked};
use super::words::{figure, parameter};
use crate::inquiry::comparison::{ComparedLot, Comparison};
use maud::{Markup, PreEscaped, html};
use quality::equality::Equality;
use quality::ordered::round_step;
use texts::Lang;

/// Colour and dashes of each lot's outline; the dashes differ, so that a grey print shows which is which.
const OUTLINES: [(&str, &str); 8] = [
    ("#1f5f99", "none"),
    ("#c05a00", "6 3"),
    ("#14652f", "2 2"),
    ("#7a3b8f", "8 3 2 3"),
    ("#444444", "12 3"),
    ("#a11212", "1 4"),
    ("#008b8b", "12 3 2 3 2 3"),
    ("#7a5600", "4 8"),
];

/// Probability below which lots count as different.
const DIFFERENT: f64 = 0.05;

/// Returns the comparison as a page of HTML for A4.
pub fn comparison(paper: &Paper, it: &Comparison) -> String {
    let language = paper.language;
    let title = language.text("paper-comparison");
    let body = html! {
        (head(title, &parameter(language, &it.param)))
        @if let Some(svg) = overlay(it) {
            figure.wide {
                figcaption { (language.text("paper-share_of_lot")) }
                (PreEscaped(svg))
            }
        }
        (figures(language, &it.lots))
        h2 { (language.text("paper-test")) }
        (tests(language, it))
        p.note { (language.text("paper-comparison_note")) }
    };
    page(paper, Format::Landscape, title, &body)
}

fn figures(language: Lang, lots: &[ComparedLot]) -> Markup {
    let say = |id| language.text(id);
    html! {
        table.compared {
            thead { tr {
                th { (say("paper-lot")) } th.n { "n" } th.n { (say("paper-mean")) } th.n { (say("paper-sd")) }
                th.n { (say("paper-min")) } th.n { (say("paper-median")) } th.n { (say("paper-max")) }
                th.n { (say("paper-limits")) } th.n { "Cpk" } th.n { "Ppk" }
            } }
            tbody { @for (it, (colour, dashes)) in lots.iter().zip(OUTLINES) { tr {
                @let summary = &it.summary;
                td.text { (PreEscaped(key(colour, dashes))) " " (it.lot) } td.n { (summary.n) }
                @for value in [summary.mean, summary.sd, summary.min, summary.median, summary.max] {
                    td.n { (figure(value)) }
                }
                td.n { (super::lot::limits(it.limits)) }
                @for index in [summary.cpk, summary.ppk] {
                    td.n { (index.map_or("–".to_owned(), |it| format!("{it:.2}"))) }
                }
            } } }
        }
    }
}

fn tests(language: Lang, it: &Comparison) -> Markup {
    let say = |id| language.text(id);
    let finding = |it: &Equality| match it.p < DIFFERENT {
        true => say("paper-no"),
        false => say("paper-yes"),
    };
    let rows = [
        ("paper-equal_means", it.means),
        ("paper-equal_spreads", it.spreads),
    ];
    html! {
        table.compared {
            thead { tr {
                th { (say("paper-test")) } th.n { "F" } th.n { "df" } th.n { "p" } th { (say("paper-finding")) }
            } }
            tbody { @for (name, test) in rows { tr {
                td { (say(name)) }
                @if let Some(it) = test {
                    td.n { (figure(Some(it.f))) } td.n { (figure(Some(it.df1))) "; " (figure(Some(it.df2))) }
                    td.n { (probability(it.p)) } td { (finding(&it)) }
                } @else {
                    td.n { "–" } td.n { "–" } td.n { "–" } td { "–" }
                }
            } } }
        }
    }
}

fn probability(p: f64) -> String {
    match p < 0.0001 {
        true => "< 0.0001".to_owned(),
        false => format!("{p:.4}"),
    }
}

/// Draws the outline of each lot's histogram; `None` when all values are equal.
fn overlay(it: &Comparison) -> Option<String> {
    let (from, width) = (it.from?, it.width?);
    let classes = it.lots.first()?.shares.len();
    let end = from + width * classes as f64;
    let all = it.lots.iter().flat_map(|it| &it.shares);
    let highest = all.copied().fold(0.0, f64::max);
    let x = [from - width, end + width];
    let mut plot = Plot::new([1000.0, 300.0], x, [0.0, 112.0 * highest]);
    for (it, (colour, dashes)) in it.lots.iter().zip(OUTLINES) {
        let steps = (0..=classes).flat_map(|at| {
            let share = |at: Option<usize>| at.and_then(|at| it.shares.get(at)).unwrap_or(&0.0);
            let x = plot.at_x(from + width * at as f64);
            [share(at.checked_sub(1)), share(Some(at))].map(|y| (x, plot.at_y(100.0 * y)))
        });
        let path: Vec<String> = steps.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        plot.svg.add(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-dasharray=\"{dashes}\"/>",
            path.join(" ")
        ));
    }
    for (limit, name) in common_limits(&it.lots) {
        if (x[0]..x[1]).contains(&limit) {
            let name = format!("{name} {}", figure(Some(limit)));
            plot.vertical_line(limit, LIMIT, &name);
        }
    }
    let step = round_step((x[1] - x[0]) / 10.0)?;
    let mut tick = (x[0] / step).ceil();
    while tick * step <= x[1] {
        plot.under(tick * step, &ticked(tick * step, step));
        tick += 1.0;
    }
    Some(plot.finish())
}

/// Returns the limits that all lots share, with their signs.
fn common_limits(lots: &[ComparedLot]) -> Vec<(f64, &'static str)> {
    let Some(first) = lots.first().map(|it| it.limits) else {
        return Vec::new();
    };
    let mut shared = Vec::new();
    if lots.iter().all(|it| it.limits == first) {
        shared.extend(first.low.map(|at| (at, "≥")));
        shared.extend(first.high.map(|at| (at, "≤")));
    }
    shared
}

/// Draws the line of a lot beside its name.
fn key(colour: &str, dashes: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 36 8\" class=\"key\"><path d=\"M0 4H36\" \
         stroke=\"{colour}\" stroke-width=\"3\" stroke-dasharray=\"{dashes}\"/></svg>"
    )
}
