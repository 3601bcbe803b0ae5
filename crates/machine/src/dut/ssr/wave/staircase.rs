//! Finds the level of a staircase of the control voltage at which the output of an AC part turns on or off.
//!
//! The record holds control and output from the step to the first level on. The voltage before that step and the first
//! level show the scale of the control channel, so that the record itself names the level at each instant: no clock of the
//! source enters the result.

use super::Channel;
use super::turn::run_from;
use crate::dut::ssr::search::Direction;

/// Time for which the output must show its new state without a break, s: much longer than the mains stays below the drop
/// of a conducting output at a zero.
const TURNED_S: f64 = 1e-3;
/// Time after the step in which the control stays at its first level, s.
const FIRST_S: f64 = 5e-3;
/// Samples beside an edge of the control that do not count.
const BESIDE: usize = 2;
/// Samples whose mean is the control voltage at an instant.
const MEAN: usize = 5;
/// Greatest error of the scale of the control channel, as a share.
const NEAR: f64 = 0.1;

/// Levels of a staircase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Voltage before the first level, V.
    pub before_v: f64,
    /// First level, V.
    pub first_v: f64,
    /// From a level to the next, V; negative on the way down.
    pub step_v: f64,
    /// Number of levels, at least 1.
    pub count: usize,
}

impl Levels {
    /// Returns a level by its number from 0 on, V.
    pub fn at(&self, number: usize) -> f64 {
        self.first_v + self.step_v * number as f64
    }

    /// Returns the last level, V.
    pub fn last_v(&self) -> f64 {
        self.at(self.count - 1)
    }

    /// Returns the direction of the steps.
    pub fn direction(&self) -> Direction {
        match self.step_v > 0.0 {
            true => Direction::Rising,
            false => Direction::Falling,
        }
    }

    /// Returns the number of the level nearest to a voltage.
    fn nearest(&self, volts: f64) -> usize {
        let number = ((volts - self.first_v) / self.step_v).round().max(0.0);
        (number as usize).min(self.count - 1)
    }
}

/// Levels between which an output has turned on or off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// Last level without effect; `None` when the first one had an effect.
    pub without_v: Option<f64>,
    /// First level with effect; `None` when the record shows none.
    pub with_v: Option<f64>,
}

/// Returns the levels between which the output begins to conduct (on the way up) or to block (on the way down); `on_v` is
/// the largest voltage of a conducting output, V. `None` when the record does not show the levels.
pub fn turned(control: &Channel, output: &Channel, levels: &Levels, on_v: f64) -> Option<Turned> {
    let scale = Scale::of(control, levels)?;
    let turns = |it: usize| match levels.direction() {
        Direction::Rising => output.at(it).abs() <= on_v,
        Direction::Falling => output.at(it).abs() > on_v,
    };
    let samples = (TURNED_S / output.step_s).ceil() as usize;
    let last = output.len().min(control.len());
    let turn = run_from(turns, (scale.begin, last), samples);
    let level = |it: usize| Some(levels.nearest(scale.volts(control, it)?));
    // A record that ends before the staircase has shown the levels before its last one to the end.
    let seen = level(turn.unwrap_or(last.saturating_sub(MEAN)))?;
    Some(Turned {
        without_v: seen.checked_sub(1).map(|it| levels.at(it)),
        with_v: turn.map(|_| levels.at(seen)),
    })
}

/// Scale of the control channel.
struct Scale {
    /// Sample at which the first level begins.
    begin: usize,
    /// Reading and voltage of the first level.
    first: (f64, f64),
    /// Volts per reading.
    factor: f64,
}

impl Scale {
    fn of(control: &Channel, levels: &Levels) -> Option<Self> {
        let begin = control.index(0.0);
        let before = mean(control, (0, begin.saturating_sub(BESIDE)))?;
        let first = mean(control, (begin + BESIDE, control.index(FIRST_S)))?;
        let factor = (levels.first_v - levels.before_v) / (first - before);
        ((factor - 1.0).abs() < NEAR).then_some(Self {
            begin,
            first: (first, levels.first_v),
            factor,
        })
    }

    /// Returns the control voltage from a sample on, V.
    fn volts(&self, control: &Channel, from: usize) -> Option<f64> {
        let reading = mean(control, (from, from + MEAN))?;
        Some(self.first.1 + self.factor * (reading - self.first.0))
    }
}

fn mean(channel: &Channel, (from, to): (usize, usize)) -> Option<f64> {
    let to = to.min(channel.len());
    let sum: f64 = (from..to).map(|it| channel.at(it)).sum();
    (to > from).then(|| sum / (to - from) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::query::Waveform;
    use std::f64::consts::TAU;

    const STEP_S: f64 = 5e-5;
    const RISING: Levels = Levels {
        before_v: 0.0,
        first_v: 2.0,
        step_v: 0.025,
        count: 16,
    };
    const FALLING: Levels = Levels {
        before_v: 5.0,
        first_v: 2.3,
        step_v: -0.025,
        count: 16,
    };

    /// Control and output of a part with these thresholds, each level `dwell_s` long, on a channel with an error of gain
    /// and offset.
    fn record(levels: &Levels, [on_v, off_v]: [f64; 2], dwell_s: f64) -> [Waveform; 2] {
        let mut volts = [Vec::new(), Vec::new()];
        let (mut conducts, mut was_v) = (false, 0.0_f64);
        for index in -600..4400 {
            let at_s = f64::from(index) * STEP_S;
            let number = (at_s / dwell_s).floor();
            let control_v = match number < 0.0 {
                true => levels.before_v,
                false => levels.at((number as usize).min(levels.count - 1)),
            };
            let line_v = 325.0 * (TAU * 50.0 * at_s + 0.7).sin();
            if line_v.signum() != was_v.signum() {
                conducts = control_v >= if conducts { off_v } else { on_v };
            }
            was_v = line_v;
            let output_v = if conducts { line_v.signum() } else { line_v };
            if index >= -80 {
                volts[0].push((1.02 * control_v + 0.1) as f32);
                volts[1].push(output_v.clamp(-10.0, 10.0) as f32);
            }
        }
        volts.map(|volts| Waveform {
            start_s: -80.0 * STEP_S,
            step_s: STEP_S,
            volts,
        })
    }

    fn found(levels: &Levels, thresholds: [f64; 2], dwell_s: f64) -> Option<Turned> {
        let records = record(levels, thresholds, dwell_s);
        let [control, output] = records.each_ref().map(|it| Channel::of(it, 1.0, 0.0));
        turned(&control?, &output?, levels, 3.0)
    }

    #[test]
    fn the_threshold_lies_between_the_levels_found() {
        for dwell_s in [0.0107, 0.0113, 0.013] {
            for thresholds in [[2.031, 2.011], [2.1, 2.06], [2.24, 2.2]] {
                for (levels, threshold_v) in [(RISING, thresholds[0]), (FALLING, thresholds[1])] {
                    let found = found(&levels, thresholds, dwell_s).expect("a record");
                    let [without_v, with_v] = [found.without_v, found.with_v].map(Option::unwrap);
                    let (low_v, high_v) = (without_v.min(with_v), without_v.max(with_v));
                    let near = low_v - 1e-9..=high_v + 1e-9;
                    assert!(near.contains(&threshold_v), "{threshold_v} V: {found:?}");
                    assert!((high_v - low_v - 0.025).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_threshold_beside_the_staircase_bounds_one_side() {
        let below = found(&RISING, [1.9, 1.7], 0.011).expect("a record");
        assert_eq!((below.without_v, below.with_v), (None, Some(2.0)));
        let above = found(&RISING, [2.9, 2.7], 0.011).expect("a record");
        assert_eq!((above.without_v, above.with_v), (Some(RISING.at(14)), None));
    }

    #[test]
    fn a_record_without_the_levels_is_refused() {
        let other = Levels {
            first_v: 3.0,
            ..RISING
        };
        let records = record(&RISING, [2.1, 2.0], 0.011);
        let [control, output] = records.each_ref().map(|it| Channel::of(it, 1.0, 0.0));
        let (control, output) = (control.expect("samples"), output.expect("samples"));
        assert_eq!(turned(&control, &output, &other, 3.0), None);
    }
}
