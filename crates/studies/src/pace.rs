//! Parts per second of wall time, and whether the same seed gives the same bytes.
//!
//! The study runs the same lot at least twice, one process at a time. The wall time is that of the whole process,
//! including start, calibration, reference parts and history.

use super::bins;
use super::chart::Chart;
use super::figure::{Bar, Figure, mean, share_pct};
use super::lot::Lot;
use super::order::Order;
use super::output::Report;
use machine::dut::recipe::DeviceRecipe;
use quality::Spread;
use quality::spread::median;
use std::collections::{BTreeMap, BTreeSet};

/// Least parts per second of wall time.
const PARTS_PER_SECOND: f64 = 150.0;
/// Least solid-state relays per second of wall time: fewer, because each has long records of the digitizer.
const WAVES_PER_SECOND: f64 = 30.0;
/// Seed of every run.
const SEED: u64 = 1;

/// Runs the lot several times and makes the report.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let order = &Order {
        lots: order.lots.max(2),
        ..order.clone()
    };
    let runs: Vec<u64> = (0..order.lots).map(|_| SEED).collect();
    let lots = order.run(&runs, 1)?;
    let rates = rates(&lots);
    let least = match &order.recipe.device {
        DeviceRecipe::Ssr(_) => WAVES_PER_SECOND,
        DeviceRecipe::EmRelay(_) | DeviceRecipe::Resistor(_) | DeviceRecipe::Thermostat(_) => {
            PARTS_PER_SECOND
        }
    };
    let about = order.about();
    let title = format!("parts per second of wall time, run by run: {about}");
    let run = |(run, rate): (u64, &f64)| (format!("run {run}"), Some(*rate));
    let bars = (1..).zip(&rates).map(run);
    let chart = Chart::new(title, "/s", vec![least], bars);
    let groups = vec![
        vec![rate(&rates, least), same_bytes(&lots)],
        profile(&lots),
        bins::machine(&lots),
    ];
    Ok(Report::new("pace", about, groups, chart))
}

fn rates(lots: &[Lot]) -> Vec<f64> {
    lots.iter()
        .map(|lot| lot.parts.len() as f64 / lot.wall_s)
        .collect()
}

fn rate(rates: &[f64], least: f64) -> Figure {
    let spread = Spread::of(rates);
    Figure::new(
        "parts per second, median of runs",
        spread.n(),
        median(rates),
        "/s",
    )
    .with("slowest", spread.min())
    .with("fastest", spread.max())
    .bar(Bar::AtLeast(least))
}

/// Counts the runs whose bytes on the lines differ from those of the previous run. The figure has no value when a run
/// reports no bytes, or when there is only one run.
pub fn same_bytes(lots: &[Lot]) -> Figure {
    let have_bytes = lots.iter().all(|lot| !lot.summary.bytes.is_empty());
    let differ = lots
        .iter()
        .zip(lots.iter().skip(1))
        .filter(|(a, b)| a.summary.bytes != b.summary.bytes)
        .count();
    let count = (have_bytes && lots.len() > 1).then_some(differ as u64);
    Figure::count(
        "repeats of a seed with other bytes",
        lots.len() as u64,
        count,
    )
    .bar(Bar::AtMost(0.0))
}

/// Returns the mean wall time of each activity over the lots, seconds, greatest first; empty when no lot has a profile.
pub fn profile(lots: &[Lot]) -> Vec<Figure> {
    let profiles = || lots.iter().map(|lot| &lot.summary.wall_profile);
    let names: BTreeSet<&String> = profiles().flat_map(BTreeMap::keys).collect();
    let wall = mean(lots.iter().map(|lot| lot.wall_s));
    let row = |name: &String| {
        let seconds = mean(profiles().map(|it| it.get(name).copied().unwrap_or(0.0)));
        Figure::new(format!("wall: {name}"), lots.len() as u64, seconds, "s")
            .with("share_pct", share_pct(seconds, wall))
    };
    let mut rows: Vec<Figure> = names.into_iter().map(row).collect();
    rows.sort_by(|a, b| b.value.unwrap_or(0.0).total_cmp(&a.value.unwrap_or(0.0)));
    rows
}
