//! Seconds against error of the thresholds, for every strategy and baud rate, on the whole line: real acts, real
//! transactions.
//!
//! Run in a world whose instruments, certificates, temperature and operations err by nothing, so that what is left
//! is the strategy's own error. 25 ms of settling at the pre-bias are added to operate, since the coil resistance
//! that pays for them otherwise might not be asked for. A pulse has no value, only a bit.

use super::figure::Bar;
use super::method::{self, BAUDS, Paid};
use super::order::Order;
use super::output::Report;
use super::variant::Variant;
use machine::dut::em_relay::{Parameter, Strategy};

/// Operate with the time of flux and armature at the pre-bias, and release.
const THRESHOLDS: [Paid; 2] = [
    Paid {
        more_s: 0.025,
        ..Paid::of(Parameter::OperateVoltage, &["operate"])
    },
    Paid::of(Parameter::ReleaseVoltage, &["release"]),
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

/// Runs the lots and makes the report.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let mut groups = vec![Vec::new(), Vec::new(), Vec::new()];
    for baud in BAUDS {
        for strategy in Strategy::ALL {
            let named = |key| (key, strategy.name().into());
            let recipe = vec![
                named("test.strategy.operate_voltage_v"),
                named("test.strategy.release_voltage_v"),
            ];
            let lots = method::lots(&Variant::exact(baud, recipe), order)?;
            for (place, paid) in THRESHOLDS.iter().enumerate() {
                let what = paid.stages.join(" ");
                let name = format!("{what} {} {baud}", strategy.name());
                let row = paid.row(name.clone(), &lots);
                let bars = bars(paid.parameter, strategy).filter(|_| baud == BAUDS[0]);
                groups[2].extend(bars.map(|(_, s)| paid.time(&name, &lots, s)));
                groups[place].push(match bars {
                    Some((mv, _)) => row.bar(Bar::AtMost(mv)),
                    None => row,
                });
            }
        }
    }
    let marks = vec![1.0, 12.0];
    Ok(method::report("threshold", order, groups, 2, marks))
}
