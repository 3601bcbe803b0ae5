//! Finds the instants within a segment at which an output fires or goes off.

use super::segment::{OnState, Segment, State};

/// Interval of the search for firing, microseconds: shorter than the time for which the line stays in the narrowest
/// firing window. [`ZERO_US`] is the interval of the search for a current zero.
const FIRING_US: f64 = 10.0;
const ZERO_US: f64 = 100.0;
/// Accuracy of an instant, microseconds.
const EXACT_US: f64 = 1e-3;
/// Least returning voltage at a current zero that can fire the output again, volts.
const COMMUTATION_V: f64 = 50.0;

/// Voltages at which an output fires, in the positive and in the negative direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    /// By direction: least and greatest voltage over the output at which it fires, volts; `None` where it never fires.
    pub window: [Option<(f64, f64)>; 2],
}

impl Gate {
    /// A gate that never fires.
    pub const SHUT: Self = Self { window: [None; 2] };

    /// Returns the direction in which the output fires at a voltage, 1 or -1; `None` when it does not fire.
    pub fn fires(&self, volts: f64) -> Option<f64> {
        let (sign, window) = match volts < 0.0 {
            false => (1.0, self.window[0]),
            true => (-1.0, self.window[1]),
        };
        let (least_v, most_v) = window?;
        let size_v = volts.abs();
        (least_v <= size_v && size_v <= most_v).then_some(sign)
    }
}

/// Returns the first instant within `span` at which a blocked output fires.
pub fn firing_us(segment: &Segment, gate: &Gate, span: (f64, f64)) -> Option<f64> {
    if *gate == Gate::SHUT {
        return None;
    }
    let fires = |t_us: f64| gate.fires(segment.at(t_us).volts).is_some();
    first(span, FIRING_US, fires)
}

/// Returns the first instant within `span` at which the current of a conducting output falls below the holding current.
/// A current that has yet to exceed it does not count.
pub fn extinction_us(
    segment: &Segment,
    on: OnState,
    holding_a: f64,
    span: (f64, f64),
) -> Option<f64> {
    let holds = |t_us: f64| on.sign * segment.at(t_us).amps >= holding_a;
    let risen_us = first(span, ZERO_US, holds)?;
    first((risen_us, span.1), ZERO_US, |t_us| !holds(t_us))
}

/// Returns the first instant within `span` at which the current of a conducting output has the other sign.
pub fn reversal_us(segment: &Segment, on: OnState, span: (f64, f64)) -> Option<f64> {
    first(span, ZERO_US, |t_us| on.sign * segment.at(t_us).amps < 0.0)
}

/// Checks whether the voltage that returns at a current zero rises too fast for the output to block. An inductive load
/// makes it swing up with the capacitance over the output; over a resistive load it returns as slowly as the line. A
/// voltage up to [`COMMUTATION_V`] never rises too fast.
pub fn fails_to_commutate(line_v: f64, henries: f64, farads: f64, limit_v_per_us: f64) -> bool {
    let swing_us = 1e6 * (henries * farads).sqrt();
    line_v.abs() > COMMUTATION_V && line_v.abs() > limit_v_per_us * swing_us
}

/// Returns the first instant at which a condition holds, to [`EXACT_US`]; looks once in each interval.
fn first((from_us, to_us): (f64, f64), each_us: f64, holds: impl Fn(f64) -> bool) -> Option<f64> {
    if holds(from_us) {
        return Some(from_us);
    }
    let (mut before_us, mut at_us) = (from_us, from_us);
    while at_us < to_us {
        at_us = (at_us + each_us).min(to_us);
        if holds(at_us) {
            return Some(bisected(before_us, at_us, holds));
        }
        before_us = at_us;
    }
    None
}

fn bisected(mut before_us: f64, mut after_us: f64, holds: impl Fn(f64) -> bool) -> f64 {
    while after_us - before_us > EXACT_US {
        let middle_us = 0.5 * (before_us + after_us);
        match holds(middle_us) {
            true => after_us = middle_us,
            false => before_us = middle_us,
        }
    }
    after_us
}

/// Returns the mean of a function of voltage and current over an interval, by Simpson's rule.
pub fn mean(segment: &Segment, (from_us, to_us): (f64, f64), of: impl Fn(State) -> f64) -> f64 {
    let at = |n: f64| of(segment.at(from_us + n / 8.0 * (to_us - from_us)));
    let odd: f64 = [1.0, 3.0, 5.0, 7.0].map(&at).iter().sum();
    let even: f64 = [2.0, 4.0, 6.0].map(&at).iter().sum();
    (at(0.0) + 4.0 * odd + 2.0 * even + at(8.0)) / 24.0
}
