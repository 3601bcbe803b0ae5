//! Error of every parameter against the truth.
//!
//! The bar of a threshold is a share of the nominal coil voltage. Held against the bar is the median over lots of the rms error over good parts; beside it stand the worst
//! lot, the median over lots of the mean error, the greatest error of any part and the pooled coverage.

use super::chart::Chart;
use super::error::{Pooled, unit};
use super::figure::{Bar, Figure};
use super::fleet::Order;
use super::lot::Lot;
use super::output::Report;
use super::parameters;
use machine::dut::em_relay::Parameter;
use units::Unit;

/// Runs the lots and makes the report.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let chart = Chart {
        title: "rms error as a share of what is allowed".into(),
        unit: "%",
        marks: vec![100.0],
        ..Chart::default()
    };
    let nominal_v = order.nominal_v;
    let share = |parameter, value| 100.0 * value / allowed(parameter, nominal_v);
    let row = |parameter, lots: &[Lot]| row(parameter, lots, nominal_v);
    parameters::study("accuracy", order, row, share, chart)
}

/// Returns the greatest acceptable rms error in the unit of [`unit`]: that of a threshold is a share of the nominal voltage.
fn allowed(parameter: Parameter, nominal_v: f64) -> f64 {
    let allowed = parameter.facts().allowed_rms;
    match parameter.facts().definition.unit {
        Unit::Volt => (allowed * nominal_v * 1e4).round() / 1e3,
        _ => allowed,
    }
}

fn row(parameter: Parameter, lots: &[Lot], nominal_v: f64) -> Figure {
    let errors = Pooled::of(parameter, lots);
    Figure::new(
        parameter.name(),
        errors.n(),
        errors.median_rms(),
        unit(parameter),
    )
    .with("worst_lot", errors.worst_rms())
    .with("bias", errors.median_bias())
    .with("max", errors.worst())
    .with("coverage_pct", errors.coverage_pct())
    .bar(Bar::AtMost(allowed(parameter, nominal_v)))
}
