//! Noise of the analog inputs, from the conversions of a calibration that read constant levels and drops.

use super::DROPS;
use super::levels::Levels;
use super::taken::Taken;
use crate::dut::accuracy::LSB_V;
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::readings::{CoilScan, Readings};
use crate::gauge::evidence::Residuals;
use crate::instrument::readings::Readings as ByPoint;
use crate::rig::sample::{Quality, Sample};

/// Channels of the coil converter whose signals are constant at each level.
const CHANNELS: [fn(&CoilScan) -> &Option<Sample>; 5] = [
    |scan| &scan.voltage_fine,
    |scan| &scan.current_fine,
    |scan| &scan.current_wide,
    |scan| &scan.current_high,
    |scan| &scan.reference,
];

/// Returns the residuals of all conversions of a constant voltage, against the promised noise in steps of the
/// converter; empty for an incomplete calibration.
pub fn noise(context: &Context, readings: &ByPoint, noise_lsb: f64) -> Vec<Residuals> {
    let readings = Readings::of(readings, &context.points, None);
    let Ok(taken) = Taken::of(Levels::of(context), &readings) else {
        return Vec::new();
    };
    let channels = |scans| CHANNELS.map(|channel| of_channel(scans, channel, noise_lsb));
    let scans = taken.constants().flat_map(channels).flatten();
    let drops = readings.drops.chunks(DROPS);
    let drops = drops.filter_map(|drops| of_constant(drops.iter(), noise_lsb));
    scans.chain(drops).collect()
}

fn of_channel(
    scans: &[CoilScan],
    channel: fn(&CoilScan) -> &Option<Sample>,
    noise_lsb: f64,
) -> Option<Residuals> {
    let read = scans.iter().filter_map(|scan| channel(scan).as_ref());
    of_constant(read, noise_lsb)
}

/// Returns the residuals of conversions of one constant voltage; `None` when one of them is out of range.
fn of_constant<'a>(samples: impl Iterator<Item = &'a Sample>, noise_lsb: f64) -> Option<Residuals> {
    let good = |sample: &Sample| (sample.quality == Quality::Good).then_some(sample.terminal_volts);
    let volts: Vec<f64> = samples.map(good).collect::<Option<_>>()?;
    let own = (LSB_V * noise_lsb).powi(2);
    Residuals::about_mean(&volts, own, LSB_V.powi(2) / 12.0)
}
