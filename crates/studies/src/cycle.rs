//! Rig time of a test and of a cycle, and the pieces of each.
//!
//! A cycle lasts from the nest exit of one part to that of the next. The cycle minus the test is mechanics; the time of
//! the test that no piece names is `rest`. The time of each piece is the mean over the parts that have both times, so
//! that the pieces add up to the mean cycle.

use super::bins;
use super::chart::Chart;
use super::exception;
use super::figure::{Bar, Figure, mean, percent, share_pct};
use super::lot::{Lot, Part};
use super::order::Order;
use super::output::Report;
use super::path;
use machine::dut::recipe::DeviceRecipe;
use machine::dut::ssr::recipe::Output;
use quality::Spread;
use quality::spread::median;

/// Greatest permitted time of the longest test of a good part, seconds of rig time.
const TEST_S: f64 = 0.85;
/// Greatest permitted time of the longest test of a good solid-state relay for a DC load, seconds of rig time. The time
/// excludes repetitions and what occurs only at the start of a lot: references, and searches without an expected value.
const DC_TEST_S: f64 = 1.0;
/// As [`DC_TEST_S`], for a solid-state relay for an AC load.
const AC_TEST_S: f64 = 1.5;
/// Number of parts from which the overshoot model ([`machine::dut::em_relay::overshoot`]) starts the fine ramps close
/// to the threshold. The model has six terms, and the reference parts lie far apart: after fewer parts its uncertainty
/// makes the ramps longer.
const LEARNING_PARTS: usize = 6;
/// Greatest permitted time of the longest test of any part, seconds of rig time: a defect may need another ramp.
const ANY_TEST_S: f64 = 1.0;
/// Greatest permitted mean test time, seconds of rig time.
const MEAN_S: f64 = 0.70;
/// Greatest permitted mean test time under a recipe that measures adaptively, seconds of rig time.
const ADAPTIVE_MEAN_S: f64 = 0.50;
/// Greatest permitted ratio of the mean test time to the lower bound of [`bound`].
const RATIO: f64 = 1.15;
/// Greatest permitted cycle with overlapping motions, seconds of rig time.
const CYCLE_S: f64 = 2.5;
/// Pieces of a test: key in the rows and name in the report.
const PIECES: [(&str, &str); 4] = [
    ("bus_s", "bus"),
    ("settling_s", "settling"),
    ("conversion_s", "conversion"),
    ("ramp_s", "ramps"),
];

/// Runs the lots and makes the report.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let lots = order.run_all()?;
    let adaptive = order.recipe.name.ends_with("-adaptive");
    let (test_s, mean_s) = allowed_s(order);
    let mean_bar = if adaptive { ADAPTIVE_MEAN_S } else { mean_s };
    let (pieces, about) = (pieces(&lots), order.about());
    let title = format!("where a cycle goes, mean per part: {about}");
    let chart = Chart::of(title, "s", Vec::new(), &pieces);
    let groups = vec![
        times(&lots, test_s),
        bound(&lots, mean_bar),
        path::path(order, &lots)?,
        pieces,
        bins::machine(&lots),
    ];
    let notes = exception::slow(&lots, test_s, CYCLE_S);
    Ok(Report::new("cycle", about, groups, chart).noted(notes))
}

/// Returns the greatest permitted times of the longest and of the mean test, seconds of rig time.
fn allowed_s(order: &Order) -> (f64, f64) {
    match &order.recipe.device {
        DeviceRecipe::Ssr(ssr) => match ssr.part.output {
            Output::Dc => (DC_TEST_S, DC_TEST_S),
            Output::AcZeroCross | Output::AcRandom => (AC_TEST_S, AC_TEST_S),
        },
        DeviceRecipe::EmRelay(_) | DeviceRecipe::Resistor(_) | DeviceRecipe::Thermostat(_) => {
            (TEST_S, MEAN_S)
        }
    }
}

/// Returns longest, mean and median time of tests and of cycles; for good parts also those of the first
/// [`LEARNING_PARTS`] parts of a lot and of all later parts.
pub fn times(lots: &[Lot], test_s: f64) -> Vec<Figure> {
    let good = |from: usize, to: usize| -> Vec<f64> {
        let of = move |lot| Lot::good(lot).skip(from).take(to - from);
        lots.iter()
            .flat_map(of)
            .filter_map(|it| it.test_s)
            .collect()
    };
    let any = |of: fn(&Part) -> Option<f64>| -> Vec<f64> {
        lots.iter()
            .flat_map(|lot| &lot.parts)
            .filter_map(of)
            .collect()
    };
    let cycles: Vec<f64> = lots
        .iter()
        .flat_map(Lot::good)
        .filter_map(|it| it.cycle_s)
        .collect();
    let first = format!("  of the first {LEARNING_PARTS} of a lot, which teach");
    vec![
        longest("test, longest of good parts", test_s, &good(0, usize::MAX)),
        longest(first, test_s, &good(0, LEARNING_PARTS)),
        longest(
            "  of those after them",
            test_s,
            &good(LEARNING_PARTS, usize::MAX),
        ),
        longest(
            "test, longest of all parts",
            ANY_TEST_S + test_s - TEST_S,
            &any(|it| it.test_s),
        ),
        longest("cycle, longest of good parts", CYCLE_S, &cycles),
        longest(
            "cycle, longest of all parts",
            CYCLE_S,
            &any(|it| it.cycle_s),
        ),
    ]
}

fn longest(name: impl Into<String>, bar_s: f64, times: &[f64]) -> Figure {
    let spread = Spread::of(times);
    let over = times.iter().filter(|it| **it > bar_s).count() as u64;
    Figure::new(name, spread.n(), spread.max(), "s")
        .with("mean", spread.mean())
        .with("median", median(times))
        .with("over_bar_pct", percent(over, spread.n()))
        .bar(Bar::AtMost(bar_s))
}

/// Compares the mean test time of good parts with its lower bound: the time of the same test steps on a bus without
/// delay, where only conversion, settling and the contact events take time.
pub fn bound(lots: &[Lot], mean_bar: f64) -> Vec<Figure> {
    let tests: Vec<(f64, f64)> = lots
        .iter()
        .flat_map(Lot::good)
        .filter_map(|part| Some((part.test_s?, *part.spent.get("bound_s")?)))
        .collect();
    let test = mean(tests.iter().map(|it| it.0));
    let bound = mean(tests.iter().map(|it| it.1));
    let n = tests.len() as u64;
    let ratio = test.zip(bound).map(|(test, bound)| test / bound);
    vec![
        Figure::new("test, mean of good parts", n, test, "s").bar(Bar::AtMost(mean_bar)),
        Figure::new("bound: settling, conversion, events", n, bound, "s"),
        Figure::new("test against bound", n, ratio, "").bar(Bar::AtMost(RATIO)),
    ]
}

/// Returns the mean time of each piece of a cycle, seconds of rig time.
pub fn pieces(lots: &[Lot]) -> Vec<Figure> {
    let parts: Vec<(&Part, f64, f64)> = lots
        .iter()
        .flat_map(|lot| &lot.parts)
        .filter_map(|part| Some((part, part.test_s?, part.cycle_s?)))
        .collect();
    let is_split = parts.iter().any(|(part, ..)| !part.spent.is_empty());
    let cycle = mean(parts.iter().map(|(_, _, cycle)| *cycle));
    let row = |name: &str, seconds: &dyn Fn(&(&Part, f64, f64)) -> f64| {
        let seconds = mean(parts.iter().map(seconds));
        Figure::new(name, parts.len() as u64, seconds, "s")
            .with("share_pct", share_pct(seconds, cycle))
    };
    let spent = |part: &Part, key: &str| part.spent.get(key).copied().unwrap_or(0.0);
    let mut rows = vec![
        row("cycle", &|(_, _, cycle)| *cycle),
        row("mechanics outside the test", &|(_, test, cycle)| {
            cycle - test
        }),
    ];
    if !is_split {
        rows.push(row("test", &|(_, test, _)| *test));
        return rows;
    }
    rows.extend(
        PIECES.map(|(key, name)| row(&format!("test: {name}"), &|(part, ..)| spent(part, key))),
    );
    rows.push(row("test: rest", &|(part, test, _)| {
        test - PIECES.iter().map(|(key, _)| spent(part, key)).sum::<f64>()
    }));
    rows
}
