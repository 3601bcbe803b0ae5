//! Scales the voltages of the procedure to the coil and to the range of the supply.
//!
//! The constants of this kind are those of a 12 V coil in the range of factor 1. Voltages of the relay (thresholds,
//! their scatter) scale with the nominal voltage. Voltages of the supply (the window of the board, the distance of a
//! ramp in a given time) scale with the factor of the range.

use crate::dut::accuracy::AccuracySettings;
use units::Volt;

/// Nominal coil voltage for which the constants are stated, V.
const STATED_FOR_V: f64 = 12.0;

/// Factors of a coil and of a supply range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    coil: f64,
    range: f64,
}

impl Scale {
    /// Makes the scale for a coil of this nominal voltage in a supply range of this factor.
    pub fn new(nominal_v: f64, factor: f64) -> Self {
        Self {
            coil: nominal_v / STATED_FOR_V,
            range: factor,
        }
    }

    /// Scales a voltage of the relay, stated for a 12 V coil, to this coil.
    pub fn of_coil(self, of_12_v: Volt) -> Volt {
        of_12_v * self.coil
    }

    /// Returns the scatter of a threshold of this coil from operation to operation, volts (1 sd). It is proportional to
    /// the nominal voltage, because an armature responds to current.
    pub fn operation_v(self, accuracy: &AccuracySettings) -> f64 {
        self.of_coil(Volt(accuracy.operation_scatter_mv / 1e3)).0
    }

    /// Scales a voltage of the supply, stated for the range of factor 1, to this range.
    pub fn of_range(self, at_factor_1: Volt) -> Volt {
        at_factor_1 * self.range
    }

    /// Returns the factor of the range.
    pub fn range(self) -> f64 {
        self.range
    }

    /// Returns the nominal coil voltage as a multiple of 12 V.
    pub fn coil(self) -> f64 {
        self.coil
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::em_relay::tests::context;

    #[test]
    fn operation_scatter_is_proportional_to_nominal_voltage() {
        let accuracy = context().accuracy;
        let volts = [24.0, 12.0, 6.0].map(|it| Scale::new(it, 1.0).operation_v(&accuracy));
        assert_eq!(volts, [0.004, 0.002, 0.001]);
    }

    #[test]
    fn a_coil_and_its_range_scale_apart() {
        let scale = Scale::new(3.0, 0.5);
        assert_eq!(scale.of_coil(Volt(0.060)), Volt(0.015));
        assert_eq!(scale.of_range(Volt(0.050)), Volt(0.025));
    }
}
