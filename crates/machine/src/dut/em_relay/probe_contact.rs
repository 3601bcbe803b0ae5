//! Contact resistance of the probes at the coil pins, from the voltage drop between supply and pins.
//!
//! The sense wires keep this resistance out of the coil resistance, but thresholds are volts of the supply: each ohm in
//! series raises them in proportion, by 20 mV on 8 V at 400 ohm. It may have changed since the reference parts were
//! measured: a test counts the change as an uncertainty of a threshold and corrects nothing, since its pins may differ
//! from those of earlier parts. The Kelvin bits open only at 5 ohm per pin.
//!
//! The supply is calibrated on the reference resistor, without probes. The difference between command and pin voltage,
//! divided by the current, is the resistance of both force contacts in series.
//!
//! One part gives the resistance with an uncertainty of 0.15 ohm, sixteen parts with 0.04 ohm. Drift of output and
//! input since the calibration adds 0.4 ohm per 0.1 % on a coil of 400 ohm. The figure is a trend that fails no part.
//! The probes of the contacts have no such figure, because no input reads the voltage of their source.

use units::{Ohm, Volt};

/// Number of parts after which the mean counts as a trend; from then on each new part has the weight 1/16.
const TREND_PARTS: u32 = 16;

/// Returns the resistance of both force contacts in series, when at `command` the pins of `coil` have the voltage
/// `at_pins`.
pub fn in_series(command: Volt, at_pins: Volt, coil: Ohm) -> Ohm {
    Ohm(coil.0 * (command.0 / at_pins.0 - 1.0))
}

/// Mean over the parts of a run, weighted towards the latest: sixteen parts later, the weight of a part has fallen to
/// 0.36 of its first value.
#[derive(Debug, Clone, Copy, Default)]
pub struct Trend {
    mean: Option<f64>,
    parts: u32,
}

impl Trend {
    /// Adds the value of a part.
    pub fn add(&mut self, Ohm(ohm): Ohm) {
        self.parts = self.parts.saturating_add(1);
        let mean = self.mean.unwrap_or(ohm);
        self.mean = Some(mean + (ohm - mean) / f64::from(self.parts.min(TREND_PARTS)));
    }

    /// Returns the mean; `None` before the first part.
    pub fn mean(&self) -> Option<Ohm> {
        self.mean.map(Ohm)
    }

    /// Returns the mean once it covers enough parts to raise an alarm on it.
    pub fn settled(&self) -> Option<Ohm> {
        self.mean().filter(|_| self.parts >= TREND_PARTS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_voltage_drop_gives_the_series_resistance() {
        // 2 ohm in series with 400 ohm: the coil gets 400/402 of 5 V.
        let ohm = in_series(Volt(5.0), Volt(5.0 * 400.0 / 402.0), Ohm(400.0));
        assert!((ohm.0 - 2.0).abs() < 1e-12);
        assert_eq!(in_series(Volt(5.0), Volt(5.0), Ohm(60.0)), Ohm(0.0));
    }

    #[test]
    fn the_mean_follows_a_step_over_many_parts() {
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
