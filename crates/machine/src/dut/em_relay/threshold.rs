//! Operate and release voltage from a ramp and a gated counter.
//!
//! The window opens when the supply has moved [`WINDOW`] from its level at the rising edge of ARM (output `arm`), and
//! the latch closes it at the contact event, so the indicated voltage is `start +- (WINDOW + slope x gate)`. A ramp
//! overshoots the quasi-static threshold. Reference parts give the overshoot of the fine ramp; it also contains the
//! tolerance of [`WINDOW`], the error of the level, the contact of the probes and the mean heating of the coil. The
//! operate current does not depend on temperature, so the voltage scales like the coil resistance (IEC 61810-7).

use super::calibration::Overshoot;
use super::coil::{relative_per_kelvin, to_reference};
use crate::gauge::budget::{Budget, Reading, resolution};
use crate::gauge::{Deviation, Factor};
use units::{Celsius, Second, Unit, Volt};

/// Movement of the supply that opens the window of a ramp.
pub const WINDOW: Volt = Volt(0.050);

/// Direction of the supply on a ramp.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Towards operate.
    Rising,
    /// Towards release.
    Falling,
}

impl Direction {
    /// Returns +1 for rising, -1 for falling.
    pub fn sign(self) -> f64 {
        match self {
            Direction::Rising => 1.0,
            Direction::Falling => -1.0,
        }
    }
}

/// Returns the supply voltage at the contact event of a ramp that began at `start`.
pub fn indicated(
    (start, window): (Volt, Volt),
    slope_v_per_s: f64,
    gate: Second,
    direction: Direction,
) -> Volt {
    start + (window + Volt(slope_v_per_s * gate.0)) * direction.sign()
}

/// Uncertainty terms of a threshold, except that of the overshoot found on reference parts.
#[derive(Debug, Clone, Copy)]
pub struct RampUncertainty {
    /// Slope of the ramp, volts per second.
    pub slope_v_per_s: Factor,
    /// True when the overshoot already contains the error of the slope.
    pub slope_known: bool,
    /// Scatter of the part's own threshold from operation to operation, volts.
    pub operation_v: f64,
    /// Refresh interval of the output on a ramp.
    pub refresh: Second,
    /// Relative standard uncertainty of the gain of the level at which the ramp starts.
    pub level_share: f64,
    /// Change of the series resistance of the coil's force contacts since the measurement of the reference parts, as a
    /// share of the coil resistance.
    pub contact_share: f64,
    /// Uncertainty of the part's temperature, kelvin.
    pub temperature_k: Deviation,
}

/// Returns the quasi-static threshold at the reference temperature from one fine ramp, which overshoots by `own` volts
/// more on this part than on the reference parts.
pub fn quasi_static(
    (seen, own): (Volt, Factor),
    gate: Second,
    overshoot: Overshoot,
    part: Celsius,
    reference: Celsius,
    uncertainty: RampUncertainty,
) -> Reading {
    let at_part = seen.0 - overshoot.fine_v.value - own.value;
    let value = at_part * to_reference(part, reference);
    let budget = Budget::default()
        .with("reference parts", overshoot.fine_v.u)
        .with("overshoot of the part", own.u)
        .with_random("repeatability", uncertainty.operation_v)
        .with(
            "slope",
            if uncertainty.slope_known {
                0.0
            } else {
                uncertainty.slope_v_per_s.u * gate.0
            },
        )
        .with_random(
            "resolution",
            resolution(uncertainty.slope_v_per_s.value * uncertainty.refresh.0),
        )
        .with(
            "level",
            (at_part - overshoot.at_v) * uncertainty.level_share,
        )
        .with("probe contact", value * uncertainty.contact_share)
        .with_estimated(
            "coil temperature",
            uncertainty
                .temperature_k
                .times(value * relative_per_kelvin(part)),
        );
    Reading {
        value,
        unit: Unit::Volt,
        budget,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::em_relay::overshoot::OvershootModel;

    #[test]
    fn a_ramp_indicates_start_plus_window_plus_slope() {
        let seen = indicated((Volt(7.8), WINDOW), 1.5, Second(0.04), Direction::Rising);
        assert!((seen.0 - 7.91).abs() < 1e-12);
        let seen = indicated((Volt(2.5), WINDOW), 1.5, Second(0.04), Direction::Falling);
        assert!((seen.0 - 2.39).abs() < 1e-12);
    }

    /// U / 2 of an operate voltage of 7.88 V with these two uncertainty terms alone.
    fn half_u(contact: f64, temperature_k: f64) -> f64 {
        let overshoot = Overshoot {
            fine_v: Factor::new(0.0, 0.0),
            at_v: 7.88,
            at_coarse_v: 0.85,
            coarse: OvershootModel::guess(0.85, 1.0),
            judges: false,
        };
        let uncertainty = RampUncertainty {
            slope_v_per_s: Factor::new(1.5, 0.0),
            slope_known: false,
            operation_v: 0.0,
            refresh: Second(0.0),
            level_share: 0.0,
            contact_share: contact,
            temperature_k: Deviation::known(temperature_k),
        };
        let reading = quasi_static(
            (Volt(7.88), Factor::new(0.0, 0.0)),
            Second(0.04),
            overshoot,
            Celsius(23.0),
            Celsius(23.0),
            uncertainty,
        );
        reading.budget.combined()
    }

    #[test]
    fn one_kelvin_is_30_millivolts_of_operate_voltage() {
        assert!((half_u(0.0, 1.0) - 0.0306).abs() < 1e-4);
    }

    #[test]
    fn one_ohm_at_the_probes_is_20_millivolts() {
        assert!((half_u(1.0 / 400.0, 0.0) - 0.0197).abs() < 1e-4);
    }
}
