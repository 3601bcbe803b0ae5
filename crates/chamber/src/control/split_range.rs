//! Split range: one signed power becomes the duty of the heater or the opening of the vent.

use super::Observed;
use crate::tune::Identified;

/// Least excess of the chamber over ambient at which the vent opens, K.
const LEAST_EXCESS_K: f64 = 1.0;

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
}

impl SplitRange {
    /// Makes the conversion for the vent of an identified chamber.
    pub fn of(chamber: &Identified) -> Self {
        Self {
            vent_per_k: chamber.vent_per_k,
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

#[cfg(test)]
mod tests {
    use super::*;

    const SPLIT: SplitRange = SplitRange { vent_per_k: 0.008 };

    fn at(measured_c: f64) -> Observed {
        Observed {
            measured_c,
            ambient_c: 25.0,
            door_open: false,
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
    fn the_vent_stays_shut_near_ambient() {
        assert_eq!(SPLIT.lowest(&at(25.5)), 0.0);
        assert_eq!(SPLIT.command(-0.1, &at(25.5)), Command::OFF);
    }
}
