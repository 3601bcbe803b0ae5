//! Turn-on voltage of a DC part by ramp, by search, and by a single step that tests conformity.

use super::{Dice, normal, row, uniform};
use crate::figure::{Bar, Figure, percent};
use machine::dut::ssr::search::{Direction, Expected, Search};

/// Knee of the LED, V: above it the light grows in proportion to the voltage.
const KNEE_V: f64 = 1.1;
/// Lowest and highest voltage of searches and ramps, V.
const LIMITS_V: (f64, f64) = (1.0, 3.5);
/// Time of the commands and readings of a search step that returns to 0 V first, s.
const STEP_S: f64 = 0.018;
/// The same for a step without a return to 0 V, s.
const BRIEF_S: f64 = 0.014;
/// Time of the commands and the transfer of a recorded ramp, s.
const SWEEP_S: f64 = 0.09;
/// Shortest time of a level of a recorded ramp, s.
const LEVEL_S: f64 = 0.3e-3;
/// Length of the record, divided by that of the ramp.
const RECORD: f64 = 1.5;
/// Longest time constant that a recipe promises, s.
const LONGEST_S: f64 = 0.5e-3;
/// Time step of the model of a ramp, s.
const MODEL_S: f64 = 5e-6;
/// Error of the source in a conformity test, V, half width.
const SOURCE_V: f64 = 2.7e-3;
/// Guard band of a conformity test, V.
const GUARD_V: f64 = 3.6e-3;

/// A part: its turn-on voltage, V, and the time constant of its output, s.
struct Part {
    on_v: f64,
    tau_s: f64,
}

impl Part {
    fn drawn(dice: &mut Dice) -> Self {
        Self {
            on_v: normal(dice, 2.1, 0.06),
            tau_s: uniform(dice, 0.1e-3, LONGEST_S),
        }
    }

    /// Returns the light of the LED at a voltage, divided by the light at which the output conducts.
    fn light(&self, volts: f64) -> f64 {
        (volts - KNEE_V).max(0.0) / (self.on_v - KNEE_V)
    }

    /// Returns true when the output conducts at the end of a dwell of `dwell_s`, before which the LED was dark.
    fn conducts(&self, volts: f64, dwell_s: f64) -> bool {
        let light = self.light(volts);
        light > 1.0 && -self.tau_s * (1.0 - 1.0 / light).ln() <= dwell_s
    }
}

/// Returns the rows of every method.
pub fn methods(parts: u64) -> Vec<Figure> {
    let ramps = [5.0, 20.0, 100.0].map(|rate| ramp(parts, rate));
    let widths = [5.0, 10.0, 20.0, 40.0, 80.0];
    let plain = widths.map(|mv| bisect(parts, mv, false));
    let expected = widths.map(|mv| bisect(parts, mv, true));
    let swept = [10.0, 25.0, 50.0].map(|mv| swept(parts, mv));
    let all = ramps.into_iter().chain(swept).chain(plain).chain(expected);
    all.chain([conformity(parts)]).collect()
}

/// Returns the error of a ramp that ends when the output conducts, with its seconds.
fn ramp(parts: u64, rate: f64) -> Figure {
    let mut dice = Dice::new(1);
    let (mut errors, mut seconds) = (Vec::new(), 0.0);
    for _ in 0..parts {
        let part = Part::drawn(&mut dice);
        let (mut level, mut at_s) = (0.0, 0.0);
        while level < 1.0 && at_s * rate < LIMITS_V.1 {
            at_s += MODEL_S;
            let light = part.light(LIMITS_V.0 + rate * at_s);
            level = light + (level - light) * (-MODEL_S / part.tau_s).exp();
        }
        errors.push(1e3 * (LIMITS_V.0 + rate * at_s - part.on_v));
        seconds += at_s;
    }
    row(
        format!("ramp, {rate} V/s"),
        &errors,
        "mV",
        seconds / parts as f64,
    )
}

/// Returns the error of the controller's ramp at a resolution of `width_mv`, with its seconds. The ramp has four levels
/// within the resolution. Its value is the level at which the output conducts, less half a step and half of the
/// greatest lag.
fn swept(parts: u64, width_mv: f64) -> Figure {
    let mut dice = Dice::new(1);
    let (mut errors, mut seconds) = (Vec::new(), 0.0);
    let level_s = (LONGEST_S / 2.0).max(LEVEL_S);
    let step_v = width_mv / 4e3;
    let lag_v = step_v / level_s * LONGEST_S;
    let count = ((LIMITS_V.1 - LIMITS_V.0) / step_v).ceil();
    for _ in 0..parts {
        let part = Part::drawn(&mut dice);
        let (mut level, mut number) = (0.0, 0.0);
        while level < 1.0 && number < count {
            let light = part.light(LIMITS_V.0 + step_v * number);
            level = light + (level - light) * (-level_s / part.tau_s).exp();
            number += 1.0;
        }
        let found_v = LIMITS_V.0 + step_v * (number - 1.0);
        errors.push(1e3 * (found_v - (step_v + lag_v) / 2.0 - part.on_v));
        seconds += SWEEP_S + RECORD * count * level_s;
    }
    row(
        format!("recorded ramp, {width_mv} mV"),
        &errors,
        "mV",
        seconds / parts as f64,
    )
}

/// Returns the error of the controller's search, which ends when its interval is `width_mv` wide; with `is_expected`
/// the search starts from the thresholds of earlier parts.
fn bisect(parts: u64, width_mv: f64, is_expected: bool) -> Figure {
    let mut dice = Dice::new(1);
    let (mut errors, mut seconds) = (Vec::new(), 0.0);
    let width_v = width_mv / 1e3;
    let dwell_s = LONGEST_S * (LIMITS_V.1 / (width_v / 8.0)).ln();
    let expected = is_expected.then_some(Expected {
        at_v: 2.1,
        reach_v: 0.12,
    });
    for _ in 0..parts {
        let part = Part::drawn(&mut dice);
        let mut search = Search::between(LIMITS_V.0, LIMITS_V.1, expected);
        while search.width_v() > width_v {
            let commands_s = match search.is_ready(Direction::Rising) {
                true => BRIEF_S,
                false => STEP_S,
            };
            seconds += dwell_s + commands_s;
            search.narrow(part.conducts(search.next_v(), dwell_s));
        }
        errors.push(1e3 * (search.middle_v() - part.on_v));
    }
    let from = if is_expected { ", expected" } else { "" };
    let figure = row(
        format!("bisect to {width_mv} mV{from}"),
        &errors,
        "mV",
        seconds / parts as f64,
    );
    match width_mv == 20.0 {
        true => figure.bar(Bar::AtMost(10.0)),
        false => figure,
    }
}

/// Returns which share of the parts beyond the limit a conformity test accepts, percent. The test is one step to a
/// guard band below the limit. The thresholds lie within 20 mV of the limit.
fn conformity(parts: u64) -> Figure {
    let mut dice = Dice::new(1);
    let (mut beyond, mut accepted) = (0, 0);
    let dwell_s = 10.0 * LONGEST_S;
    for _ in 0..parts {
        let part = Part {
            on_v: LIMITS_V.1 + uniform(&mut dice, -0.02, 0.02),
            tau_s: uniform(&mut dice, 0.1e-3, LONGEST_S),
        };
        let applied_v = LIMITS_V.1 - GUARD_V + uniform(&mut dice, -SOURCE_V, SOURCE_V);
        let is_beyond = part.on_v > LIMITS_V.1;
        beyond += u64::from(is_beyond);
        accepted += u64::from(is_beyond && part.conducts(applied_v, dwell_s));
    }
    Figure::new(
        "conformity, wrongly accepted",
        beyond,
        percent(accepted, beyond),
        "%",
    )
    .with("seconds", Some(dwell_s + STEP_S))
    .bar(Bar::AtMost(0.0))
}
