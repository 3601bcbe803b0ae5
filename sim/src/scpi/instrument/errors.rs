//! Errors of an instrument: individual errors, drawn once, and noise.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::module::tolerances::stream;

/// Limits of error of one function at one range.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accuracy {
    /// Gain error, fraction of the reading.
    pub(super) gain: f64,
    /// Offset, in the unit of the reading.
    pub(super) offset: f64,
    /// Standard deviation of the noise, in the unit of the reading.
    pub(super) noise: f64,
}

/// Individual errors, as fractions of the maker's limits, and noise.
pub(super) struct Errors {
    rng: ChaCha8Rng,
    gain: [f64; 4],
    offset: [f64; 4],
    /// Seed of the errors that belong to a range.
    ranges: u64,
    exact: bool,
}

impl Errors {
    /// Draws the errors of one instrument; an exact one has none.
    pub(super) fn draw(mut rng: ChaCha8Rng, exact: bool) -> Self {
        let mut fractions = || std::array::from_fn(|_| 2.0 * rng.random::<f64>() - 1.0);
        let (gain, offset) = (fractions(), fractions());
        let ranges = rng.random();
        Self {
            rng,
            gain,
            offset,
            ranges,
            exact,
        }
    }

    /// Draws a number from 0 to 1; 0 for an exact instrument.
    pub(super) fn fraction(&mut self) -> f64 {
        if self.exact { 0.0 } else { self.rng.random() }
    }

    /// Returns the gain error of a function (0 to 3), common to its ranges, as a fraction of its limit.
    pub(super) fn of_gain(&self, function: usize) -> f64 {
        if self.exact { 0.0 } else { self.gain[function] }
    }

    /// Returns the errors that a function (0 to 3) has in one of its ranges alone, as fractions of their limits.
    pub(super) fn of_range(&self, function: usize, range: i32) -> [f64; 3] {
        if self.exact {
            return [0.0; 3];
        }
        let mut rng = stream(self.ranges, &format!("{function} {range}"));
        std::array::from_fn(|_| 2.0 * rng.random::<f64>() - 1.0)
    }

    /// Returns the error of the clock as a fraction of its limit.
    pub(super) fn of_clock(&self) -> f64 {
        if self.exact {
            return 0.0;
        }
        2.0 * stream(self.ranges, "clock").random::<f64>() - 1.0
    }

    /// Draws from the standard normal distribution; 0 for an exact instrument.
    pub(super) fn normal(&mut self) -> f64 {
        if self.exact {
            0.0
        } else {
            self.rng.sample(StandardNormal)
        }
    }

    /// Adds the errors of a function (0 to 3) to a true value.
    pub(super) fn apply(&mut self, function: usize, accuracy: Accuracy, value: f64) -> f64 {
        if self.exact {
            return value;
        }
        let gain = 1.0 + self.gain[function] * accuracy.gain;
        let noise = accuracy.noise * self.normal();
        value * gain + self.offset[function] * accuracy.offset + noise
    }

    /// Adds the errors of a function to a true rms value; the noise adds in squares, so the result stays above 0.
    pub(super) fn apply_rms(&mut self, function: usize, accuracy: Accuracy, value: f64) -> f64 {
        if self.exact {
            return value;
        }
        let read = self.apply(function, accuracy, value).max(0.0);
        read.hypot(accuracy.noise)
    }
}
