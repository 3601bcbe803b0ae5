//! Good parts rejected and defects by bin, over lots enough to see both.

use super::bins;
use super::chart::Chart;
use super::exception;
use super::fleet::Order;
use super::output::Report;

/// Runs the lots and draws the report up.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let lots = order.run_all()?;
    let defects = bins::defects(&lots);
    let chart = Chart {
        title: format!("defects in the bin of their cause: {}", order.about()),
        unit: "%",
        from: 0.0,
        marks: vec![100.0],
        bars: defects
            .iter()
            .map(|figure| (figure.name.clone(), figure.value))
            .collect(),
    };
    let groups = vec![bins::outcome(&lots), defects, bins::machine(&lots)];
    Ok(Report {
        study: "sorting",
        about: order.about(),
        groups,
        notes: exception::outcome(&lots),
        chart,
    })
}
