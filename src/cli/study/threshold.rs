//! Seconds against error, for every strategy and baud rate, on the whole line: real acts, real transactions.
//!
//! Run in a world whose instruments, temperature and operations err by nothing, so that what is left is the
//! strategy's own error. Seconds are the mean of the stages that measure the threshold; 25 ms of settling at
//! the pre-bias are added to operate, since the coil resistance that pays for them otherwise might not be asked
//! for. A pulse has no value, only a bit.

use super::chart::Chart;
use super::error::Pooled;
use super::figure::{Bar, Figure};
use super::fleet::Order;
use super::lot::Lot;
use super::output::Report;
use super::variant::Variant;
use crate::gauge::{Parameter, Strategy};
use crate::quality::Spread;

/// Flux and armature at the pre-bias.
const PREBIAS_S: f64 = 0.025;
/// Baud rates of the lines.
const BAUDS: [u32; 2] = [115_200, 9600];
/// Thresholds with the stage whose time is theirs.
const THRESHOLDS: [(Parameter, &str, f64); 2] = [
    (Parameter::OperateVoltage, "operate", PREBIAS_S),
    (Parameter::ReleaseVoltage, "release", 0.0),
];

/// Rms in millivolts and seconds that a strategy has to keep at 115200 baud.
fn bars(parameter: Parameter, strategy: Strategy) -> Option<(f64, f64)> {
    match (parameter, strategy) {
        (Parameter::OperateVoltage, Strategy::CoarseFine) => Some((1.0, 0.20)),
        (Parameter::OperateVoltage, Strategy::Ramp) => Some((12.0, 0.08)),
        (Parameter::ReleaseVoltage, Strategy::CoarseFine) => Some((1.0, 0.25)),
        _ => None,
    }
}

/// Runs the lots and draws the report up.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let mut groups = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
    for baud in BAUDS {
        for strategy in Strategy::ALL {
            let variant = Variant {
                strategy,
                baud,
                exact: true,
            }
            .of(order)?;
            let lots = variant.order.run_all()?;
            for (place, threshold) in THRESHOLDS.into_iter().enumerate() {
                let (error, time) = rows(&lots, threshold, strategy, baud);
                groups[place].push(error);
                groups[2 + place].push(time);
            }
        }
    }
    let chart = Chart {
        title: format!("rms error of a strategy: {}", order.about()),
        unit: "mV",
        from: 0.0,
        marks: vec![1.0, 12.0],
        bars: groups[..2]
            .iter()
            .flatten()
            .map(|row| (row.name.clone(), row.value))
            .collect(),
    };
    Ok(Report {
        study: "threshold",
        about: format!("{}, instruments without errors", order.about()),
        groups: groups.to_vec(),
        notes: Vec::new(),
        chart,
    })
}

/// Error and seconds of one strategy.
fn rows(
    lots: &[Lot],
    (parameter, stage, more_s): (Parameter, &str, f64),
    strategy: Strategy,
    baud: u32,
) -> (Figure, Figure) {
    let errors = Pooled::of(parameter, lots);
    let times: Vec<f64> = lots
        .iter()
        .flat_map(Lot::good)
        .filter_map(|part| Some(part.stages.get(stage)? + more_s))
        .collect();
    let seconds = Spread::of(&times);
    let name = format!("{stage} {} {baud}", strategy.name());
    let error = Figure::new(name.clone(), errors.n(), errors.median_rms(), "mV")
        .with("bias", errors.median_bias())
        .with("max", errors.worst())
        .with("seconds", seconds.mean());
    let time = Figure::new(format!("{name} time"), seconds.n(), seconds.mean(), "s")
        .with("longest", seconds.max());
    match bars(parameter, strategy).filter(|_| baud == BAUDS[0]) {
        Some((mv, s)) => (error.bar(Bar::AtMost(mv)), time.bar(Bar::AtMost(s))),
        None => (error, time),
    }
}
