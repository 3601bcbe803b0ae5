//! How a threshold is found: named per parameter in the recipe, from one bit to a millivolt.
//!
//! | strategy | acts | gives |
//! |---|---|---|
//! | `pulse` | one step to the limit less the guard band | one bit: proven, or measured after all |
//! | `staircase` | steps of 20 mV with a dwell, until the contact changes | a value, slowly, from levels alone: the method in dispute |
//! | `bisection` | seven steps into a halved interval, each from rest | a value to a hundredth of the interval |
//! | `ramp` | the coarse ramp with the gated counter; for operate the overshoot follows the part's operate time ([`super::overshoot`]) | a value at the scatter of its overshoot |
//! | `two_rates` | coarse and fine ramp, the overshoot eliminated by its law | a value without reference parts |
//! | `coarse_fine` | a coarse ramp that places a fine one | a value at the scatter of the fine overshoot |
//! | `adaptive` | the coarse ramp; the fine one within the uncertainty of a limit | the decision of the fine one at the pace of the coarse one |
//!
//! A ramp shows `V + r (a - L ln r)`, rising, for a threshold V, a rate r, the growth time L of the unstable
//! armature and a delay a: the law is not linear in r, so that extrapolating two rates linearly leaves
//! `r L ln 2` behind.

use serde::{Deserialize, Serialize};

/// See the table above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Strategy {
    /// One step to the limit less the guard band.
    Pulse,
    /// Steps until the contact changes.
    Staircase,
    /// Steps into a halved interval.
    Bisection,
    /// The coarse ramp alone.
    Ramp,
    /// Coarse and fine ramp, extrapolated.
    TwoRates,
    /// A coarse ramp that places a fine one.
    #[default]
    CoarseFine,
    /// The coarse ramp, and the fine one where it decides.
    Adaptive,
}

impl Strategy {
    /// Every strategy, fastest first.
    pub const ALL: [Self; 7] = [
        Self::Pulse,
        Self::Ramp,
        Self::Adaptive,
        Self::CoarseFine,
        Self::TwoRates,
        Self::Bisection,
        Self::Staircase,
    ];
    /// The names of recipes, in the order of [`Self::ALL`].
    pub const NAMES: [&'static str; 7] = [
        "pulse",
        "ramp",
        "adaptive",
        "coarse_fine",
        "two_rates",
        "bisection",
        "staircase",
    ];

    /// As a recipe names it.
    pub fn name(self) -> &'static str {
        Self::NAMES[Self::ALL.iter().position(|it| *it == self).unwrap_or(0)]
    }

    /// Begins with the coarse ramp; the others search by steps.
    pub fn ramps(self) -> bool {
        match self {
            Self::Pulse | Self::Staircase | Self::Bisection => false,
            Self::Ramp | Self::TwoRates | Self::CoarseFine | Self::Adaptive => true,
        }
    }

    /// Every part gets the fine ramp.
    pub fn always_fine(self) -> bool {
        match self {
            Self::TwoRates | Self::CoarseFine => true,
            Self::Pulse | Self::Staircase | Self::Bisection | Self::Ramp | Self::Adaptive => false,
        }
    }

    /// The value of the coarse ramp is a result.
    pub fn trusts_coarse(self) -> bool {
        match self {
            Self::Ramp | Self::Adaptive => true,
            Self::Pulse | Self::Staircase | Self::Bisection | Self::TwoRates | Self::CoarseFine => {
                false
            }
        }
    }
}

/// Threshold behind two rising ramps (or, with both signs reversed, two falling ones) from the law
/// `seen = V + r (a - L ln r)`: rates in volts per second, `growth_s` is L.
///
/// Two equations, two unknowns: `a` goes out, and nothing is left of it.
pub fn from_two_rates(seen_v: [f64; 2], rates: [f64; 2], growth_s: f64) -> f64 {
    let straight = |seen: f64, rate: f64| seen + rate * growth_s * rate.ln();
    let (one, two) = (straight(seen_v[0], rates[0]), straight(seen_v[1], rates[1]));
    (rates[0] * two - rates[1] * one) / (rates[0] - rates[1])
}

/// Growth time L in seconds from the overshoot of two rates on parts of known threshold; both positive.
pub fn growth_s(overshoots_v: [f64; 2], rates: [f64; 2]) -> f64 {
    let each = |place: usize| overshoots_v[place] / rates[place];
    (each(1) - each(0)) / (rates[0].ln() - rates[1].ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp of the law at 7.88 V: delay 8 ms, growth 2.483 ms.
    fn seen(rate: f64) -> f64 {
        7.88 + rate * (0.008 - 0.002_483 * rate.ln())
    }

    #[test]
    fn two_rates_give_the_threshold_whatever_the_delay() {
        for rates in [[96.0, 1.5], [24.0, 12.0], [2.0, 1.0]] {
            let found = from_two_rates(rates.map(seen), rates, 0.002_483);
            assert!((found - 7.88).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn the_growth_time_comes_out_of_two_lags() {
        let rates = [96.0, 1.5];
        let growth = growth_s(rates.map(|rate| seen(rate) - 7.88), rates);
        assert!((growth - 0.002_483).abs() < 1e-12);
    }

    #[test]
    fn a_straight_line_through_two_rates_leaves_the_logarithm_behind() {
        let straight = 2.0 * seen(12.0) - seen(24.0);
        let left = 24.0 * 0.002_483 * 2f64.ln();
        assert!((straight - 7.88 - left).abs() < 1e-9);
    }

    #[test]
    fn every_strategy_has_a_name_of_its_own() {
        for (strategy, name) in Strategy::ALL.iter().zip(Strategy::NAMES) {
            assert_eq!(strategy.name(), name);
            let json = serde_json::to_string(strategy).expect("a name");
            assert_eq!(json, format!("\"{name}\""));
        }
    }
}
