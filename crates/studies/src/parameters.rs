//! The studies with one figure per parameter: accuracy and coverage. Below these figures the report shows in which bins
//! the parts ended, the alarms, errors and EEPROM writes, and the parts worth a look.
//!
//! - Accuracy: the bar applies to the rms error over good parts, as a median over lots. Further columns have the worst
//!   lot, the bias (median over lots of the mean error), the greatest error of any part and the pooled coverage.
//! - Coverage: how often the stated uncertainty (k = 2) covers the truth, pooled over good parts of many lots. Every
//!   lot has its own rig, so that the lots sample the errors that stay the same within a lot. Too high is as wrong as
//!   too low: an uncertainty that always covers the truth is stated too large.

use super::bins;
use super::chart::Chart;
use super::error::{Pooled, unit};
use super::exception;
use super::figure::{Bar, Figure};
use super::lot::Lot;
use super::order::Order;
use super::output::Report;
use machine::dut::em_relay::Parameter;
use units::Unit;

/// Bar of the coverage: lowest and highest, percent of values.
const COVERAGE_PCT: (f64, f64) = (93.0, 98.0);
/// Left end of the chart of coverage, percent.
const CHART_FROM_PCT: f64 = 80.0;

/// Compares the rms error of every parameter with its bar.
///
/// # Errors
/// Fails for a part without a coil, or when a lot cannot be run.
pub fn accuracy(order: &Order) -> anyhow::Result<Report> {
    let nominal_v = order.nominal_v()?;
    let row = |parameter: Parameter, errors: &Pooled| {
        let (n, rms) = (errors.n(), errors.median_rms());
        Figure::new(parameter.name(), n, rms, unit(parameter))
            .with("worst_lot", errors.worst_rms())
            .with("bias", errors.median_bias())
            .with("max", errors.worst())
            .with("coverage_pct", errors.coverage_pct())
            .bar(Bar::AtMost(allowed(parameter, nominal_v)))
    };
    let share = |parameter, rms| 100.0 * rms / allowed(parameter, nominal_v);
    let title = "rms error as a share of what is allowed";
    let chart = Chart::new(title, "%", vec![100.0], []);
    study("accuracy", order, row, share, chart)
}

/// Returns the greatest permitted rms error in [`unit()`]; for a threshold it is a share of `nominal_v`, the nominal coil
/// voltage.
fn allowed(parameter: Parameter, nominal_v: f64) -> f64 {
    let allowed = parameter.facts().allowed_rms;
    match parameter.facts().definition.unit {
        Unit::Volt => (allowed * nominal_v * 1e4).round() / 1e3,
        _ => allowed,
    }
}

/// Counts how often the stated uncertainty of every parameter covers the truth.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn coverage(order: &Order) -> anyhow::Result<Report> {
    let (low, high) = COVERAGE_PCT;
    let row = |parameter: Parameter, errors: &Pooled| {
        Figure::new(parameter.name(), errors.n(), errors.coverage_pct(), "%")
            .with("worst_lot", errors.worst_coverage_pct())
            .bar(Bar::Within(low, high))
    };
    let title = "coverage of the stated uncertainty";
    let chart = Chart {
        from: CHART_FROM_PCT,
        ..Chart::new(title, "%", vec![low, high], [])
    };
    study("coverage", order, row, |_, percent| percent, chart)
}

/// Runs the lots and makes the report; `length` returns the length of the bar in `chart` for the figure of a parameter.
fn study(
    study: &'static str,
    order: &Order,
    row: impl Fn(Parameter, &Pooled) -> Figure,
    length: impl Fn(Parameter, f64) -> f64,
    mut chart: Chart,
) -> anyhow::Result<Report> {
    let lots: Vec<Lot> = order.run_all()?;
    let figure = |parameter: &Parameter| row(*parameter, &Pooled::of(*parameter, &lots));
    let rows: Vec<Figure> = Parameter::ALL.iter().map(figure).collect();
    chart.title = format!("{}: {}", chart.title, order.about());
    let bars = Parameter::ALL.iter().zip(&rows);
    chart.bars = bars
        .map(|(it, figure)| {
            (
                figure.name.clone(),
                figure.value.map(|value| length(*it, value)),
            )
        })
        .collect();
    let groups = vec![rows, bins::outcome(&lots), bins::machine(&lots)];
    Ok(Report::new(study, order.about(), groups, chart).noted(exception::outcome(&lots)))
}
