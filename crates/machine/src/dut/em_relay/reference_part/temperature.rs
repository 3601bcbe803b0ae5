//! Temperature of the reference parts: their scatter about the track, and the error of its thermometer.
//!
//! The operate voltage shows the temperature of a coil most clearly: the 0.15 K of the shipped `rig.toml` change it by
//! 4.6 mV, whereas certificate and operation are uncertain by 2.2 mV. Release voltage and coil resistance of the same
//! part show the same temperature again, under more noise, so they add no degree of freedom. An error that all parts
//! have in common (mean heating, thermometer, reference resistor) disappears in the overshoot, but shows in the coil
//! resistance.

use super::{ReferenceRun, Shift};
use crate::dut::accuracy::AccuracySettings;
use crate::dut::em_relay::calibration::{ABOUT, Temperature};
use crate::dut::em_relay::coil::relative_per_kelvin;
use crate::dut::em_relay::scale::Scale;
use crate::dut::em_relay::settings::ReferencePart;
use crate::dut::em_relay::threshold::Direction;
use crate::gauge::evidence::Residuals;
use crate::gauge::{Deviation, Factor};

impl ReferenceRun {
    /// Returns the residuals of the operate voltages against the temperature difference that `accuracy` promises;
    /// `None` for fewer than two parts.
    pub fn temperatures(
        &self,
        parts: &[ReferencePart],
        accuracy: &AccuracySettings,
    ) -> Option<Residuals> {
        let direction = Direction::Rising;
        let (fine_v, coarse_v) = (self.mean(direction), self.over(direction));
        let beyond_own = |it: &Shift| {
            let own = overshoot_of_part(fine_v, it.coarse_v[direction as usize] / coarse_v);
            it.fine_v[direction as usize] - own
        };
        let volts: Vec<f64> = self.shifts.iter().map(beyond_own).collect();
        let (own, others) = variances(parts, direction, accuracy);
        Residuals::about_mean(&volts, own, others)
    }

    /// Returns the temperature of parts as the reference parts show it; `part_minus_track_k` is the difference of one
    /// part from the track.
    pub fn temperature(&self, part_minus_track_k: Deviation) -> Temperature {
        let n = self.shifts.len() as f64;
        let coils = || self.shifts.iter().map(|it| it.coil);
        let mean = coils().map(|it| it.value).sum::<f64>() / n;
        let squares: f64 = coils().map(|it| it.u.powi(2)).sum();
        Temperature {
            part_k: part_minus_track_k.times((1.0 + 1.0 / n).sqrt()),
            coil: Factor::new(mean, squares.sqrt() / n),
            mean_k: part_minus_track_k.value / n.sqrt(),
        }
    }
}

/// Returns the fine overshoot of a part beyond the mean `fine_v` of all parts; `coarse` is its coarse overshoot as a
/// multiple of the mean. 0 without a coarse ramp.
fn overshoot_of_part(fine_v: f64, coarse: f64) -> f64 {
    let further = fine_v * (coarse - 1.0);
    if further.is_finite() { further } else { 0.0 }
}

/// Returns the promised variances of the shift of one reference part, each as the mean over `parts`, V²: that of its
/// temperature, and that of certificate and operation.
pub(super) fn variances(
    parts: &[ReferencePart],
    direction: Direction,
    accuracy: &AccuracySettings,
) -> (f64, f64) {
    let kelvin = accuracy.part_minus_track_k * relative_per_kelvin(ABOUT);
    let mean = |of: &dyn Fn(&ReferencePart) -> f64| {
        parts.iter().map(of).sum::<f64>() / parts.len().max(1) as f64
    };
    let operation_v = |part: &ReferencePart| Scale::new(part.nominal_v, 1.0).operation_v(accuracy);
    (
        mean(&|part| (part.threshold(direction).value * kelvin).powi(2)),
        mean(&|part| part.threshold(direction).u.powi(2) + operation_v(part).powi(2)),
    )
}
