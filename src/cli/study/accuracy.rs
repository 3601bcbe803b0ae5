//! Error of every parameter against the truth.
//!
//! Held against the bar is the median over lots of the rms error over good parts; beside it stand the worst
//! lot, the median over lots of the mean error, the greatest error of any part and the pooled coverage.

use super::bins;
use super::chart::Chart;
use super::error::{Pooled, unit};
use super::exception;
use super::figure::{Bar, Figure};
use super::fleet::Order;
use super::lot::Lot;
use super::output::Report;
use crate::gauge::Parameter;

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
    let lots = order.run_all()?;
    let errors: Vec<Figure> = Parameter::ALL
        .iter()
        .map(|parameter| row(*parameter, &lots))
        .collect();
    let share =
        |parameter: Parameter, figure: &Figure| Some(100.0 * figure.value? / allowed(parameter));
    let bars = Parameter::ALL
        .iter()
        .zip(&errors)
        .map(|(it, figure)| (figure.name.clone(), share(*it, figure)));
    let chart = Chart {
        title: format!("rms error as a share of what is allowed: {}", order.about()),
        unit: "%",
        from: 0.0,
        marks: vec![100.0],
        bars: bars.collect(),
    };
    let groups = vec![errors, bins::outcome(&lots), bins::machine(&lots)];
    Ok(Report {
        study: "accuracy",
        about: order.about(),
        groups,
        notes: exception::outcome(&lots),
        chart,
    })
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
