//! What the passed parts of a lot have shown about the thresholds: it shortens the search on the next part and enters no
//! result.

use super::parameter::Parameter;
use super::search::{Direction, Expected};
use crate::dut::TestRecord;

/// Number of parts from which on a search starts from their thresholds.
const ENOUGH: u32 = 5;
/// Reach of the search in standard deviations between parts: one part in twenty takes a step more.
const REACH: f64 = 2.0;
/// Least reach, V, for lots whose parts are all alike.
const LEAST_REACH_V: f64 = 0.02;

/// Mean and scatter of a voltage over parts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Spread {
    n: u32,
    mean_v: f64,
    /// Sum of squared deviations from the mean, V².
    squares: f64,
}

impl Spread {
    fn add(&mut self, volts: f64) {
        self.n += 1;
        let before_v = volts - self.mean_v;
        self.mean_v += before_v / f64::from(self.n);
        self.squares += before_v * (volts - self.mean_v);
    }

    /// Returns mean and standard deviation, V; `None` before [`ENOUGH`] parts.
    fn known(&self) -> Option<(f64, f64)> {
        let freedom = f64::from(self.n.max(2) - 1);
        (self.n >= ENOUGH).then(|| (self.mean_v, (self.squares / freedom).sqrt()))
    }
}

/// Thresholds of the passed parts of a lot.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Learned {
    turn_on: Spread,
    /// Turn-on less turn-off voltage, which scatters less than either.
    hysteresis: Spread,
}

impl Learned {
    /// Adds a part, if both its voltages are known.
    pub fn add(&mut self, record: &TestRecord) {
        let volts = |of: Parameter| {
            record
                .result(of)
                .map(|it| it.value)
                .filter(|it| it.is_finite())
        };
        let both = (
            volts(Parameter::TurnOnVoltage),
            volts(Parameter::TurnOffVoltage),
        );
        if let (Some(on_v), Some(off_v)) = both {
            self.turn_on.add(on_v);
            self.hysteresis.add(on_v - off_v);
        }
    }

    /// Returns the threshold to expect; `turn_on_v` is the turn-on voltage of this part, V, once it is known.
    pub fn expected(&self, direction: Direction, turn_on_v: Option<f64>) -> Option<Expected> {
        let (at_v, sd_v) = match direction {
            Direction::Rising => self.turn_on.known()?,
            Direction::Falling => {
                let (mean_v, sd_v) = self.hysteresis.known()?;
                (turn_on_v? - mean_v, sd_v)
            }
        };
        let reach_v = (REACH * sd_v).max(LEAST_REACH_V);
        Some(Expected { at_v, reach_v })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_parts_give_mean_and_scatter() {
        let mut spread = Spread::default();
        for (n, volts) in [2.0, 2.1, 2.2, 2.1, 2.1].into_iter().enumerate() {
            assert_eq!(spread.known(), None, "{n} parts");
            spread.add(volts);
        }
        let known = spread.known();
        let near = |(mean_v, sd_v): (f64, f64)| {
            (mean_v - 2.1).abs() < 1e-12 && (sd_v - 0.005_f64.sqrt()).abs() < 1e-12
        };
        assert!(known.is_some_and(near), "{known:?}");
    }

    #[test]
    fn turn_off_follows_the_turn_on_of_the_part() {
        let mut learned = Learned::default();
        for n in 0..5 {
            learned.turn_on.add(2.0 + 0.1 * f64::from(n));
            learned.hysteresis.add(0.15);
        }
        assert_eq!(learned.expected(Direction::Falling, None), None);
        let expected = learned.expected(Direction::Falling, Some(2.4));
        let near = |it: Expected| (it.at_v - 2.25).abs() < 1e-12 && it.reach_v == LEAST_REACH_V;
        assert!(expected.is_some_and(near), "{expected:?}");
    }
}
