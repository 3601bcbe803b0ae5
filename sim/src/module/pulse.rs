//! One counter: the pulses that pass its gate, between preset and maximum.

use super::{Terminals, setting};
use crate::config::ConfigError;
use crate::table::Table;

/// Registers of one counter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channel {
    pub(super) preset: u32,
    pub(super) maximum: u32,
    pub(super) running: bool,
    pub(super) overflowed: bool,
    /// Open time of the gate while the counter was running, microseconds.
    pub(super) counted_us: f64,
    /// Open time of the gate at the last update, microseconds.
    pub(super) seen_us: f64,
    /// Number of pulses that had passed the gate when the count was the preset plus `start`.
    zero_pulses: u64,
    start: u64,
    /// Frequency at a bench input, hertz; `None` on a rig, where the reference clock of the plant applies.
    bench_hz: Option<f64>,
}

impl Channel {
    /// Returns the true frequency at the input, hertz.
    pub(super) fn hz(&self, at: &Terminals<'_>) -> f64 {
        self.bench_hz
            .unwrap_or_else(|| at.plant.reference_clock_hz())
    }

    fn pulses(&self, hz: f64) -> u64 {
        (hz * self.counted_us * 1e-6).floor() as u64
    }

    fn span(&self) -> u64 {
        u64::from(self.maximum.saturating_sub(self.preset)) + 1
    }

    fn position(&self, hz: f64) -> u64 {
        self.start + (self.pulses(hz) - self.zero_pulses)
    }

    /// Returns the count that `#AAN` reads at an input of `hz`.
    pub(super) fn value(&self, hz: f64) -> u64 {
        u64::from(self.preset) + self.position(hz) % self.span()
    }

    /// Checks whether the counter has passed its maximum since the last reset.
    pub(super) fn overflow(&self, hz: f64) -> bool {
        self.overflowed || self.position(hz) >= self.span()
    }

    /// Sets the counter to its preset and forgets all pulses, as a power loss does.
    pub(super) fn power_cycle(&mut self) {
        self.start = 0;
        self.zero_pulses = 0;
        self.counted_us = 0.0;
        self.overflowed = false;
    }

    /// Sets the counter to its preset and clears the overflow.
    pub(super) fn reset(&mut self, hz: f64) {
        self.zero_pulses = self.pulses(hz);
        self.start = 0;
        self.overflowed = false;
    }
}

/// Highest frequency at an input, hertz.
const HIGHEST_HZ: f64 = 100_000.0;

/// Reads both channels from the module's table.
pub(super) fn channels(keys: &Table) -> Result<[Channel; 2], ConfigError> {
    let counts = |key| setting::counts(keys, key, 2, 0..=u32::MAX);
    let (presets, maxima, counts) = (counts("preset")?, counts("maximum")?, counts("counts")?);
    let form = format!("frequencies from 0 to {HIGHEST_HZ} Hz");
    let fits = |hz| (0.0..=HIGHEST_HZ).contains(&hz);
    let inputs = setting::values(keys, "inputs", 2, &form, fits)?;
    let running = setting::bits(keys, "enabled", 0b11)?.unwrap_or(0b11);
    let overflow = setting::bits(keys, "overflow", 0b11)?.unwrap_or(0);
    Ok([0usize, 1].map(|n| {
        let preset = presets.get(n).copied().unwrap_or(0);
        let count = counts.get(n).copied().unwrap_or(preset);
        Channel {
            preset,
            maximum: maxima.get(n).copied().unwrap_or(u32::MAX),
            running: running & 1 << n != 0,
            overflowed: overflow & 1 << n != 0,
            counted_us: 0.0,
            seen_us: 0.0,
            zero_pulses: 0,
            start: u64::from(count.saturating_sub(preset)),
            bench_hz: inputs.get(n).copied(),
        }
    }))
}
