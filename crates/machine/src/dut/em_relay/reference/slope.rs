//! Slope of the fine ramp at the coil.

use super::ReferenceFault;
use super::levels::Levels;
use crate::dut::em_relay::calibration::InputLine;
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::readings::CoilScan;
use crate::gauge::Factor;
use crate::rig::sample::Quality;
use units::Volt;

/// Returns the slope of the fine ramp by least squares against the arrival times of the replies; the constant delay of
/// a reply after its conversion does not change the slope.
pub(super) fn slope(
    context: &Context,
    (levels, scans): (Levels, &[CoilScan]),
    line: &InputLine,
    voltage_gain: f64,
) -> Result<Factor, ReferenceFault> {
    let counted = levels.counted();
    let points: Vec<(f64, f64)> = scans
        .iter()
        .filter_map(|scan| scan.voltage_fine.as_ref())
        .filter(|sample| sample.quality == Quality::Good)
        .map(|sample| {
            (
                sample.origin.at.0 as f64 / 1e6,
                line.correct(Volt(sample.terminal_volts)).0 / voltage_gain,
            )
        })
        .filter(|(_, volts)| counted.contains(volts))
        .collect();
    if points.len() < 10 {
        let readings = points.len();
        return Err(ReferenceFault::FewOnRamp { readings });
    }
    let n = points.len() as f64;
    let (mt, mv) = (
        points.iter().map(|p| p.0).sum::<f64>() / n,
        points.iter().map(|p| p.1).sum::<f64>() / n,
    );
    let stt = points.iter().map(|p| (p.0 - mt).powi(2)).sum::<f64>();
    let stv = points.iter().map(|p| (p.0 - mt) * (p.1 - mv)).sum::<f64>();
    let value = stv / stt;
    let rest = points
        .iter()
        .map(|p| (p.1 - mv - value * (p.0 - mt)).powi(2))
        .sum::<f64>()
        / (n - 2.0);
    let u = (rest / stt).sqrt().hypot(value * line.gain.u);
    let nominal = context.nominal_v_per_s[1];
    if !value.is_finite() || (value / nominal - 1.0).abs() > 0.02 {
        return Err(ReferenceFault::Slope {
            v_per_s: value,
            nominal_v_per_s: nominal,
        });
    }
    Ok(Factor::new(value, u))
}
