//! Measuring window: samples and their means.

use crate::scpi::circuit::Reading;

/// Evenly spaced samples; the last one ends the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    from_us: u64,
    for_us: f64,
    samples: u32,
    taken: u32,
    sum: Reading,
    squares: Reading,
    power: f64,
}

impl Window {
    /// Opens a window of `for_us` microseconds that begins at `from_us`.
    pub(super) fn open(from_us: u64, for_us: f64, samples: u32) -> Self {
        Self {
            from_us,
            for_us,
            samples,
            taken: 0,
            sum: Reading::default(),
            squares: Reading::default(),
            power: 0.0,
        }
    }

    /// Adds a sample; returns true when it was the last one.
    pub(super) fn take(&mut self, reading: Reading) -> bool {
        self.sum.volts += reading.volts;
        self.sum.amps += reading.amps;
        self.squares.volts += reading.volts * reading.volts;
        self.squares.amps += reading.amps * reading.amps;
        self.power += reading.volts * reading.amps;
        self.taken += 1;
        self.taken == self.samples
    }

    /// Returns the length of the window, microseconds.
    pub(super) fn for_us(&self) -> u64 {
        self.for_us as u64
    }

    /// Returns the instant of the next sample.
    pub(super) fn next_us(&self) -> u64 {
        self.instant_us(self.taken + 1)
    }

    /// Returns the instant of the last sample.
    pub(super) fn end_us(&self) -> u64 {
        self.instant_us(self.samples)
    }

    fn instant_us(&self, sample: u32) -> u64 {
        let part = f64::from(sample) / f64::from(self.samples);
        self.from_us + (self.for_us * part) as u64
    }

    /// Returns the mean voltage and current.
    pub(super) fn mean(&self) -> Reading {
        Reading {
            volts: self.sum.volts / self.count(),
            amps: self.sum.amps / self.count(),
        }
    }

    /// Returns the root mean squares of voltage and current.
    pub(super) fn rms(&self) -> Reading {
        Reading {
            volts: (self.squares.volts / self.count()).sqrt(),
            amps: (self.squares.amps / self.count()).sqrt(),
        }
    }

    /// Returns the mean power, watts.
    pub(super) fn power_w(&self) -> f64 {
        self.power / self.count()
    }

    fn count(&self) -> f64 {
        f64::from(self.taken.max(1))
    }
}
