//! Noise of the analog inputs: conversions of references that stand still.

use crate::dut::em_relay::measure::context::LSB_V;
use crate::dut::em_relay::readings::CoilScan;
use crate::gauge::evidence::Residuals;
use crate::rig::sample::Sample;

/// Returns the residuals of each channel over scans of one level.
pub fn of_scans(scans: &[CoilScan], noise_lsb: f64) -> Vec<Residuals> {
    let channels: [fn(&CoilScan) -> &Option<Sample>; 4] = [
        |scan| &scan.voltage_fine,
        |scan| &scan.current_fine,
        |scan| &scan.current_wide,
        |scan| &scan.reference,
    ];
    let of = |channel: fn(&CoilScan) -> &Option<Sample>| {
        let read = scans.iter().filter_map(|scan| channel(scan).as_ref());
        of_constant(read, noise_lsb)
    };
    channels.into_iter().filter_map(of).collect()
}

/// Returns the residuals of conversions of one constant voltage.
pub fn of_constant<'a>(
    samples: impl Iterator<Item = &'a Sample>,
    noise_lsb: f64,
) -> Option<Residuals> {
    let volts: Vec<f64> = samples.map(|sample| sample.terminal_volts).collect();
    let own = (LSB_V * noise_lsb).powi(2);
    Residuals::about_mean(&volts, own, LSB_V.powi(2) / 12.0)
}
