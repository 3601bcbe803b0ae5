//! Split range: one signed power becomes the duty of the heater or the opening of the vent.
//!
//! Heat reaches the air through the heater, which has a lag; the vent changes the air at once. A loop that is tuned on
//! the heater would oscillate on the vent. [`VentLag`] gives the vent a lag too, so that one tuning fits both.

use super::Observed;
use crate::tune::Identified;

/// Least excess of the chamber over ambient at which the vent opens, K.
const LEAST_EXCESS_K: f64 = 1.0;

/// Lag of the vent, as a share of the time constant of the response to the heater; the lag of the heater is about the
/// same.
const VENT_LAG: f64 = 0.4;
/// Greatest power by which the vent lags behind, 1 = full heater: the vent answers an upset, such as an open door, at
/// once.
const MOST_BEHIND: f64 = 0.1;

/// Outputs of one second.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Duty of the heater, 0 to 1.
    pub heater: f64,
    /// Opening of the vent, 0 to 1.
    pub vent: f64,
}

impl Command {
    /// No heat, vent closed.
    pub const OFF: Self = Self {
        heater: 0.0,
        vent: 0.0,
    };
}

/// Converts a signed power into heater and vent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplitRange {
    /// Power that the fully open vent removes per kelvin above ambient, 1/K.
    vent_per_k: f64,
    /// Lag of the vent behind a small change of its power, s.
    lag_s: f64,
}

impl SplitRange {
    /// Makes the conversion for the vent of an identified chamber.
    pub fn of(chamber: &Identified) -> Self {
        Self {
            vent_per_k: chamber.vent_per_k,
            lag_s: VENT_LAG * chamber.time_constant_s.max(0.0),
        }
    }

    fn open_vent(self, seen: &Observed) -> f64 {
        self.vent_per_k * (seen.measured_c - seen.ambient_c).max(0.0)
    }

    /// Returns the lowest power, that of the fully open vent, at most 0; near ambient 0.
    pub fn lowest(self, seen: &Observed) -> f64 {
        if seen.measured_c - seen.ambient_c < LEAST_EXCESS_K {
            0.0
        } else {
            -self.open_vent(seen)
        }
    }

    /// Returns the outputs for a power, 1 = full heater; never heater and vent together.
    pub fn command(self, power: f64, seen: &Observed) -> Command {
        let lowest = self.lowest(seen);
        let vent = if lowest < 0.0 {
            power.min(0.0) / lowest
        } else {
            0.0
        };
        Command {
            heater: power.clamp(0.0, 1.0),
            vent: vent.clamp(0.0, 1.0),
        }
    }
}

/// State of the vent's lag: the power of the vent follows the one that the loop demands; stepped once a second.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VentLag {
    power: f64,
}

impl VentLag {
    /// Takes the power of this second, 1 = full heater, and returns the outputs: heat at once, the vent with its lag.
    pub fn step(&mut self, split: SplitRange, power: f64, seen: &Observed) -> Command {
        let wanted = power.min(0.0);
        self.power += (wanted - self.power) / (split.lag_s + 1.0);
        self.power = self
            .power
            .clamp(wanted - MOST_BEHIND, wanted + MOST_BEHIND)
            .min(0.0);
        Command {
            heater: split.command(power, seen).heater,
            vent: split.command(self.power, seen).vent,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPLIT: SplitRange = SplitRange {
        vent_per_k: 0.008,
        lag_s: 20.0,
    };

    fn at(measured_c: f64) -> Observed {
        Observed {
            measured_c,
            ambient_c: 25.0,
        }
    }

    #[test]
    fn heater_and_vent_share_the_range() {
        assert_eq!(
            SPLIT.command(0.3, &at(75.0)),
            Command {
                heater: 0.3,
                vent: 0.0
            }
        );
        assert_eq!(
            SPLIT.command(-0.1, &at(75.0)),
            Command {
                heater: 0.0,
                vent: 0.25
            }
        );
        assert_eq!(SPLIT.command(-9.0, &at(75.0)).vent, 1.0);
    }

    #[test]
    fn the_vent_follows_small_changes_with_a_lag() {
        let mut lag = VentLag::default();
        let openings: Vec<f64> = (0..200)
            .map(|_| lag.step(SPLIT, -0.1, &at(75.0)).vent)
            .collect();
        assert!((openings[20] / 0.25 - (1.0 - (-1.0_f64).exp())).abs() < 0.03);
        assert!((openings[199] - 0.25).abs() < 0.001 && openings.is_sorted());
        assert!(lag.step(SPLIT, 0.1, &at(75.0)).vent > 0.2);
    }

    #[test]
    fn the_vent_follows_an_upset_at_once() {
        let opened = VentLag::default().step(SPLIT, -0.4, &at(75.0)).vent;
        assert!(opened > 0.6, "{opened}");
    }

    #[test]
    fn the_vent_stays_shut_near_ambient() {
        assert_eq!(SPLIT.lowest(&at(25.5)), 0.0);
        assert_eq!(SPLIT.command(-0.1, &at(25.5)), Command::OFF);
    }
}
