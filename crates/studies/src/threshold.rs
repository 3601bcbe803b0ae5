//! Study `threshold`: test time against error of the thresholds (operate and release voltage), for every strategy and
//! baud rate, with all steps and bus transactions of the whole line.
//!
//! The world has no errors of instruments, certificates, temperature and operations, so that only the error of the
//! strategy remains. The time of the operate threshold includes 25 ms of settling at the pre-bias, because a recipe
//! without coil resistance spends them there. The strategy `pulse` finds only whether the threshold keeps its limit,
//! and no value.

use super::figure::Bar;
use super::method::{self, BAUDS, TimedParameter};
use super::order::Order;
use super::output::Report;
use super::variant::Variant;
use machine::dut::em_relay::{Parameter, Strategy};

/// Operate and release threshold. The operate threshold takes 0.025 s more, because flux and armature settle at the
/// pre-bias.
const THRESHOLDS: [TimedParameter; 2] = [
    TimedParameter {
        more_s: 0.025,
        ..TimedParameter::of(Parameter::OperateVoltage, &["operate"])
    },
    TimedParameter::of(Parameter::ReleaseVoltage, &["release"]),
];

/// Returns the bars of a strategy at 115200 baud: rms error in millivolts, and seconds of rig time.
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
/// Fails when a lot cannot be run.
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
            for (place, timed) in THRESHOLDS.iter().enumerate() {
                let what = timed.stages.join(" ");
                let name = format!("{what} {} {baud}", strategy.name());
                let row = timed.row(name.clone(), &lots);
                let bars = bars(timed.parameter, strategy).filter(|_| baud == BAUDS[0]);
                groups[2].extend(bars.map(|(_, s)| timed.time(&name, &lots, s)));
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
