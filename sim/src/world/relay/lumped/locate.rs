//! Instant at which a mode changes within a step.
//!
//! Newton's method on the length of the step: every trial repeats the step from its start, so its state has the full
//! order of the method. The first trial is the root of a polynomial through value, slope and curvature of the gap
//! function at both ends of the step; it usually misses by less than [`NEAR_S`], and the last part is a straight line.

use super::coil::Drive;
use super::model::Model;
use super::modes::Element;
use super::solver::Solver;
use super::{State, V, W};

/// Distance from the instant of a change over which a motion is straight, s: a force changes it by less than 1e-14 m.
const NEAR_S: f64 = 1e-9;
/// Time over which a difference quotient gives the rate of the current, s.
const QUOTIENT_S: f64 = 1e-8;

/// Value, slope and curvature of a function, over a step of length 1.
type Jet = [f64; 3];

impl Solver {
    /// Returns the step length, at most `h`, at which the gap function of the element is zero, and the state there. The
    /// gap function must have changed its sign by `h`, where the state is `end`.
    pub(super) fn locate(
        &mut self,
        model: &Model,
        drive: &Drive,
        slope: &State,
        element: Element,
        (h, end): (f64, State),
    ) -> (f64, State) {
        let side = if self.modes.is_engaged(element) {
            1.0
        } else {
            -1.0
        };
        let jet = |s: &State, rates: &State, h: f64| {
            let [value, slope, curvature] = jet(model, drive, element, s, rates);
            [side * value, side * slope * h, side * curvature * h * h]
        };
        let last = self.rates_at(model, drive, self.t_s + h, &end);
        let [from, to] = [jet(&self.state, slope, h), jet(&end, &last, h)];
        let mut at = h * first_root(from, to);
        let (mut low, mut high, mut best) = (0.0, h, (h, end));
        while high - low > exact(self.t_s) {
            let mut there = self.attempt(model, drive, slope, at).state;
            let rates = self.rates_at(model, drive, self.t_s + at, &there);
            let [value, falls, _] = jet(&there, &rates, 1.0);
            best = (at, there);
            let next = at - value / falls;
            if falls < 0.0 && (next - at).abs() < NEAR_S && next > 0.0 && next <= h {
                for (state, rate) in there.iter_mut().zip(&rates) {
                    *state += (next - at) * rate;
                }
                return (next, there);
            }
            if value > 0.0 {
                low = at;
            } else {
                high = at;
            }
            at = match falls < 0.0 && next > low && next < high {
                true => next,
                false => 0.5 * (low + high),
            };
        }
        best
    }
}

/// Returns the gap function of an element, its rate and the rate of that; for the suppression the last one is 0.
fn jet(model: &Model, drive: &Drive, element: Element, s: &State, rates: &State) -> Jet {
    let value = model.gap(element, s, drive);
    let rate = |s: &State| model.stops.rate(element, s);
    match element {
        Element::CoilBlocked => {
            let later = std::array::from_fn(|i| s[i] + QUOTIENT_S * rates[i]);
            let then = model.gap(element, &later, drive);
            [value, (then - value) / QUOTIENT_S, 0.0]
        }
        Element::Backstop | Element::Seat | Element::Nc | Element::No => {
            let mut speeds = *s;
            (speeds[V], speeds[W]) = (rates[V], rates[W]);
            [value, rate(s), rate(&speeds)]
        }
    }
}

/// Returns the accuracy to which an instant is located, s.
fn exact(t_s: f64) -> f64 {
    1e-15 + 4.0 * f64::EPSILON * t_s
}

/// Returns the root between 0 and 1 of the polynomial of degree 5 through these values, slopes and curvatures; the
/// value is positive at 0 and not at 1.
fn first_root(from: Jet, to: Jet) -> f64 {
    let [a, b, c] = [from[0].max(0.0), from[1], 0.5 * from[2]];
    let [value, slope, curvature] = [to[0] - a - b - c, to[1] - b - 2.0 * c, to[2] - 2.0 * c];
    let d = 10.0 * value - 4.0 * slope + 0.5 * curvature;
    let e = -15.0 * value + 7.0 * slope - curvature;
    let f = 6.0 * value - 3.0 * slope + 0.5 * curvature;
    let (mut low, mut high) = (0.0, 1.0);
    let mut at = 0.5;
    while high - low > 1e-9 {
        let value = a + at * (b + at * (c + at * (d + at * (e + at * f))));
        let rate = b + at * (2.0 * c + at * (3.0 * d + at * (4.0 * e + at * 5.0 * f)));
        if value > 0.0 {
            low = at;
        } else {
            high = at;
        }
        let newton = at - value / rate;
        let next = match newton > low && newton < high {
            true => newton,
            false => 0.5 * (low + high),
        };
        if (next - at).abs() < 1e-9 {
            return next;
        }
        at = next;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_trial_is_the_root_of_a_quintic() {
        let quintic = |t: f64| {
            let (value, slope) = (1.0 - 2.5 * t.powi(5) + t, 1.0 - 12.5 * t.powi(4));
            [value, slope, -50.0 * t.powi(3)]
        };
        let root = first_root(quintic(0.0), quintic(1.0));
        assert!(quintic(root)[0].abs() < 1e-9, "{root}");
    }
}
