//! The studies with one figure per characteristic: accuracy and coverage. Below these figures the report shows in which
//! bins the parts ended, how many alarms, logged errors and EEPROM writes there were, and the parts worth a look.
//!
//! - Accuracy: the bar applies to the rms error over good parts, as a median over lots. Further columns have the worst
//!   lot, the bias (median over lots of the mean error), the greatest error of any part and the pooled coverage.
//! - Coverage: how often the stated uncertainty (k = 2) covers the truth, pooled over good parts of many lots. Every
//!   lot has its own rig, so that the lots sample the errors that stay the same within a lot. Too high is as wrong as
//!   too low: an uncertainty that always covers the truth is stated too large. A characteristic without any error, such
//!   as a number of half periods of the mains, has no bar.

use super::bins;
use super::chart::Chart;
use super::error::{Pooled, unit};
use super::exception;
use super::figure::{Bar, Figure};
use super::lot::Lot;
use super::order::Order;
use super::output::Report;
use machine::dut::Characteristic;

/// Bar of the coverage: lowest and highest, percent of values.
const COVERAGE_PCT: (f64, f64) = (93.0, 98.0);
/// Left end of the chart of coverage, percent.
const CHART_FROM_PCT: f64 = 80.0;

/// Compares the rms error of every characteristic with its bar.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn accuracy(order: &Order) -> anyhow::Result<Report> {
    let rated_v = order.recipe.device.part().nominal_v;
    let accepted = |it: Characteristic, errors: &Pooled| {
        let accepted = it.accepted_error(rated_v)?;
        // A lot without values has no true ones either, and misses any bar.
        let truth = errors.median_truth().unwrap_or(0.0);
        Some(((accepted.rms + accepted.share * truth.abs()) * 1e4).round() / 1e4)
    };
    let row = |characteristic: Characteristic, errors: &Pooled| {
        let (n, rms) = (errors.n(), errors.median_rms());
        let figure = Figure::new(characteristic.key(), n, rms, unit(characteristic))
            .with("worst_lot", errors.worst_rms())
            .with("bias", errors.median_bias())
            .with("max", errors.worst())
            .with("coverage_pct", errors.coverage_pct());
        match accepted(characteristic, errors) {
            Some(rms) => figure.bar(Bar::AtMost(rms)),
            None => figure,
        }
    };
    let share = |figure: &Figure| match figure.bar {
        Some(Bar::AtMost(allowed)) => figure.value.map(|rms| 100.0 * rms / allowed),
        Some(Bar::Below(_) | Bar::AtLeast(_) | Bar::Within(..)) | None => None,
    };
    let title = "rms error as a share of what is allowed";
    let chart = Chart::new(title, "%", vec![100.0], []);
    study("accuracy", order, row, share, chart)
}

/// Counts how often the stated uncertainty of every characteristic covers the truth.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn coverage(order: &Order) -> anyhow::Result<Report> {
    let (low, high) = COVERAGE_PCT;
    let row = |characteristic: Characteristic, errors: &Pooled| {
        let figure = Figure::new(characteristic.key(), errors.n(), errors.coverage_pct(), "%")
            .with("worst_lot", errors.worst_coverage_pct());
        match errors.worst() {
            Some(0.0) => figure,
            Some(_) | None => figure.bar(Bar::Within(low, high)),
        }
    };
    let title = "coverage of the stated uncertainty";
    let chart = Chart {
        from: CHART_FROM_PCT,
        ..Chart::new(title, "%", vec![low, high], [])
    };
    study("coverage", order, row, |figure| figure.value, chart)
}

/// Runs the lots and makes the report; `length` returns the length of the bar in `chart` for a figure.
fn study(
    study: &'static str,
    order: &Order,
    row: impl Fn(Characteristic, &Pooled) -> Figure,
    length: impl Fn(&Figure) -> Option<f64>,
    mut chart: Chart,
) -> anyhow::Result<Report> {
    let lots: Vec<Lot> = order.run_all()?;
    // The recipe does not measure a characteristic without limits and values; one with limits but no values misses its
    // bar.
    let limited = |it| order.recipe.limits.named().any(|(known, _)| known == it);
    let measured = |it: &(Characteristic, Pooled)| it.1.n() > 0 || limited(it.0);
    let of = |it: Characteristic| (it, Pooled::of(it, &lots));
    let all = order.characteristics().into_iter().map(of);
    let all: Vec<(Characteristic, Pooled)> = all.filter(measured).collect();
    let rows: Vec<Figure> = all.iter().map(|(it, errors)| row(*it, errors)).collect();
    chart.title = format!("{}: {}", chart.title, order.about());
    let bars = rows.iter().map(|it| (it.name.clone(), length(it)));
    chart.bars = bars.collect();
    let groups = vec![rows, bins::outcome(&lots), bins::machine(&lots)];
    Ok(Report::new(study, order.about(), groups, chart).noted(exception::outcome(&lots)))
}
