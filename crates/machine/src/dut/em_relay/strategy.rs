//! Strategies for a threshold, named per parameter in the recipe.
//!
//! | strategy | acts | gives |
//! |---|---|---|
//! | `pulse` | one step to the limit less the guard band | a proof of the limit; without it ramps measure the threshold |
//! | `staircase` | steps of 20 mV with a dwell, until the contact changes | a value from levels alone: slow, and decisive in a dispute |
//! | `bisection` | seven trials, each of which starts anew and halves the interval | a value to a hundredth of the interval |
//! | `ramp` | the coarse ramp with the gated counter; the overshoot follows from other results of the part ([`super::overshoot`]) | a value with the scatter of the coarse overshoot |
//! | `two_rates` | coarse and fine ramp, by the law below | a value; only L comes from reference parts |
//! | `coarse_fine` | a coarse ramp that places a fine one | a value with the scatter of the fine overshoot |
//! | `adaptive` | the coarse ramp; the fine one when the limit lies within the uncertainty | the decision of the fine ramp at the speed of the coarse one |
//!
//! A rising ramp indicates `V + r (a - L ln r)` for a threshold V, a rate r, the growth time L of the unstable
//! armature and a delay a. The law is not linear in r: a linear extrapolation of two rates errs by `r L ln 2`.

use serde::{Deserialize, Serialize};

/// Strategy for a threshold, as in the table above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Strategy {
    /// One step to the limit less the guard band.
    Pulse,
    /// Steps of 20 mV with a dwell, until the contact changes.
    Staircase,
    /// Trials, each of which starts anew and halves the interval.
    Bisection,
    /// The coarse ramp alone.
    Ramp,
    /// Coarse and fine ramp, extrapolated.
    TwoRates,
    /// A coarse ramp that places a fine one.
    #[default]
    CoarseFine,
    /// The coarse ramp, and the fine one near a limit.
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
    /// Names in recipes, in the order of [`Self::ALL`].
    pub const NAMES: [&'static str; 7] = [
        "pulse",
        "ramp",
        "adaptive",
        "coarse_fine",
        "two_rates",
        "bisection",
        "staircase",
    ];

    /// Returns the name in recipes.
    pub fn name(self) -> &'static str {
        Self::NAMES[Self::ALL.iter().position(|it| *it == self).unwrap_or(0)]
    }

    /// Returns true when the strategy begins with the coarse ramp; the others search by levels.
    pub fn ramps(self) -> bool {
        match self {
            Self::Pulse | Self::Staircase | Self::Bisection => false,
            Self::Ramp | Self::TwoRates | Self::CoarseFine | Self::Adaptive => true,
        }
    }

    /// Returns true when every part gets the fine ramp.
    pub fn always_fine(self) -> bool {
        match self {
            Self::TwoRates | Self::CoarseFine => true,
            Self::Pulse | Self::Staircase | Self::Bisection | Self::Ramp | Self::Adaptive => false,
        }
    }

    /// Returns true when the value of the coarse ramp may be the result.
    pub fn trusts_coarse(self) -> bool {
        match self {
            Self::Ramp | Self::Adaptive => true,
            Self::Pulse | Self::Staircase | Self::Bisection | Self::TwoRates | Self::CoarseFine => {
                false
            }
        }
    }
}

/// Returns the threshold from two rising ramps (or, with both signs reversed, two falling ones) by the law `seen = V +
/// r (a - L ln r)`, from which it eliminates `a`. `rates` are in volts per second, `growth_s` is L in seconds.
pub fn from_two_rates(seen_v: [f64; 2], rates: [f64; 2], growth_s: f64) -> f64 {
    let straight = |seen: f64, rate: f64| seen + rate * growth_s * rate.ln();
    let (one, two) = (straight(seen_v[0], rates[0]), straight(seen_v[1], rates[1]));
    (rates[0] * two - rates[1] * one) / (rates[0] - rates[1])
}

/// Returns the growth time L in seconds from the overshoots at two rates on parts of known threshold, both above zero.
pub fn growth_s(overshoots_v: [f64; 2], rates: [f64; 2]) -> f64 {
    let each = |place: usize| overshoots_v[place] / rates[place];
    (each(1) - each(0)) / (rates[0].ln() - rates[1].ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Indication of a ramp by the law at 7.88 V: delay 8 ms, growth time 2.483 ms.
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
    fn two_overshoots_give_the_growth_time() {
        let rates = [96.0, 1.5];
        let growth = growth_s(rates.map(|rate| seen(rate) - 7.88), rates);
        assert!((growth - 0.002_483).abs() < 1e-12);
    }

    #[test]
    fn linear_extrapolation_leaves_the_logarithmic_term() {
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
