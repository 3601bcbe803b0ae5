//! Front end of a digitizer: probes, ranges, converter and trigger, precomputed from the settings for every sample.

use super::Channel;
use super::digitizer::{CHANNELS, Dialect, SOURCES};
use super::errors::Errors;
use super::settings::Settings;
use crate::scpi::circuit::{Circuit, Terminal};

/// Number of vertical divisions that span the range.
pub(super) const VERTICAL: f64 = 8.0;
/// Number of codes of the converter.
pub(super) const CODES: f64 = 4096.0;

/// Limits of error. The gain of a channel, and what one of its ranges adds to it, are fractions; offset, bend of the
/// curve and noise (standard deviation) are fractions of the range.
const GAIN: f64 = 2e-2;
const GAIN_OF_RANGE: f64 = 1e-3;
const OFFSET: f64 = 1e-2;
const BEND: f64 = 2.5e-4;
const NOISE: f64 = 4e-4;

/// Range of one channel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    at: Terminal,
    /// Displayed volts per volt or ampere at the terminals.
    factor: f64,
    is_inverted: bool,
    /// Width of the range, displayed volts.
    pub(super) full_v: f64,
    /// Volts that the offset adds before the converter.
    pub(super) offset_v: f64,
    /// Error of the gain, a fraction.
    gain: f64,
    /// Error of the offset, displayed volts.
    error_v: f64,
    /// Greatest deviation of the curve from a line, displayed volts.
    bend_v: f64,
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
        errors: &Errors,
    ) -> Self {
        let of = |key, channel| settings.of(key, channel);
        let range = |n: usize| {
            let full_v = VERTICAL * of("scale", n);
            let [gain, offset, bend] = errors.of_range(n, attenuator(of("scale", n)));
            Range {
                at: channels[n].at,
                factor: channels[n].ratio * of("probe", n),
                is_inverted: of("inverted", n) != 0.0,
                full_v,
                offset_v: match dialect {
                    Dialect::Rigol => of("offset", n),
                    Dialect::Keysight => -of("offset", n),
                },
                gain: GAIN * errors.of_gain(n) + GAIN_OF_RANGE * gain,
                error_v: OFFSET * offset * full_v,
                bend_v: BEND * bend * full_v,
            }
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
            let noise_v = NOISE * range.full_v * errors.normal();
            let shown_v = range.distorted(seen * range.factor) + noise_v;
            let shown_v = if range.is_inverted { -shown_v } else { shown_v };
            let part = (shown_v + range.offset_v) / range.full_v + 0.5;
            // The conversion to an integer truncates, and makes 0 of a negative value.
            *code = (part * CODES + 0.5).min(CODES - 1.0) as u16;
            if number == self.source {
                above_v = shown_v - self.level_v;
            }
        }
        (codes, if self.is_rising { above_v } else { -above_v })
    }
}

/// Returns the step of the attenuator, three steps to a decade, for a scale in volts per division.
fn attenuator(scale_v: f64) -> i32 {
    (3.0 * scale_v.log10()).floor() as i32
}

impl Range {
    /// Returns the signal with the errors of the channel but without noise, displayed volts.
    fn distorted(&self, volts: f64) -> f64 {
        let part = (2.0 * volts / self.full_v).clamp(-1.0, 1.0);
        // 0 in the middle and at both ends; the factor makes the greatest value 1.
        let bent_v = self.bend_v * 2.598 * part * (1.0 - part * part);
        volts * (1.0 + self.gain) + self.error_v + bent_v
    }

    /// Returns the displayed volts of a code.
    pub(super) fn volts(&self, code: u16) -> f64 {
        (f64::from(code) / CODES - 0.5) * self.full_v - self.offset_v
    }
}
