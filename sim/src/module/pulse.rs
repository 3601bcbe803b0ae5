//! One counter: the pulses that pass its gate, between preset and maximum.

use super::{Terminals, setting};
use crate::error::SimError;
use crate::terminal::ModuleSpec;

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
    /// Number of pulses that had passed the gate when the counter stood at its preset plus `start`.
    zero_pulses: u64,
    start: u64,
    /// Frequency at a bench input, hertz; `None` on a rig, where the plant's reference clock applies.
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

/// Reads both channels from the module's table.
pub(super) fn channels(spec: &ModuleSpec) -> Result<[Channel; 2], SimError> {
    let preset = setting::numbers(spec, "preset")?;
    let maximum = setting::numbers(spec, "maximum")?;
    let counts = setting::numbers(spec, "counts")?;
    let inputs = setting::numbers(spec, "inputs")?;
    let running = setting::bits(spec, "enabled")?.unwrap_or(0b11);
    let overflow = setting::bits(spec, "overflow")?.unwrap_or(0);
    Ok([0usize, 1].map(|n| {
        let preset = preset.get(n).map_or(0, |value| *value as u32);
        let count = counts.get(n).map_or(preset, |value| *value as u32);
        Channel {
            preset,
            maximum: maximum.get(n).map_or(u32::MAX, |value| *value as u32),
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
