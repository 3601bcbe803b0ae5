//! The trace of a test, sample by sample: the evidence kept for a rejected part.
//!
//! The trace holds analog samples and counts as read, numbers of instruments, the values commanded to sources and to
//! the traced outputs of a kind, and words of inputs. A bit signal has one sample at each change and one at the last
//! poll before it, so that polling for many milliseconds takes two samples. A test stores its first [`MAX_SAMPLES`]
//! samples; a test of the default recipe has some 150. Of a waveform the trace keeps the least and the greatest value
//! in each of [`WAVE_PIECES`] pieces, at most [`MAX_WAVE_SAMPLES`] in a test in addition to the other samples; their
//! times count back from the end of the program.

use super::query::{Delivered, Instrument, Query, Waveform};
use crate::rig::point::{AnalogOutput, DigitalOutput, Quantity};
use crate::rig::sample::{CountSample, Quality, Sample};
use crate::rig::wiring::Wiring;
use units::{RigTime, Span, Volt};

/// Greatest number of samples of one test, all signals together.
pub const MAX_SAMPLES: usize = 1_000;

/// Most numbers of one program that the trace keeps.
pub const MAX_NUMBERS: usize = 16;

/// Pieces of a waveform of which the trace keeps two samples each.
pub const WAVE_PIECES: usize = 150;

/// Greatest number of samples of all waveforms of one test.
pub const MAX_WAVE_SAMPLES: usize = 6_000;

/// Names of the waveforms of a digitizer, from channel 1 on.
const CHANNELS: [&str; 4] = ["channel_1", "channel_2", "channel_3", "channel_4"];

/// A signal of the trace, as its point declares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// Name of its point, or of the program of an instrument.
    pub name: &'static str,
    /// Instrument whose program gives the values; `None` for a point.
    pub instrument: Option<Instrument>,
    /// Unit of its values; empty for bits and counts.
    pub unit: &'static str,
    /// Resolution of stored values: a tenth of a step of the converter, or less.
    pub step: f64,
    /// True for a signal of bits, of which the trace keeps only changes.
    changes_only: bool,
}

impl Signal {
    /// Returns the signal of a source's commanded value, volts of the supply.
    pub const fn source(name: &'static str) -> Self {
        Self {
            name,
            instrument: None,
            unit: "V",
            step: 1e-5,
            changes_only: false,
        }
    }

    /// Returns the signal of an analog input in its unit, before correction.
    pub const fn input(quantity: Quantity) -> Self {
        Self {
            name: quantity.name,
            instrument: None,
            unit: quantity.unit,
            step: quantity.step,
            changes_only: false,
        }
    }

    /// Returns the signal of a gated counter.
    pub const fn count(name: &'static str) -> Self {
        Self {
            name,
            instrument: None,
            unit: "",
            step: 1.0,
            changes_only: false,
        }
    }

    /// Returns the signal of the numbers that a program of an instrument delivers.
    pub const fn program(instrument: Instrument, name: &'static str) -> Self {
        Self {
            name,
            instrument: Some(instrument),
            unit: "",
            step: 1e-12,
            changes_only: false,
        }
    }

    /// Returns the signal of a channel of a digitizer, counted from 1, volts at its input; `None` beyond the fourth.
    pub fn channel(instrument: Instrument, number: usize) -> Option<Self> {
        let name = CHANNELS.get(number.checked_sub(1)?)?;
        Some(Self {
            unit: "V",
            step: 1e-6,
            ..Self::program(instrument, name)
        })
    }

    /// Returns the name under which the history keeps the signal: that of the point, or `INSTRUMENT.PROGRAM`.
    pub fn stored_name(&self, wiring: &Wiring) -> String {
        match self.instrument {
            None => self.name.to_owned(),
            Some(instrument) => format!("{}.{}", wiring.instrument(instrument).name, self.name),
        }
    }

    /// Returns the signal of an output (0 off, 1 on) or of a word of inputs, one bit each.
    pub const fn bits(name: &'static str) -> Self {
        Self {
            name,
            instrument: None,
            unit: "",
            step: 1.0,
            changes_only: true,
        }
    }
}

/// One sample of one signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TraceSample {
    /// The signal.
    pub signal: Signal,
    /// Time of the request of a sample or count; of an output, a word or a program that of the answer.
    pub at: RigTime,
    /// Value in the unit of the signal; NaN where the converter gave none (over range).
    pub value: f64,
}

/// All samples of a test, in order of arrival.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    samples: Vec<TraceSample>,
    /// Number of samples that come from waveforms.
    of_waves: usize,
}

impl Trace {
    /// Returns the samples in order of arrival.
    pub fn samples(&self) -> &[TraceSample] {
        &self.samples
    }

    /// Appends the trace of the next stage.
    pub fn append(&mut self, other: Self) {
        for sample in other.samples {
            match CHANNELS.contains(&sample.signal.name) {
                true => self.add_of_wave(sample),
                false => self.add(sample.signal, sample.at, sample.value),
            }
        }
    }

    /// Records the voltages that a job commanded to sources; `at` is the time at which the module answered.
    pub(super) fn commanded(&mut self, wiring: &Wiring, to: &[(AnalogOutput, Volt)], at: RigTime) {
        for (output, volts) in to {
            let signal = Signal::source(wiring.source_name(*output));
            self.add(signal, at, volts.0);
        }
    }

    /// Adds the switched outputs that the trace keeps.
    pub(super) fn switched(&mut self, wiring: &Wiring, to: &[(DigitalOutput, bool)], at: RigTime) {
        for (output, on) in to {
            let switch = wiring.switch(*output);
            if switch.traced {
                self.add(Signal::bits(switch.name), at, f64::from(u8::from(*on)));
            }
        }
    }

    /// Adds inputs read together: bit n is input n.
    pub(super) fn word(&mut self, name: &'static str, states: &[bool], at: RigTime) {
        let bits = states.iter().rev();
        let word = bits.fold(0_u32, |word, bit| word << 1 | u32::from(*bit));
        self.add(Signal::bits(name), at, f64::from(word));
    }

    /// Adds one analog sample; ignores the blank one of a masked-out channel.
    pub(super) fn input(&mut self, quantity: Quantity, sample: &Sample) {
        if sample.quality == Quality::Blank {
            return;
        }
        let value = sample.good().unwrap_or(f64::NAN);
        self.add(Signal::input(quantity), sample.origin.at, value);
    }

    /// Adds a program's waveform, and its numbers if they are at most [`MAX_NUMBERS`] (a ramp has more).
    pub(super) fn delivered(&mut self, query: &Query, delivered: &Delivered, at: RigTime) {
        let number = query.arguments.iter().find(|(name, _)| *name == "channel");
        let signal = number.and_then(|it| Signal::channel(query.instrument, it.1 as usize));
        if let (Some(wave), Some(signal)) = (&delivered.waveform, signal) {
            self.wave(signal, wave, at);
        }
        if delivered.numbers.len() > MAX_NUMBERS {
            return;
        }
        for number in &delivered.numbers {
            self.add(
                Signal::program(query.instrument, query.program),
                at,
                *number,
            );
        }
    }

    /// Adds a count, unless the trace has it already.
    pub(super) fn count(&mut self, name: &'static str, count: &CountSample) {
        let (signal, at) = (Signal::count(name), count.origin.at);
        let mut before = self.samples.iter().rev();
        let is_known = before.any(|it| it.signal == signal && it.at == at);
        if !is_known {
            self.add(signal, at, f64::from(count.count));
        }
    }

    /// Adds least and greatest value of each piece of a waveform that ends at `end`.
    fn wave(&mut self, signal: Signal, wave: &Waveform, end: RigTime) {
        let count = wave.volts.len();
        let at = |index: usize| {
            let before = Span::seconds((count - index) as f64 * wave.step_s);
            RigTime(end.0.saturating_sub(before.0))
        };
        let long = count.div_ceil(WAVE_PIECES).max(1);
        for (piece, volts) in wave.volts.chunks(long).enumerate() {
            let by_value = |a: &(usize, &f32), b: &(usize, &f32)| a.1.total_cmp(b.1);
            let all = || volts.iter().enumerate();
            let (Some(least), Some(most)) = (all().min_by(by_value), all().max_by(by_value)) else {
                continue;
            };
            let mut both = [least, most];
            both.sort_by_key(|it| it.0);
            for (index, value) in both {
                self.add_of_wave(TraceSample {
                    signal,
                    at: at(piece * long + index),
                    value: f64::from(*value),
                });
            }
        }
    }

    fn add_of_wave(&mut self, sample: TraceSample) {
        if self.of_waves < MAX_WAVE_SAMPLES {
            self.of_waves += 1;
            self.samples.push(sample);
        }
    }

    fn add(&mut self, signal: Signal, at: RigTime, value: f64) {
        if signal.changes_only {
            let samples = self.samples.iter_mut().rev();
            let mut before = samples.filter(|it| it.signal == signal);
            if let (Some(last), Some(earlier)) = (before.next(), before.next())
                && last.value == value
                && earlier.value == value
            {
                last.at = at;
                return;
            }
        }
        if self.samples.len() - self.of_waves < MAX_SAMPLES {
            self.samples.push(TraceSample { signal, at, value });
        }
    }
}

#[cfg(test)]
mod tests;
