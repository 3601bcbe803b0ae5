//! A study with one figure per parameter: below the figures stands where the parts went, what the machine
//! did, and which parts are worth a look.

use super::bins;
use super::chart::Chart;
use super::exception;
use super::figure::Figure;
use super::fleet::Order;
use super::lot::Lot;
use super::output::Report;
use machine::dut::em_relay::Parameter;

/// Runs the lots and draws the report up; `drawn` is the length of a parameter's bar in `chart`.
///
/// # Errors
/// A lot that could not be run.
pub fn study(
    study: &'static str,
    order: &Order,
    row: impl Fn(Parameter, &[Lot]) -> Figure,
    drawn: impl Fn(Parameter, f64) -> f64,
    chart: Chart,
) -> anyhow::Result<Report> {
    let lots = order.run_all()?;
    let rows: Vec<Figure> = Parameter::ALL.iter().map(|it| row(*it, &lots)).collect();
    let bar = |(parameter, figure): (&Parameter, &Figure)| {
        let length = figure.value.map(|value| drawn(*parameter, value));
        (figure.name.clone(), length)
    };
    Ok(Report {
        study,
        about: order.about(),
        notes: exception::outcome(&lots),
        chart: Chart {
            title: format!("{}: {}", chart.title, order.about()),
            bars: Parameter::ALL.iter().zip(&rows).map(bar).collect(),
            ..chart
        },
        groups: vec![rows, bins::outcome(&lots), bins::machine(&lots)],
    })
}
