//! Edges of the control pulse and of the output in a record of the digitizer.
//!
//! The output voltage is that of the source while the output blocks and near zero while it conducts, so the voltage of
//! the load is the source less the output. Both levels come from the record itself: the gain and the offset of the
//! digitizer change them as they change the crossing, and cancel.

use crate::gauge::budget::resolution;
use crate::instrument::query::Waveform;
use std::ops::Range;
use std::sync::Arc;

/// Share of the load voltage at which the output counts as on.
const ON: f64 = 0.9;
/// Share at which it counts as off.
const OFF: f64 = 0.1;
/// Least share of a step that one interval of samples must hold so that the step counts as a jump within it.
const JUMP: f64 = 0.5;
/// Least height of the pulse, and of the voltage of the load before it, in standard deviations of the noise before it.
const DISTINCT: f64 = 8.0;
/// Least number of codes of a converter of 8 bits between the levels of a signal.
const FEWEST_CODES: f64 = 100.0;
/// Number of samples on either side of an edge that give its slope.
const AROUND: usize = 2;
/// Least number of samples before, during and after the pulse.
const FEWEST: usize = 8;

/// A crossing of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Time relative to the trigger, s.
    pub at_s: f64,
    /// Standard uncertainty by the noise at the slope of the edge, s.
    pub u_s: f64,
    /// Number of the first sample behind the crossing.
    index: usize,
}

/// Edges of one control pulse and of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edges {
    /// Interval between two samples, s.
    pub step_s: f64,
    /// Rise of the control to half of its height.
    pub rise: Crossing,
    /// Fall of the control to half of its height.
    pub fall: Crossing,
    /// Rise of the load to 90 % of its voltage; `None` when the load does not reach it before the pulse ends.
    pub on: Option<Crossing>,
    /// Fall of the load to 10 % of its voltage; `None` when the load does not reach it before the end of the record, or
    /// was never on.
    pub off: Option<Crossing>,
}

/// Returns the edges of a pulse in the records of control and output; none for another number of records.
pub fn pulse(records: &[Arc<Waveform>]) -> Option<Edges> {
    match records {
        [control, output] => edges(control, output),
        _other => None,
    }
}

/// Returns the edges of a pulse; none when the record holds no whole pulse, no voltage of the load before it, or a number
/// that is not finite.
pub fn edges(control: &Waveform, output: &Waveform) -> Option<Edges> {
    let (input, load) = (Signal::of(control)?, Signal::of(output)?);
    let alike = control.volts.len() == output.volts.len()
        && control.step_s == output.step_s
        && control.start_s == output.start_s;
    if !alike {
        return None;
    }
    let count = input.volts.len();
    let low_v = median(&input.volts[..count / 20]);
    let noise_v = input.noise_v(0..count / 20);
    let high_v = sorted(&input.volts)[count - 1 - count / 50];
    if high_v - low_v < DISTINCT * noise_v {
        return None;
    }
    let half_v = f64::midpoint(low_v, high_v);
    let step = Step {
        height_v: high_v - low_v,
        noise_v,
    };
    let rise = input.crossing(1..count, half_v, Toward::Up, step)?;
    let fall = input.crossing(rise.index + 1..count, half_v, Toward::Down, step)?;
    let during = rise.index..fall.index;
    if rise.index < FEWEST || during.len() < FEWEST || count - fall.index < FEWEST {
        return None;
    }
    let before = 0..rise.index.saturating_sub(AROUND);
    let source_v = median(&load.volts[before.clone()]);
    let noise_v = load.noise_v(before);
    if source_v < DISTINCT * noise_v {
        return None;
    }
    let last = fall.index - (during.len() / 10).max(AROUND)..fall.index - 1;
    let final_v = source_v - median(&load.volts[last]);
    let (mut on, mut off) = (None, None);
    let step = Step {
        height_v: final_v,
        noise_v,
    };
    if final_v > source_v / 2.0 {
        let level_v = source_v - ON * final_v;
        on = load.crossing(rise.index..fall.index, level_v, Toward::Down, step);
        let level_v = source_v - OFF * final_v;
        off = load.crossing(fall.index..count, level_v, Toward::Up, step);
    }
    Some(Edges {
        step_s: control.step_s,
        rise,
        fall,
        on,
        off,
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Toward {
    Up,
    Down,
}

/// Height of a step, and the noise of its levels.
#[derive(Debug, Clone, Copy)]
struct Step {
    height_v: f64,
    noise_v: f64,
}

/// Samples of one channel in volts.
struct Signal {
    volts: Vec<f64>,
    start_s: f64,
    step_s: f64,
}

impl Signal {
    fn of(waveform: &Waveform) -> Option<Self> {
        let volts: Vec<f64> = waveform.volts.iter().map(|it| f64::from(*it)).collect();
        let usable = volts.iter().all(|it| it.is_finite()) && volts.len() >= 20 * FEWEST;
        usable.then_some(Self {
            volts,
            start_s: waveform.start_s,
            step_s: waveform.step_s,
        })
    }

    /// Returns the standard deviation of samples of a level, V; at least that of rounding to the steps of the
    /// converter.
    fn noise_v(&self, range: Range<usize>) -> f64 {
        let level = &self.volts[range];
        let mean = level.iter().sum::<f64>() / level.len() as f64;
        let squares: f64 = level.iter().map(|it| (it - mean).powi(2)).sum();
        let deviation = (squares / level.len() as f64).sqrt();
        deviation.max(resolution(self.quantum_v()))
    }

    /// Returns the smallest difference of two samples, V: a step of the converter; at most that of a converter of 8
    /// bits.
    fn quantum_v(&self) -> f64 {
        let values = sorted(&self.volts);
        let span_v = values[values.len() - 1] - values[0];
        let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
        // Two values that differ by rounding alone are one.
        let least = 1e-5 * span_v;
        let quantum = steps.filter(|it| *it > least);
        quantum.fold(span_v / FEWEST_CODES, f64::min)
    }

    /// Returns the first crossing of a level among the samples `within`. Two samples in a row must be beyond the level,
    /// so that a stray sample makes no crossing. Between both samples the crossing lies on a straight line. When one
    /// interval holds most of the step, the samples do not show the instant of the jump; then the crossing is the
    /// middle of that interval.
    fn crossing(
        &self,
        within: Range<usize>,
        level_v: f64,
        toward: Toward,
        step: Step,
    ) -> Option<Crossing> {
        let beyond = |index: usize| match toward {
            Toward::Up => self.volts[index] >= level_v,
            Toward::Down => self.volts[index] <= level_v,
        };
        let last = within.end.min(self.volts.len()).checked_sub(1)?;
        let index = (within.start.max(1)..last).find(|it| beyond(*it) && beyond(it + 1))?;
        let (before_v, at_v) = (self.volts[index - 1], self.volts[index]);
        let part = match (at_v - before_v).abs() > JUMP * step.height_v.abs() {
            true => 0.5,
            false => ((level_v - before_v) / (at_v - before_v)).clamp(0.0, 1.0),
        };
        let part = if part.is_finite() { part } else { 1.0 };
        let (first, behind) = (
            index.saturating_sub(1 + AROUND),
            (index + AROUND).min(self.volts.len() - 1),
        );
        let rise_v = (self.volts[behind] - self.volts[first]).abs();
        let took_s = (behind - first) as f64 * self.step_s;
        Some(Crossing {
            at_s: self.start_s + (index as f64 - 1.0 + part) * self.step_s,
            u_s: (step.noise_v * took_s / rise_v).min(took_s),
            index,
        })
    }
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut all = values.to_vec();
    all.sort_by(f64::total_cmp);
    all
}

fn median(values: &[f64]) -> f64 {
    let all = sorted(values);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests;
