//! Curves of a batch on paper: set point, reference thermometer and rate over time; marks show where a contact
//! switched.

use super::Paper;
use super::plot::{LIMIT, LINE, Plot, QUIET, ticked};
use crate::{Batch, BatchAir, BatchSocket};
use maud::{Markup, PreEscaped, html};
use quality::ordered::round_step;
use texts::Message;

/// Width and heights of the drawings of temperature and rate, px.
const WIDE: f64 = 720.0;
const TEMPERATURE: f64 = 210.0;
const RATE: f64 = 90.0;
/// Distance of a mark from the curve, and its length, px.
const MARK: [f64; 2] = [3.0, 9.0];

/// Returns the section of a lot report with the curves of all batches.
pub(super) fn all(paper: &Paper, batches: &[Batch]) -> Markup {
    let language = paper.language;
    html! {
        h2 { (language.text("paper-batches")) }
        @for it in batches { (figure(paper, it, &it.switched.iter().collect::<Vec<_>>())) }
        p.note { (language.text("paper-batch_note")) }
    }
}

/// Returns the section of a certificate: the batch of the part, with a mark where its own contact switched.
pub(super) fn of_part(paper: &Paper, batch: &Batch, seq: u64) -> Markup {
    let language = paper.language;
    let own: Vec<&BatchSocket> = (batch.switched.iter())
        .filter(|it| it.seq == Some(seq))
        .collect();
    html! {
        h2 { (language.text("paper-batch")) }
        (figure(paper, batch, &own))
        p.note { (language.text("paper-batch_note")) }
    }
}

/// Draws a batch, with a mark where a contact in one of these sockets switched.
fn figure(paper: &Paper, batch: &Batch, sockets: &[&BatchSocket]) -> Markup {
    let about = Message::new("paper", "batch_of")
        .with("batch", batch.number.to_string())
        .with("run", batch.run.to_string())
        .with("begin", paper.time(batch.begin));
    html! {
        figure style="break-inside:avoid" {
            figcaption { (about.say(paper.language)) }
            (PreEscaped(temperature(&batch.curve, sockets)))
            (PreEscaped(rate(&batch.curve)))
        }
    }
}

/// Draws set point (grey) and reference, with a mark above the curve where a contact opened, below where it closed.
fn temperature(air: &BatchAir, sockets: &[&BatchSocket]) -> String {
    let mut plot = opened(air, TEMPERATURE, &[&air.set_c, &air.reference_c]);
    line(&mut plot, air, &air.set_c, QUIET);
    line(&mut plot, air, &air.reference_c, LINE);
    for it in sockets {
        mark(&mut plot, air, &it.opened_s, -1.0);
        mark(&mut plot, air, &it.closed_s, 1.0);
    }
    named(plot, air, "°C")
}

fn rate(air: &BatchAir) -> String {
    let mut plot = opened(air, RATE, &[&air.rate_k_per_min]);
    line(&mut plot, air, &air.rate_k_per_min, LINE);
    named(plot, air, "K/min")
}

/// Makes an empty plot over time in minutes whose y axis covers these values.
fn opened(air: &BatchAir, high: f64, all: &[&[Option<f64>]]) -> Plot {
    let values = all.iter().flat_map(|it| it.iter().flatten());
    let [low, top] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, top], it| {
        [low.min(*it), top.max(*it)]
    });
    let range = if low <= top { [low, top] } else { [0.0, 1.0] };
    let end_min = air.t_s.last().copied().unwrap_or(60.0) / 60.0;
    Plot::new([WIDE, high], [0.0, end_min], range)
}

/// Writes round minutes below a plot and the unit of y at its top right.
fn named(mut plot: Plot, air: &BatchAir, unit: &str) -> String {
    let end_min = air.t_s.last().copied().unwrap_or(60.0) / 60.0;
    let step = round_step(end_min / 8.0).unwrap_or(10.0);
    for tick in 0..=(end_min / step).floor() as u32 {
        let at = f64::from(tick) * step;
        plot.under(at, &format!("{} min", ticked(at, step)));
    }
    plot.svg.text([WIDE - 56.0, 20.0], "", unit);
    plot.finish()
}

/// Draws values over time; a missing value breaks the line.
fn line(plot: &mut Plot, air: &BatchAir, values: &[Option<f64>], colour: &str) {
    let minutes = air.t_s.iter().map(|it| it / 60.0);
    plot.path(minutes.zip(values.iter().copied()), colour);
}

/// Draws a mark for each time: above the curve of the reference when `side` is −1, below when it is 1.
fn mark(plot: &mut Plot, air: &BatchAir, times_s: &[f64], side: f64) {
    for t_s in times_s {
        let Some(celsius) = reference_at(air, *t_s) else {
            continue;
        };
        let (x, y) = (plot.at_x(t_s / 60.0), plot.at_y(celsius) + side * MARK[0]);
        let style = format!("stroke=\"{LIMIT}\"");
        plot.svg.line([x, y], [x, y + side * MARK[1]], &style);
    }
}

/// Returns the last reading of the reference up to a time, C.
fn reference_at(air: &BatchAir, t_s: f64) -> Option<f64> {
    let after = air.t_s.partition_point(|it| *it <= t_s);
    *air.reference_c.get(after.checked_sub(1)?)?
}
