//! Turn-on and turn-off voltage of a DC part by one ramp each, as GJB 1515 describes it: the part conducts once at its
//! nominal voltage, then the source sweeps the control from the one limit towards the other, in levels a quarter of the
//! resolution apart.
//!
//! The digitizer records control and output from the step to the first level on. The record itself shows the level at
//! which the output switches: the voltages before the first level and at the last one give the scale of the channel, so
//! that no clock of the source enters the result. The output follows a ramp late by its time constant, of which only
//! the longest value is known: the result allows for half of that, and the budget for the rest.

use super::conformity::{OFF, ON};
use super::given::{Given, NotDelivered};
use super::state::{Next, State};
use super::threshold::interval;
use crate::dut::ssr::accuracy;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{CurrentRange, LOAD_V, PERIOD_S, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::{BEFORE, CONTROL_CHANNEL, OUTPUT_CHANNEL};
use crate::dut::ssr::search::{Direction, Search};
use crate::instrument::act::Act;
use crate::instrument::query::Waveform;
use units::{Span, Unit};

/// Averaging time of the current at a level, periods of the mains: the shortest; its value does not matter.
const BRIEF: f64 = 0.01;
/// Levels within the resolution.
const LEVELS: f64 = 4.0;
/// Least time at a level besides its reading, s.
const LEAST_S: f64 = 1e-4;
/// Resolution of levels, V: the text of a level holds no further digit.
const ROUND_V: f64 = 1e-4;
/// Length of the record, divided by the time that delays and readings of the sweep take: commands take time too.
const ROOM: f64 = 1.5;
/// Longest time from the command of a sweep to its first level, plus that from the end of the record until the
/// digitizer has stored it.
const STARTED: Span = Span::ms(30);
/// Number of samples on either side of the trigger that do not count.
const BESIDE: usize = 2;
/// Number of samples in a row that must show a switched output.
const SWITCHED: usize = 4;
/// Number of the first of these samples, whose mean shows the level.
const SHOW: usize = 2;
/// Greatest error of the scale of the control channel, as a share.
const NEAR: f64 = 0.1;

/// Levels of a ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Voltage before the first level, V.
    pub before_v: f64,
    /// First level, V.
    pub first_v: f64,
    /// From a level to the next, V; negative on the way down.
    pub step_v: f64,
    /// Number of levels, at least 2.
    pub count: usize,
    /// Time at a level besides its reading, s.
    pub dwell_s: f64,
}

impl Ramp {
    fn of(search: &Search, direction: Direction, plan: &Plan) -> Self {
        let step_v = (plan.resolution_v / LEVELS / ROUND_V).round().max(1.0) * ROUND_V;
        let round = |volts: f64| (volts / ROUND_V).round() * ROUND_V;
        let steps = (search.width_v() / step_v).ceil().max(1.0);
        let (before_v, first_v, step_v) = match direction {
            Direction::Rising => (0.0, round(search.low_v), step_v),
            Direction::Falling => (plan.control_v, round(search.high_v), -step_v),
        };
        let reading_s = BRIEF * PERIOD_S;
        Self {
            before_v,
            first_v,
            step_v,
            count: steps as usize + 1,
            dwell_s: (2.0 * plan.time_constant_s / LEVELS - reading_s).max(LEAST_S),
        }
    }

    /// Returns the last level, V.
    pub fn last_v(&self) -> f64 {
        self.first_v + self.step_v * (self.count - 1) as f64
    }

    /// Returns the time of a level at least, s.
    fn level_s(&self) -> f64 {
        self.dwell_s + BRIEF * PERIOD_S
    }

    fn record_s(&self) -> f64 {
        ROOM * self.level_s() * self.count as f64 / (1.0 - BEFORE)
    }

    /// Returns the greatest change of the control voltage within the time constant of an output, V.
    fn lag_v(&self, plan: &Plan) -> f64 {
        self.step_v.abs() / self.level_s() * plan.time_constant_s
    }

    /// Returns the level at which the record shows the output switching, V; `None` when it shows no switching or not
    /// the levels of the ramp.
    fn level_v(&self, direction: Direction, [control, output]: [&Waveform; 2]) -> Option<f64> {
        let trigger = (-control.start_s / control.step_s).ceil().max(0.0) as usize;
        let has_switched = |it: usize| {
            let load = 1.0 - f64::from(output.volts[it]) / LOAD_V;
            match direction {
                Direction::Rising => load >= ON,
                Direction::Falling => load <= OFF,
            }
        };
        let last = output
            .volts
            .len()
            .min(control.volts.len())
            .checked_sub(SWITCHED)?;
        let all = |from: usize| (from..from + SWITCHED).all(has_switched);
        let switched = (trigger + BESIDE..last).find(|it| all(*it))?;
        let before = mean(control, 0, trigger.checked_sub(BESIDE)?)?;
        let end = mean(control, last - last / 20, last)?;
        let factor = (self.last_v() - self.before_v) / (end - before);
        let reading = mean(control, switched, switched + SHOW)?;
        let volts = self.last_v() + factor * (reading - end);
        let number = ((volts - self.first_v) / self.step_v).round();
        let number = number.clamp(0.0, (self.count - 1) as f64);
        ((factor - 1.0).abs() < NEAR).then_some(self.first_v + self.step_v * number)
    }
}

fn mean(waveform: &Waveform, from: usize, to: usize) -> Option<f64> {
    let samples = waveform.volts.get(from..to)?;
    let sum: f64 = samples.iter().map(|it| f64::from(*it)).sum();
    let mean = sum / samples.len() as f64;
    mean.is_finite().then_some(mean)
}

/// Returns the acts of a ramp; none when no interval is proven to hold the threshold.
pub fn acts(state: &mut State, direction: Direction, plan: &Plan, points: &Points) -> Vec<Act> {
    let Some(search) = interval(state, direction, plan) else {
        return Vec::new();
    };
    state.search = Some(search);
    let ramp = Ramp::of(&search, direction, plan);
    let brief = CurrentRange {
        periods: BRIEF,
        ..plan.input
    };
    let mut acts = match direction {
        Direction::Rising => vec![
            Act::Query(vec![points.step(Device::SmuIn, plan.control_v, 0.0)]),
            Act::Wait(Span::seconds(plan.off_s)),
        ],
        Direction::Falling => Vec::new(),
    };
    let record_s = ramp.record_s();
    acts.extend([
        Act::Query(vec![
            points.source(Device::SmuIn, ramp.before_v, &brief),
            points.capture_sweep(plan, (ramp.before_v, ramp.first_v), record_s),
        ]),
        // The output settles, and the digitizer needs the part of its record before the trigger.
        Act::Wait(Span::seconds(plan.on_s.max(2.0 * BEFORE * record_s))),
        Act::Mark,
        Act::Query(vec![points.sweep(&ramp)]),
        Act::WaitSinceMark(Span::seconds(record_s) + STARTED),
        Act::Query(vec![
            points.complete(),
            points.swept(CONTROL_CHANNEL),
            points.swept(OUTPUT_CHANNEL),
        ]),
    ]);
    acts
}

/// Concludes a ramp.
pub fn conclude(
    state: &mut State,
    direction: Direction,
    plan: &Plan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let Some(search) = state.search.take() else {
        return Ok(Next::Planned);
    };
    let [control, output] = given.waveforms()?;
    let ramp = Ramp::of(&search, direction, plan);
    let level_v = ramp.level_v(direction, [&control, &output]);
    let level_v = level_v.ok_or(NotDelivered(Device::Digitizer))?;
    let (of, sign) = match direction {
        Direction::Rising => {
            state.turn_on_v = Some(level_v);
            (Parameter::TurnOnVoltage, 1.0)
        }
        Direction::Falling => (Parameter::TurnOffVoltage, -1.0),
    };
    let (step_v, lag_v) = (ramp.step_v.abs(), ramp.lag_v(plan));
    let volts = level_v - sign * (step_v + lag_v) / 2.0;
    let budget = accuracy::ramp(plan, volts, step_v, lag_v);
    state.found([(of, volts, Unit::Volt, budget)]);
    Ok(Next::Planned)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const UP: Ramp = Ramp {
        before_v: 0.0,
        first_v: 1.0,
        step_v: 0.01,
        count: 251,
        dwell_s: 2e-4,
    };
    const DOWN: Ramp = Ramp {
        before_v: 5.0,
        first_v: 2.5,
        step_v: -0.01,
        count: 151,
        ..UP
    };
    /// Time of a level, s.
    const LEVEL_S: f64 = 4.6e-4;
    /// Interval between two samples, s.
    const STEP_S: f64 = 2e-5;

    /// Control, on a channel with an error of gain and offset, and output of a part that switches at a voltage.
    fn record(ramp: &Ramp, threshold_v: f64) -> [Waveform; 2] {
        let level = |at_s: f64| match at_s < 0.0 {
            true => ramp.before_v,
            false => {
                let number = ((at_s / LEVEL_S) as usize).min(ramp.count - 1);
                ramp.first_v + ramp.step_v * number as f64
            }
        };
        let times = (-1_000..10_000).map(|it| f64::from(it) * STEP_S);
        let controls: Vec<f64> = times.map(level).collect();
        let output = |volts: &f64| if *volts >= threshold_v { 0.02 } else { 8.0 };
        let volts = [
            controls.iter().map(|it| (1.02 * it + 0.1) as f32).collect(),
            controls.iter().map(output).collect(),
        ];
        volts.map(|volts| Waveform {
            start_s: -1_000.0 * STEP_S,
            step_s: STEP_S,
            volts,
        })
    }

    fn found(ramp: &Ramp, direction: Direction, threshold_v: f64) -> Option<f64> {
        let [control, output] = record(ramp, threshold_v);
        ramp.level_v(direction, [&control, &output])
    }

    #[test]
    fn a_record_shows_the_level_that_switches() {
        for threshold_v in [1.203, 1.997, 2.401] {
            let up_v = found(&UP, Direction::Rising, threshold_v).unwrap();
            assert!((-1e-9..0.011).contains(&(up_v - threshold_v)), "{up_v}");
            let down_v = found(&DOWN, Direction::Falling, threshold_v).unwrap();
            assert!((-1e-9..0.011).contains(&(threshold_v - down_v)), "{down_v}");
        }
    }

    #[test]
    fn an_output_that_never_switches_gives_no_level() {
        assert_eq!(found(&UP, Direction::Rising, 9.0), None);
        assert_eq!(found(&DOWN, Direction::Falling, 0.5), None);
    }

    #[test]
    fn a_record_without_the_last_level_is_refused() {
        let longer = Ramp { count: 900, ..UP };
        let [control, output] = record(&longer, 1.5);
        let other = Ramp { count: 300, ..UP };
        assert_eq!(other.level_v(Direction::Rising, [&control, &output]), None);
    }
}
