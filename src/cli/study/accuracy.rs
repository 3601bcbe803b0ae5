//! Error of every parameter against the truth.
//!
//! Held against the bar is the median over lots of the rms error over good parts; beside it stand the worst
//! lot, the median over lots of the mean error, the greatest error of any part and the pooled coverage.

use super::chart::Chart;
use super::error::{Pooled, unit};
use super::figure::{Bar, Figure};
use super::fleet::Order;
use super::lot::Lot;
use super::output::Report;
use super::parameters;
use crate::dut::em_relay::Parameter;

/// Greatest rms error that is good enough, in the unit of [`unit`].
pub const fn allowed(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::CoilResistance => 0.12,
        Parameter::OperateVoltage => 9.0,
        Parameter::ReleaseVoltage => 4.0,
        Parameter::OperateTime | Parameter::ReleaseTime => 0.02,
        Parameter::OperateBounce | Parameter::ReleaseBounce => 0.05,
        Parameter::ContactResistanceNo | Parameter::ContactResistanceNc => 0.3,
    }
}

/// Runs the lots and draws the report up.
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
    let share = |parameter, value| 100.0 * value / allowed(parameter);
    parameters::study("accuracy", order, row, share, chart)
}

fn row(parameter: Parameter, lots: &[Lot]) -> Figure {
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
    .bar(Bar::AtMost(allowed(parameter)))
}
