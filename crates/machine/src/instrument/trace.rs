//! The trace of a test, sample by sample: the evidence kept for a rejected part.
//!
//! The trace holds analog samples and counts as read, numbers of instruments, the values commanded to sources and to
//! the traced outputs of a kind, and words of inputs. A bit signal has one sample at each change and one at the last
//! poll before it, so that polling for many milliseconds takes two samples. A test stores its first [`MAX_SAMPLES`]
//! samples; a test of the default recipe has some 150.
//!
//! Of each quantity that a waveform shows, the trace keeps the least and the greatest value in each of [`WAVE_PIECES`]
//! pieces, rounded to a fiftieth of their difference; of the samples that near to either, it keeps the two next to each
//! other, so that an edge stays sharp. A test stores at most [`MAX_WAVE_SAMPLES`] of them in addition to the others. A
//! record of the digitizer ends when the program that reads it ends. Begin and end of each record are samples too, named
//! by the stage, with the time since the trigger as value; the instants of results are marks.

use super::query::{Delivered, Instrument, Query, Shown, Waveform};
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

/// Share of the difference of both extremes of a piece within which values are alike.
const ALIKE: f32 = 0.02;

/// Greatest number of samples of all waveforms of one test, with those of their records and marks.
pub const MAX_WAVE_SAMPLES: usize = 12_000;

/// Origin of the values of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A point of the rig.
    Point,
    /// A program of an instrument.
    Program(Instrument),
    /// A waveform of an instrument.
    Wave(Instrument),
    /// Begin and end of a record of a digitizer; the name is that of the stage.
    Record,
    /// The instant of a result.
    Mark,
}

/// A signal of the trace, as its point declares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// Name of its point, program, quantity, stage or mark.
    pub name: &'static str,
    /// Origin of the values.
    pub source: Source,
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
            source: Source::Point,
            unit: "V",
            step: 1e-5,
            changes_only: false,
        }
    }

    /// Returns the signal of an analog input in its unit, before correction.
    pub const fn input(quantity: Quantity) -> Self {
        Self {
            name: quantity.name,
            source: Source::Point,
            unit: quantity.unit,
            step: quantity.step,
            changes_only: false,
        }
    }

    /// Returns the signal of a gated counter.
    pub const fn count(name: &'static str) -> Self {
        Self {
            name,
            source: Source::Point,
            unit: "",
            step: 1.0,
            changes_only: false,
        }
    }

    /// Returns the signal of the numbers that a program of an instrument delivers.
    pub const fn program(instrument: Instrument, name: &'static str) -> Self {
        Self {
            name,
            source: Source::Program(instrument),
            unit: "",
            step: 1e-12,
            changes_only: false,
        }
    }

    /// Returns the signal of a quantity that a waveform of an instrument shows.
    pub const fn wave(instrument: Instrument, shown: &Shown) -> Self {
        Self {
            name: shown.name,
            source: Source::Wave(instrument),
            unit: shown.unit,
            step: shown.step,
            changes_only: false,
        }
    }

    /// Signal of the records that a stage has read: time since the trigger, s.
    const RECORD: Self = Self {
        name: "unnamed",
        source: Source::Record,
        unit: "s",
        step: 1e-7,
        changes_only: false,
    };

    /// Returns the signal of the instants of a result; each sample is 1.
    const fn mark(name: &'static str) -> Self {
        Self {
            name,
            source: Source::Mark,
            unit: "",
            step: 1.0,
            changes_only: false,
        }
    }

    /// Returns the name under which the history keeps the signal: that of the point, `INSTRUMENT.NAME`, `record.STAGE`
    /// or `mark.NAME`.
    pub fn stored_name(&self, wiring: &Wiring) -> String {
        match self.source {
            Source::Point => self.name.to_owned(),
            Source::Program(instrument) | Source::Wave(instrument) => {
                format!("{}.{}", wiring.instrument(instrument).name, self.name)
            }
            Source::Record => format!("record.{}", self.name),
            Source::Mark => format!("mark.{}", self.name),
        }
    }

    /// Returns the signal of an output (0 off, 1 on) or of a word of inputs, one bit each.
    pub const fn bits(name: &'static str) -> Self {
        Self {
            name,
            source: Source::Point,
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
    /// Samples of waveforms, records and marks among them.
    of_waves: usize,
    /// Trigger of the last record; `None` before the first one.
    trigger: Option<RigTime>,
}

impl Trace {
    /// Returns the samples in order of arrival.
    pub fn samples(&self) -> &[TraceSample] {
        &self.samples
    }

    /// Names the records of the trace by their stage.
    pub fn of_stage(mut self, stage: &'static str) -> Self {
        let records = self.samples.iter_mut();
        let records = records.filter(|it| it.signal.source == Source::Record);
        records.for_each(|it| it.signal.name = stage);
        self
    }

    /// Appends the trace of the next stage.
    pub fn append(&mut self, other: Self) {
        for sample in other.samples {
            match sample.signal.source {
                Source::Wave(_) | Source::Record | Source::Mark => self.add_of_wave(sample),
                Source::Point | Source::Program(_) => {
                    self.add(sample.signal, sample.at, sample.value);
                }
            }
        }
        self.trigger = other.trigger.or(self.trigger);
    }

    /// Marks the instant of a result, in seconds since the trigger of the last record; without a record, does nothing.
    pub fn mark(&mut self, name: &'static str, since_trigger_s: f64) {
        let Some(RigTime(trigger_us)) = self.trigger else {
            return;
        };
        let at_us = trigger_us.saturating_add_signed((since_trigger_s * 1e6).round() as i64);
        self.add_of_wave(TraceSample {
            signal: Signal::mark(name),
            at: RigTime(at_us),
            value: 1.0,
        });
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
        if let (Some(wave), false) = (&delivered.waveform, query.shows.is_empty()) {
            self.record(wave, at);
            for shown in &query.shows {
                self.wave((query.instrument, shown), wave, at);
            }
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

    /// Adds begin and end of the record of a waveform that ends at `end`; channels read together are of one record.
    fn record(&mut self, wave: &Waveform, end: RigTime) {
        let last = wave.volts.len().saturating_sub(1);
        let since_s = |index: usize| wave.start_s + index as f64 * wave.step_s;
        let trigger_us = end
            .0
            .saturating_add_signed((-since_s(last) * 1e6).round() as i64);
        let trigger = Some(RigTime(trigger_us));
        if std::mem::replace(&mut self.trigger, trigger) == trigger {
            return;
        }
        for index in [0, last] {
            self.add_of_wave(TraceSample {
                signal: Signal::RECORD,
                at: time_of(wave, index, end),
                value: since_s(index),
            });
        }
    }

    /// Adds least and greatest value of each piece of a waveform that ends at `end`.
    fn wave(&mut self, (instrument, shown): (Instrument, &Shown), wave: &Waveform, end: RigTime) {
        let signal = Signal::wave(instrument, shown);
        let long = wave.volts.len().div_ceil(WAVE_PIECES).max(1);
        for (piece, volts) in wave.volts.chunks(long).enumerate() {
            for index in extremes(volts) {
                self.add_of_wave(TraceSample {
                    signal,
                    at: time_of(wave, piece * long + index, end),
                    value: shown.offset + shown.factor * f64::from(volts[index]),
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

/// Returns the places of the least and the greatest value, in order of time: of the samples within [`ALIKE`] of either, the
/// two next to each other.
fn extremes(volts: &[f32]) -> [usize; 2] {
    let place = |order: &dyn Fn(&f32, &f32) -> std::cmp::Ordering| {
        let all = volts.iter().enumerate();
        all.min_by(|a, b| order(a.1, b.1)).map_or(0, |it| it.0)
    };
    let (least, most) = (place(&|a, b| a.total_cmp(b)), place(&|a, b| b.total_cmp(a)));
    let (first, last) = (least.min(most), least.max(most));
    let alike = ALIKE * (volts[most] - volts[least]);
    let near = |it: &usize, other: usize| (volts[*it] - volts[other]).abs() <= alike;
    let before = (first..last).rev().find(|it| near(it, first));
    let before = before.unwrap_or(first);
    let after = (before..=last).find(|it| near(it, last)).unwrap_or(last);
    [before, after]
}

/// Returns the time of a sample of a waveform whose last sample is at `end`.
fn time_of(wave: &Waveform, index: usize, end: RigTime) -> RigTime {
    let behind = wave.volts.len().saturating_sub(1 + index);
    let before = Span::seconds(behind as f64 * wave.step_s);
    RigTime(end.0.saturating_sub(before.0))
}

#[cfg(test)]
mod tests;
