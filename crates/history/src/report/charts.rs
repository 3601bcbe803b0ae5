//! Draws control charts and histograms as SVG.

use super::plot::{LIMIT, LINE, Plot, QUIET, ticked};
use super::words::figure;
use quality::chart::Chart;
use quality::ordered::{Histogram, round_step};
use quality::{Limits, Ordered};

/// Width and height of a control chart, px: two charts with their legend fill an A4 sheet in landscape.
const WIDE: [f64; 2] = [1000.0, 200.0];

/// Draws the last `shown` points of a control chart with its limits. A point that violates a rule is red and shows the
/// number of the rule; every few points have their name below.
pub(super) fn control(chart: &Chart, shown: usize, names: &[String]) -> String {
    let first = chart.points.len().saturating_sub(shown);
    let points = &chart.points[first..];
    let all = points.iter().flat_map(|it| [it.value, it.low, it.high]);
    let (low, high) = all.fold((chart.centre, chart.centre), |(low, high), it| {
        (low.min(it), high.max(it))
    });
    let room = 0.08 * (high - low);
    let last = points.len().saturating_sub(1) as f64;
    let mut plot = Plot::new(WIDE, [-0.5, last + 0.5], [low - room, high + room]);
    limits(&mut plot, chart, first);
    let path: Vec<String> = points
        .iter()
        .enumerate()
        .map(|(at, it)| format!("{:.1},{:.1}", plot.at_x(at as f64), plot.at_y(it.value)))
        .collect();
    plot.svg.add(format_args!(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{LINE}\" stroke-width=\"1.1\"/>",
        path.join(" ")
    ));
    let radius = if points.len() > 80 { 1.4 } else { 2.4 };
    for (at, it) in points.iter().enumerate() {
        point(&mut plot, chart, first, at, it.value, radius);
    }
    named(&mut plot, points.len(), first, names);
    plot.finish()
}

fn limits(plot: &mut Plot, chart: &Chart, first: usize) {
    let points = &chart.points[first..];
    plot.across(chart.centre, QUIET, "none", &figure(Some(chart.centre)));
    let Some(start) = points.first() else { return };
    let level = points
        .iter()
        .all(|it| it.low == start.low && it.high == start.high);
    if level {
        plot.across(start.high, LIMIT, "5 3", &figure(Some(start.high)));
        plot.across(start.low, LIMIT, "5 3", &figure(Some(start.low)));
        return;
    }
    for (at, it) in points.iter().enumerate() {
        let (from, to) = (plot.at_x(at as f64 - 0.5), plot.at_x(at as f64 + 0.5));
        for limit in [it.low, it.high] {
            let y = plot.at_y(limit);
            let style = format!("stroke=\"{LIMIT}\"");
            plot.svg.line([from, y], [to, y], &style);
        }
    }
}

fn point(plot: &mut Plot, chart: &Chart, first: usize, at: usize, value: f64, radius: f64) {
    let (x, y) = (plot.at_x(at as f64), plot.at_y(value));
    let rules: Vec<String> = chart
        .signals
        .iter()
        .filter(|it| it.at == first + at)
        .map(|it| it.rule.to_string())
        .collect();
    if rules.is_empty() {
        let style = format!("fill=\"{LINE}\"");
        plot.svg.circle([x, y], radius, &style);
        return;
    }
    let style = format!("fill=\"{LIMIT}\"");
    plot.svg.circle([x, y], 3.6, &style);
    let style = format!("{style} text-anchor=\"middle\"");
    plot.svg.text([x, y - 6.0], &style, &rules.join(","));
}

/// Writes names below the plot, for as many points as there is room; points without names get numbers from 1.
fn named(plot: &mut Plot, shown: usize, first: usize, names: &[String]) {
    let longest = names
        .iter()
        .map(|it| it.chars().count())
        .max()
        .unwrap_or(4)
        .max(4);
    let every = shown.div_ceil((90 / longest).clamp(1, 12)).max(1);
    for at in (0..shown).step_by(every) {
        let number = (first + at + 1).to_string();
        let name = names.get(first + at).unwrap_or(&number);
        plot.under(at as f64, name);
    }
}

/// Draws counts as columns, and limits that lie near the values as vertical lines. Returns `None` when the values have
/// no spread.
pub(super) fn histogram(values: &Ordered, limits: Limits) -> Option<String> {
    let it = values.histogram(24)?;
    let end = it.from + it.width * it.counts.len() as f64;
    let highest = it.counts.iter().copied().max().unwrap_or(0) as f64;
    let near = 0.6 * (end - it.from);
    let seen = |limit: Option<f64>| limit.filter(|&at| at > it.from - near && at < end + near);
    let (low, high) = (seen(limits.low), seen(limits.high));
    let range = [
        low.map_or(it.from, |at| at.min(it.from)) - it.width,
        high.map_or(end, |at| at.max(end)) + it.width,
    ];
    let mut plot = Plot::new([380.0, 150.0], range, [0.0, highest * 1.12]);
    columns(&mut plot, &it);
    for (limit, name) in [(low, "≥ "), (high, "≤ ")] {
        if let Some(at) = limit {
            plot.vertical_line(at, LIMIT, &format!("{name}{}", figure(Some(at))));
        }
    }
    let step = round_step((range[1] - range[0]) / 5.0)?;
    let mut tick = (range[0] / step).ceil();
    while tick * step <= range[1] {
        plot.under(tick * step, &ticked(tick * step, step));
        tick += 1.0;
    }
    Some(plot.finish())
}

fn columns(plot: &mut Plot, it: &Histogram) {
    let bottom = plot.at_y(0.0);
    for (at, &count) in it.counts.iter().enumerate().filter(|(_, n)| **n > 0) {
        let from = plot.at_x(it.from + at as f64 * it.width);
        let to = plot.at_x(it.from + (at + 1) as f64 * it.width);
        let top = plot.at_y(count as f64);
        let size = [to - from - 0.8, bottom - top];
        plot.svg.rect([from + 0.4, top], size, LINE);
    }
}

/// Draws a share, 0 to 1, as a bar for a table cell.
pub(super) fn share(share: f64) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 6\" preserveAspectRatio=\"none\" \
         style=\"height:2.6mm\"><rect width=\"100\" height=\"6\" fill=\"#eef2f6\"/>\
         <rect width=\"{:.2}\" height=\"6\" fill=\"{LINE}\"/></svg>",
        100.0 * share.clamp(0.0, 1.0)
    )
}
