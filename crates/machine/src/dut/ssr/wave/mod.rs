//! Waveforms of AC parts: pure arithmetic on the records of the digitizer.
//!
//! | question | file |
//! |---|---|
//! | samples of a channel with their times | here |
//! | sums of squares | [`least_squares`] |
//! | the sine of the mains with its frequency and harmonics | [`mains`] |
//! | how an output has answered a control pulse | [`pulses`] |
//! | the instant at which the voltage jumps from the mains to the drop | [`turn`] |
//! | resistive and capacitive part of a current | [`split`] |
//! | drop against current | [`drop_line`] |
//! | distortion of the voltage at a conducting output | [`distortion`] |
//! | drop while a current warms the part | [`warming`] |
//! | the level of a staircase at which the output turns on or off | [`staircase`] |

pub mod distortion;
pub mod drop_line;
pub mod least_squares;
pub mod mains;
pub mod pulses;
pub mod split;
pub mod staircase;
pub mod turn;
pub mod warming;

use crate::instrument::query::Waveform;

/// Returns the samples of a record from a time on.
pub fn tail(waveform: &Waveform, from_s: f64) -> Waveform {
    let first = ((from_s - waveform.start_s) / waveform.step_s)
        .ceil()
        .max(0.0);
    let first = (first as usize).min(waveform.volts.len());
    Waveform {
        start_s: waveform.start_s + first as f64 * waveform.step_s,
        step_s: waveform.step_s,
        volts: waveform.volts[first..].to_vec(),
    }
}

/// Returns the standard uncertainty that jumps give the mean of samples: a jump may lie anywhere between its two
/// samples.
///
/// From sample to sample, the excess of a step over the mean of the two steps beside it is a jump. A jump also appears,
/// with half of its size, in the excess of either step beside it; the sum of squares allows for that.
pub fn jumps_u(samples: &[f64]) -> f64 {
    const OF_ALL: f64 = 12.0 * (1.0 + 0.25 + 0.25);
    let steps: Vec<f64> = samples.windows(2).map(|it| it[1] - it[0]).collect();
    let jumps = steps
        .windows(3)
        .map(|it| it[1] - f64::midpoint(it[0], it[2]));
    let squares: f64 = jumps.map(|it| it * it).sum();
    (squares / OF_ALL).sqrt() / samples.len().max(1) as f64
}

/// One channel of a record, borrowed: samples at equal intervals, each multiplied by a factor, minus an offset.
#[derive(Debug, Clone, Copy)]
pub struct Channel<'a> {
    samples: &'a [f32],
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Interval between two samples, s.
    pub step_s: f64,
    factor: f64,
    offset: f64,
}

impl<'a> Channel<'a> {
    /// Returns a channel whose values are `factor` times the sampled voltages minus `offset`; `None` when a sample is
    /// not finite or the interval is not above 0.
    pub fn of(waveform: &'a Waveform, factor: f64, offset: f64) -> Option<Self> {
        let is_usable = waveform.step_s > 0.0 && waveform.volts.iter().all(|it| it.is_finite());
        is_usable.then_some(Self {
            samples: &waveform.volts,
            start_s: waveform.start_s,
            step_s: waveform.step_s,
            factor,
            offset,
        })
    }

    /// Returns the channel with `by` subtracted from every value.
    pub fn less(self, by: f64) -> Self {
        Self {
            offset: self.offset + by,
            ..self
        }
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Returns true without samples.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Returns the value of a sample.
    pub fn at(&self, index: usize) -> f64 {
        f64::from(self.samples[index]) * self.factor - self.offset
    }

    /// Returns the time of a sample, s.
    pub fn time(&self, index: usize) -> f64 {
        self.start_s + index as f64 * self.step_s
    }

    /// Returns the number of the first sample at or after a time; at most the number of samples.
    pub fn index(&self, time_s: f64) -> usize {
        let at = ((time_s - self.start_s) / self.step_s).ceil();
        (at.max(0.0) as usize).min(self.samples.len())
    }

    /// Returns true when the other channel has samples at the same times.
    pub fn is_beside(&self, other: &Channel) -> bool {
        self.samples.len() == other.samples.len()
            && self.step_s == other.step_s
            && self.start_s == other.start_s
    }

    /// Returns true when a sample lies at least this far from 0.
    pub fn reaches(&self, value: f64) -> bool {
        (0..self.len()).any(|it| self.at(it).abs() >= value)
    }

    /// Returns the greatest value in the direction of a sign, 1 or -1; at least 0.
    pub fn peak(&self, sign: f64) -> f64 {
        (0..self.len()).fold(0.0, |most, it| f64::max(most, sign * self.at(it)))
    }

    /// Yields time and value of every `stride`th sample from `from` to before `to`.
    pub fn pairs(
        &self,
        from: usize,
        to: usize,
        stride: usize,
    ) -> impl Iterator<Item = (f64, f64)> + Clone + use<'a> {
        let own = *self;
        let to = to.min(own.len());
        (from..to)
            .step_by(stride.max(1))
            .map(move |it| (own.time(it), own.at(it)))
    }
}
