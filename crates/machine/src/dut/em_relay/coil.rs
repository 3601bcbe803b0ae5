//! Coil resistance as a ratio to the reference resistor, at the reference temperature.
//!
//! One converter reads voltage and current in the same scan, and the calibration reads the reference resistor on the
//! same two channels, so gain errors cancel. The certificates of the reference parts correct the ratio, because they
//! also show the error of the thermometer. Copper: `R(T1) / R(T2) = (234.5 + T1) / (234.5 + T2)`, temperatures in
//! Celsius (IEC 60028 annealed copper).

use crate::gauge::budget::{Budget, Reading};
use crate::gauge::{Deviation, Factor};
use units::{Celsius, Ohm, Unit, Volt};

/// Degrees below zero Celsius at which the extrapolated resistance of annealed copper is 0.
const COPPER_ZERO_C: f64 = 234.5;

/// Uncertainty terms of one scan that do not depend on the part.
#[derive(Debug, Clone, Copy)]
pub struct ScanUncertainty {
    /// Standard uncertainty of one reading at the terminal (noise and resolution), volts.
    pub reading_v: f64,
    /// Standard uncertainty of the offset of the converter, volts.
    pub offset_v: f64,
    /// Uncertainty of the part's temperature, kelvin.
    pub temperature_k: Deviation,
}

/// Returns the factor that converts a resistance or a threshold voltage at temperature `part` to `reference`.
pub fn to_reference(part: Celsius, reference: Celsius) -> f64 {
    (COPPER_ZERO_C + reference.0) / (COPPER_ZERO_C + part.0)
}

/// Returns the relative change of copper resistance per kelvin at `at`.
pub fn relative_per_kelvin(at: Celsius) -> f64 {
    1.0 / (COPPER_ZERO_C + at.0)
}

/// Returns the coil resistance from scans of (voltage, current), both at the terminals and free of offset.
///
/// `None` without a scan, or when the mean current reading is below the uncertainty of one reading.
pub fn resistance(
    scans: &[(Volt, Volt)],
    ohm_per_ratio: Factor,
    part: Celsius,
    reference: Celsius,
    uncertainty: ScanUncertainty,
) -> Option<Reading> {
    let n = scans.len() as f64;
    let volts = scans.iter().map(|scan| scan.0.0).sum::<f64>() / n;
    let current = scans.iter().map(|scan| scan.1.0).sum::<f64>() / n;
    if scans.is_empty() || current.abs() < uncertainty.reading_v {
        return None;
    }
    let at_part = Ohm(ohm_per_ratio.value * volts / current);
    let value = at_part.0 * to_reference(part, reference);
    let relative = |u_v: f64| u_v * (1.0 / (volts * volts) + 1.0 / (current * current)).sqrt();
    let budget = Budget::default()
        .with_random(
            "reading",
            value * relative(uncertainty.reading_v) / n.sqrt(),
        )
        .with(
            "offset",
            value * uncertainty.offset_v * (1.0 / volts - 1.0 / current),
        )
        .with("references", value * ohm_per_ratio.u / ohm_per_ratio.value)
        .with_estimated(
            "coil temperature",
            uncertainty
                .temperature_k
                .times(value * relative_per_kelvin(part)),
        );
    Some(Reading {
        value,
        unit: Unit::Ohm,
        budget,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNCERTAINTY: ScanUncertainty = ScanUncertainty {
        reading_v: 0.003,
        offset_v: 0.0005,
        temperature_k: Deviation {
            value: 0.18,
            freedom: f64::INFINITY,
        },
    };

    #[test]
    fn three_kelvin_change_the_coil_by_1_17_percent() {
        let factor = to_reference(Celsius(23.0), Celsius(20.0));
        assert!((factor - 254.5 / 257.5).abs() < 1e-15);
    }

    #[test]
    fn a_warm_coil_is_reported_at_the_reference_temperature() {
        let reading = resistance(
            &[(Volt(8.0), Volt(7.5))],
            Factor::new(375.0, 0.01),
            Celsius(28.0),
            Celsius(23.0),
            UNCERTAINTY,
        );
        let reading = reading.expect("a current flows");
        assert!((reading.value - 400.0 * 257.5 / 262.5).abs() < 1e-9);
        assert!(reading.expanded() > 0.5 && reading.expanded() < 1.0);
    }

    #[test]
    fn an_open_coil_has_no_resistance() {
        let open = [(Volt(8.0), Volt(0.001))];
        assert!(
            resistance(
                &open,
                Factor::new(375.0, 0.01),
                Celsius(23.0),
                Celsius(23.0),
                UNCERTAINTY
            )
            .is_none()
        );
        assert!(
            resistance(
                &[],
                Factor::new(375.0, 0.01),
                Celsius(23.0),
                Celsius(23.0),
                UNCERTAINTY
            )
            .is_none()
        );
    }
}
