//! Contact of the probes at the pins of the coil, from the voltage of its source.
//!
//! The sense wires keep it out of the coil's resistance. Thresholds are told in volts of the supply: each ohm in series lifts
//! them by its share of the coil's, 20 mV of 8 V at 400 ohm. What the trend shows beyond what golden parts have seen is
//! a term of their budgets: it is not taken off, since a part's own pins may be better or worse than those before.
//! Nothing else would tell before the Kelvin bits open at 5 ohm a pin.
//! The supply was calibrated on the reference resistor, on the board and without probes. What the pins get less than
//! it was asked for is lost in the force wires: divided by the current, the resistance of both contacts in series.
//!
//! One part tells it to 0.15 ohm, sixteen to 0.04; what output and input have drifted by since the calibration is in it
//! as well, 0.4 ohm for 0.1 % on a coil of 400 ohm. It is a trend and no result: no part fails by it. The probes of the
//! contacts carry a source whose voltage no input sees.

use units::{Ohm, Volt};

/// One part with a dirty pin is no trend. Of so many each counts alike; from then on the latest weighs as much.
const ENOUGH: u32 = 16;

/// Resistance of both force contacts of a coil of `coil` that sees `at_pins` when the supply is to give `asked`.
pub fn in_series(asked: Volt, at_pins: Volt, coil: Ohm) -> Ohm {
    Ohm(coil.0 * (asked.0 / at_pins.0 - 1.0))
}

/// Mean over the parts of a run, the latest ones before all: a part counts as much as the sixteenth after it counts
/// 0.37.
#[derive(Debug, Clone, Copy, Default)]
pub struct Trend {
    mean: Option<f64>,
    parts: u32,
}

impl Trend {
    /// One part more.
    pub fn add(&mut self, Ohm(ohm): Ohm) {
        self.parts = self.parts.saturating_add(1);
        let mean = self.mean.unwrap_or(ohm);
        self.mean = Some(mean + (ohm - mean) / f64::from(self.parts.min(ENOUGH)));
    }

    /// None before the first part.
    pub fn mean(&self) -> Option<Ohm> {
        self.mean.map(Ohm)
    }

    /// The same once it is one of enough parts for an alarm.
    pub fn settled(&self) -> Option<Ohm> {
        self.mean().filter(|_| self.parts >= ENOUGH)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_pins_get_less_is_lost_in_the_force_wires() {
        // 2 ohm in front of 400: the coil sees 400/402 of 5 V.
        let ohm = in_series(Volt(5.0), Volt(5.0 * 400.0 / 402.0), Ohm(400.0));
        assert!((ohm.0 - 2.0).abs() < 1e-12);
        assert_eq!(in_series(Volt(5.0), Volt(5.0), Ohm(60.0)), Ohm(0.0));
    }

    #[test]
    fn the_mean_follows_a_step_within_some_dozens_of_parts_and_not_one_part() {
        let mut trend = Trend::default();
        assert!(trend.mean().is_none());
        trend.add(Ohm(0.0));
        trend.add(Ohm(8.0));
        assert!(trend.settled().is_none(), "of two parts");
        let after = |trend: &Trend| trend.mean().expect("parts").0;
        assert_eq!(after(&trend), 4.0);
        (0..48).for_each(|_| trend.add(Ohm(4.0)));
        assert!((after(&trend) - 4.0).abs() < 0.2);
        assert_eq!(trend.settled(), trend.mean());
    }
}
