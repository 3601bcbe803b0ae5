//! A digitizer: samples at equal intervals, with noise and the steps of its converter.

use super::{Dice, normal};
use machine::instrument::query::Waveform;

/// A digitizer without errors of gain, offset and time.
#[derive(Debug, Clone, Copy)]
pub struct Scope {
    /// Bits of the converter.
    pub bits: i32,
    /// Interval between two samples, s.
    pub step_s: f64,
}

/// Noise as a share of the range, standard deviation.
const NOISE: f64 = 4e-4;

impl Scope {
    /// Records a voltage from `start_s` for `length_s`; the range is from `-half_v` to `half_v`.
    pub fn record(
        &self,
        (start_s, length_s): (f64, f64),
        half_v: f64,
        dice: &mut Dice,
        volts: impl Fn(f64) -> f64,
    ) -> Waveform {
        let count = (length_s / self.step_s).round() as usize;
        let step_v = 2.0 * half_v / 2f64.powi(self.bits);
        let sample = |index: usize| {
            let noise_v = normal(dice, 0.0, 2.0 * NOISE * half_v);
            let seen_v = volts(start_s + index as f64 * self.step_s) + noise_v;
            ((seen_v / step_v).round() * step_v).clamp(-half_v, half_v) as f32
        };
        Waveform {
            start_s,
            step_s: self.step_s,
            volts: (0..count).map(sample).collect(),
        }
    }
}
