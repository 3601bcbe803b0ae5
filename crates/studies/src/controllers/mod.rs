//! `relayrig study chamber`: compares controllers of a test chamber on the simulated chamber.
//!
//! Every controller gets the figures of the same identification run on the nominal chamber. An error is the temperature
//! at the control sensor, without noise, minus the set point that the feedback follows: with feed-forward, the set
//! point of one delay ago. Each ramp goes from 40 to 100 C. The default controller also runs on randomly drawn
//! chambers, each identified first.
//!
//! | column | trial |
//! |---|---|
//! | value, `at_1`, `at_2` | largest error at 5, 1 and 2 K/min, K |
//! | `over_1`, `over_2`, `over_5` | excess over the end of the ramp, K |
//! | `settled_s` | time from the end of the ramp at 5 K/min until the error stays within 0.2 K |
//! | `weak`, `weak_over` | error and excess with half of the heater power, at 5 K/min, K |
//! | `strong_sd` | standard deviation of a hold with one and a half times the heater power, K |
//! | `seed` | drawn chamber of the value |
//! | `door_s`, `door_over` | recovery to 0.5 K after 20 s of open door, and excess, K; on a rig the door ends the batch |

pub mod contender;
pub mod plant;
#[cfg(test)]
mod tests;
mod trial;

use super::chart::Chart;
use super::curves::Curves;
use super::figure::{Bar, Figure};
use super::output::Report;
use super::pool::{self, LOTS_AT_ONCE};
use chamber::tune::Identified;
use contender::{CONTENDERS, Contender, DEFAULT};
use plant::{Medium, Plant, drawn};
use quality::Ordered;
use trial::{Tracked, Trial};

/// Rates of the ramps, K/min, with the bars of the default controller: largest error and largest excess, K.
const RATES: [(f64, f64, f64); 3] = [(1.0, 0.10, 0.06), (2.0, 0.15, 0.12), (5.0, 0.30, 0.25)];
/// Greatest slope over a minute that a referee standard allows, K/min.
const REFEREE_BAR: f64 = 0.556;
/// Number of randomly drawn chambers.
const CHAMBERS: u64 = 20;
/// Share of the heater power in the trials with a weak heater.
const WEAK: f64 = 0.5;
/// Share of the heater power in the trials with a strong heater.
const STRONG: f64 = 1.5;

/// Trials of one controller in the air chamber.
struct Row {
    contender: Contender,
    tracked: [Tracked; 3],
    weak: Tracked,
    strong_sd_k: f64,
    /// Recovery (s) and excess (K) after the open door.
    door: [f64; 2],
}

/// Compares the controllers; returns the report, and the errors along the ramp at 5 K/min as SVG.
///
/// # Errors
/// Fails when an identification run gives no figures.
pub fn study() -> anyhow::Result<(Report, String)> {
    let air = Plant::nominal(Medium::Air, 1).identify(Medium::Air)?;
    let rows = pool::map(&CONTENDERS, LOTS_AT_ONCE, |it| Ok(row(*it, &air)))?;
    let mut groups = vec![
        rows.iter().map(compared).collect(),
        learnt(&air),
        bars(&rows, &air),
        spread()?,
    ];
    for medium in [Medium::Oil, Medium::Block] {
        groups.push(other(medium)?);
    }
    let bars = rows
        .iter()
        .map(|it| (it.contender.name.to_owned(), Some(it.tracked[2].worst_k)));
    let chart = Chart::new("largest error at 5 K/min", "K", vec![RATES[2].1], bars);
    let about = format!("ramps from 40 to 100 C; {}", described(&air));
    Ok((Report::new("chamber", about, groups, chart), errors(&rows)))
}

/// Describes an identified chamber for the head of the report.
fn described(it: &Identified) -> String {
    format!(
        "identified: K {:.1} K, tau {:.1} s, delay {:.1} s, ki {:.3} K/s, loss {:.5} /K, fan {:.4}, vent {:.5} /K",
        it.gain_k,
        it.time_constant_s,
        it.delay_s,
        it.slope_k_per_s,
        it.loss_per_k,
        it.fan,
        it.vent_per_k
    )
}

/// Makes a trial on the nominal chamber of a medium, whose heater has the share `mains` of its power.
fn nominal(contender: Contender, medium: Medium, chamber: &Identified, mains: f64) -> Trial {
    let mut plant = Plant::nominal(medium, 1);
    plant.mains = mains;
    Trial::new(contender, plant, chamber)
}

fn row(contender: Contender, chamber: &Identified) -> Row {
    let trial = |mains| nominal(contender, Medium::Air, chamber, mains);
    let tracked = RATES.map(|(rate, _, _)| trial(1.0).track(rate));
    let mut opened = trial(1.0);
    opened.track(5.0);
    Row {
        contender,
        tracked,
        weak: trial(WEAK).track(5.0),
        strong_sd_k: trial(STRONG).track(5.0).hold_sd_k,
        door: opened.door(),
    }
}

fn compared(row: &Row) -> Figure {
    let [one, two, five] = &row.tracked;
    let [recovery_s, excess_k] = row.door;
    Figure::new(row.contender.name, 1, Some(five.worst_k), "K")
        .with("at_1", Some(one.worst_k))
        .with("at_2", Some(two.worst_k))
        .with("over_1", Some(one.overshoot_k))
        .with("over_2", Some(two.overshoot_k))
        .with("over_5", Some(five.overshoot_k))
        .with("settled_s", Some(five.settled_s))
        .with("weak", Some(row.weak.worst_k))
        .with("weak_over", Some(row.weak.overshoot_k))
        .with("strong_sd", Some(row.strong_sd_k))
        .with("door_s", Some(recovery_s))
        .with("door_over", Some(excess_k))
}

/// Returns the errors on the second ramp with a weak and a strong heater; on the first ramp the controller learns the
/// gain.
fn learnt(chamber: &Identified) -> Vec<Figure> {
    let one = |mains| {
        let mut trial = nominal(Contender::named(DEFAULT), Medium::Air, chamber, mains);
        trial.track(5.0);
        trial.back();
        let second = trial.track(5.0);
        let name = format!("gain x{mains} learnt, error at 5 K/min");
        Figure::new(name, 1, Some(second.worst_k), "K")
            .with("over_5", Some(second.overshoot_k))
            .bar(Bar::AtMost(RATES[2].1))
    };
    [WEAK, STRONG].map(one).into()
}

/// Returns the figures of the default controller, each with its bar.
///
/// # Errors
/// Fails when the identification run gives no figures.
pub fn default_figures() -> anyhow::Result<Vec<Figure>> {
    let air = Plant::nominal(Medium::Air, 1).identify(Medium::Air)?;
    Ok(bars(&[row(Contender::named(DEFAULT), &air)], &air))
}

/// Returns the figures of the default controller on the nominal chamber, each with its bar.
fn bars(rows: &[Row], chamber: &Identified) -> Vec<Figure> {
    let mut figures = Vec::new();
    for row in rows.iter().filter(|row| row.contender.name == DEFAULT) {
        for ((rate, error_k, over_k), tracked) in RATES.iter().zip(&row.tracked) {
            let figure = |what: &str, value| {
                Figure::new(format!("{what} at {rate} K/min"), 1, Some(value), "K")
            };
            figures.push(figure("error", tracked.worst_k).bar(Bar::AtMost(*error_k)));
            figures.push(figure("excess", tracked.overshoot_k).bar(Bar::AtMost(*over_k)));
        }
    }
    let slope = |mains| nominal(Contender::named(DEFAULT), Medium::Air, chamber, mains).referee();
    let name = "steepest minute of a referee ramp";
    let steepest = Figure::new(name, 1, Some(slope(1.0)), "K/min").bar(Bar::AtMost(REFEREE_BAR));
    let strong = Figure::new(
        format!("{name}, gain x{STRONG}"),
        1,
        Some(slope(STRONG)),
        "K/min",
    );
    figures.extend([steepest, strong]);
    figures
}

/// Returns the errors of the default controller on randomly drawn chambers, each identified first: greatest and median.
fn spread() -> anyhow::Result<Vec<Figure>> {
    let seeds: Vec<u64> = (1..=CHAMBERS).collect();
    let found = pool::map(&seeds, LOTS_AT_ONCE, |seed| {
        let (values, sensors) = drawn(Medium::Air, None, *seed);
        let plant = Plant::new(&values, sensors, values.ambient_c, *seed);
        let chamber = plant.clone().identify(Medium::Air)?;
        let trial = || Trial::new(Contender::named(DEFAULT), plant.clone(), &chamber);
        Ok((
            RATES.map(|(rate, _, _)| trial().track(rate)),
            trial().referee(),
        ))
    })?;
    let figure = |name: String, values: Vec<f64>, unit, bar| {
        let ordered = Ordered::of(&values);
        let worst = (1..).zip(&values).max_by(|a, b| a.1.total_cmp(b.1));
        Figure::new(
            format!("{name}, drawn chambers"),
            CHAMBERS,
            ordered.quantile(1.0),
            unit,
        )
        .with("median", ordered.quantile(0.5))
        .with("seed", worst.map(|(seed, _)| f64::from(seed)))
        .bar(Bar::AtMost(bar))
    };
    let mut figures = Vec::new();
    for (which, (rate, error_k, over_k)) in RATES.iter().enumerate() {
        let errors = found
            .iter()
            .map(|(tracked, _)| tracked[which].worst_k)
            .collect();
        let overs = found
            .iter()
            .map(|(tracked, _)| tracked[which].overshoot_k)
            .collect();
        figures.push(figure(
            format!("error at {rate} K/min"),
            errors,
            "K",
            *error_k,
        ));
        figures.push(figure(
            format!("excess at {rate} K/min"),
            overs,
            "K",
            *over_k,
        ));
    }
    let slopes = found.iter().map(|(_, slope)| *slope).collect();
    figures.push(figure(
        "steepest minute of a referee ramp".into(),
        slopes,
        "K/min",
        REFEREE_BAR,
    ));
    Ok(figures)
}

/// Compares the laws that fit any chamber, in another medium than air.
fn other(medium: Medium) -> anyhow::Result<Vec<Figure>> {
    let chamber = Plant::nominal(medium, 1).identify(medium)?;
    let fitting: Vec<Contender> = CONTENDERS
        .into_iter()
        .filter(|it| it.fits_any_chamber())
        .collect();
    pool::map(&fitting, LOTS_AT_ONCE, |contender| {
        let tracked =
            RATES.map(|(rate, _, _)| nominal(*contender, medium, &chamber, 1.0).track(rate));
        let [one, two, five] = &tracked;
        let figure = Figure::new(
            format!("{}, {}", medium.name(), contender.name),
            1,
            Some(five.worst_k),
            "K",
        )
        .with("at_1", Some(one.worst_k))
        .with("at_2", Some(two.worst_k))
        .with("over_1", Some(one.overshoot_k))
        .with("over_2", Some(two.overshoot_k))
        .with("over_5", Some(five.overshoot_k));
        let is_default = contender.name == DEFAULT;
        Ok(if is_default {
            figure.bar(Bar::AtMost(RATES[2].1))
        } else {
            figure
        })
    })
}

/// Draws the errors along the ramp at 5 K/min.
fn errors(rows: &[Row]) -> String {
    let shown = [
        "PID tc=th",
        "fuzzy furnace",
        "fuzzy-PID even",
        DEFAULT,
        "fuzzy furnace + FF",
    ];
    let curve = |row: &Row| {
        let moments = row.tracked[2].moments.iter().enumerate().step_by(5);
        let points = moments.map(|(second, it)| [second as f64 / 60.0, it.wanted_c - it.exact_c]);
        (row.contender.name.to_owned(), points.collect())
    };
    Curves {
        title: "Set point less temperature on a ramp from 40 to 100 C at 5 K/min".into(),
        x_title: "time, min".into(),
        y_title: "error, K".into(),
        series: rows
            .iter()
            .filter(|it| shown.contains(&it.contender.name))
            .map(curve)
            .collect(),
    }
    .svg()
}
