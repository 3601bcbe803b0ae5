//! Good parts rejected and defects by bin, over lots enough to see both.

use super::bins;
use super::chart::Chart;
use super::exception;
use super::fleet::Order;
use super::output::Report;

/// Runs the lots and makes the report.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let lots = order.run_all()?;
    let defects = bins::defects(&lots);
    let chart = Chart::of(
        format!("defects in the bin of their cause: {}", order.about()),
        "%",
        vec![100.0],
        &defects,
    );
    let groups = vec![bins::outcome(&lots), defects, bins::machine(&lots)];
    Ok(Report {
        study: "sorting",
        about: order.about(),
        groups,
        notes: exception::outcome(&lots),
        chart,
    })
}
