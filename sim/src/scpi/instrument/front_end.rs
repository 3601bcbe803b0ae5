//! Front end of a digitizer: probes, ranges, converter and trigger, precomputed from the settings for every sample.

use super::Channel;
use super::digitizer::{CHANNELS, Dialect, SOURCES};
use super::errors::{Accuracy, Errors};
use super::settings::Settings;
use crate::scpi::circuit::{Circuit, Terminal};

/// Number of vertical divisions that span the range.
pub(super) const VERTICAL: f64 = 8.0;
/// Number of codes of the converter.
pub(super) const CODES: f64 = 4096.0;

/// Range of one channel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    at: Terminal,
    /// Displayed volts per volt or ampere at the terminals.
    factor: f64,
    is_inverted: bool,
    /// Width, displayed volts.
    pub(super) full_v: f64,
    /// Volts that the offset adds before the converter.
    pub(super) offset_v: f64,
}

/// Ranges and trigger.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrontEnd {
    pub(super) ranges: [Range; CHANNELS],
    source: usize,
    level_v: f64,
    is_rising: bool,
}

impl FrontEnd {
    /// Creates the front end from the settings. Keysight centres the screen on its offset, Rigol adds its offset to the
    /// signal.
    pub(super) fn new(
        settings: &Settings,
        channels: &[Channel; CHANNELS],
        dialect: Dialect,
    ) -> Self {
        let of = |key, channel| settings.of(key, channel);
        let range = |n: usize| Range {
            at: channels[n].at,
            factor: channels[n].ratio * of("probe", n),
            is_inverted: of("inverted", n) != 0.0,
            full_v: VERTICAL * of("scale", n),
            offset_v: match dialect {
                Dialect::Rigol => of("offset", n),
                Dialect::Keysight => -of("offset", n),
            },
        };
        let source = settings.choice("trigger");
        let source = SOURCES.iter().position(|it| *it == source);
        Self {
            ranges: std::array::from_fn(range),
            source: source.unwrap_or_default(),
            level_v: settings.number("level"),
            is_rising: settings.choice("slope") == "POSitive",
        }
    }

    /// Converts the present signals of the channels; returns the codes, and the volts by which the trigger source
    /// exceeds the trigger level, positive in the direction of the slope.
    pub(super) fn convert(
        &self,
        errors: &mut Errors,
        circuit: &dyn Circuit,
    ) -> ([u16; CHANNELS], f64) {
        let (mut codes, mut above_v) = ([0; CHANNELS], 0.0);
        for (number, (range, code)) in self.ranges.iter().zip(&mut codes).enumerate() {
            let seen = circuit.at(range.at);
            let seen = match range.at {
                Terminal::Load => seen.amps,
                _ => seen.volts,
            };
            let accuracy = Accuracy {
                gain: 3e-3,
                offset: 1e-3 * range.full_v,
                noise: 4e-4 * range.full_v,
            };
            let shown_v = errors.apply(number, accuracy, seen * range.factor);
            let shown_v = if range.is_inverted { -shown_v } else { shown_v };
            let part = (shown_v + range.offset_v) / range.full_v + 0.5;
            *code = (part * CODES).round().clamp(0.0, CODES - 1.0) as u16;
            if number == self.source {
                above_v = shown_v - self.level_v;
            }
        }
        (codes, if self.is_rising { above_v } else { -above_v })
    }
}

impl Range {
    /// Returns the displayed volts of a code.
    pub(super) fn volts(&self, code: u16) -> f64 {
        (f64::from(code) / CODES - 0.5) * self.full_v - self.offset_v
    }
}
