//! How often the stated uncertainty (k = 2) covers the truth, pooled over good parts of many lots.
//!
//! Every lot has a rig of its own, so errors that stay the same within a lot are sampled too. Too high
//! is as wrong as too low: an uncertainty that covers always has been stated too large.

use super::chart::Chart;
use super::error::Pooled;
use super::figure::{Bar, Figure};
use super::fleet::Order;
use super::lot::Lot;
use super::output::Report;
use super::parameters;
use machine::dut::em_relay::Parameter;

/// Percent of values that may be covered.
const ALLOWED: (f64, f64) = (93.0, 98.0);

/// Runs the lots and makes the report.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let chart = Chart {
        title: "coverage of the stated uncertainty".into(),
        unit: "%",
        from: 80.0,
        marks: vec![ALLOWED.0, ALLOWED.1],
        ..Chart::default()
    };
    parameters::study("coverage", order, row, |_, percent| percent, chart)
}

fn row(parameter: Parameter, lots: &[Lot]) -> Figure {
    let errors = Pooled::of(parameter, lots);
    Figure::new(parameter.name(), errors.n(), errors.coverage_pct(), "%")
        .with("worst_lot", errors.worst_coverage_pct())
        .bar(Bar::Within(ALLOWED.0, ALLOWED.1))
}
