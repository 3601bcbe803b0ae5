//! What measuring relies on: references, promised accuracies, how long a calibration holds, reference parts.
//! From `config/rig.toml` and `config/golden.toml`.

use super::Parameter;
use crate::dut::instruments::Certificate;
use serde::{Deserialize, Serialize};

/// References on the interface board. Tolerances are half widths.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct ReferenceSettings {
    /// Resistor in place of the coil, ohm.
    pub coil_ohm: f64,
    /// Its tolerance, %.
    pub coil_tolerance_pct: f64,
    /// Four-wire resistor in place of the contact, mOhm.
    pub contact_mohm: f64,
    /// Its tolerance, %.
    pub contact_tolerance_pct: f64,
    /// Voltage at `reference_voltage`, V.
    pub voltage_v: f64,
    /// Its tolerance, %.
    pub voltage_tolerance_pct: f64,
    /// Gate pulse that ARM gives with the contact reference, ms.
    pub gate_pulse_ms: f64,
    /// Clock of the gated counters, Hz.
    pub counter_clock_hz: f64,
    /// Its tolerance, ppm.
    pub counter_clock_tolerance_ppm: f64,
}

/// What the makers promise before calibration: half widths, unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct AccuracySettings {
    /// Gain of analog inputs, % of reading.
    pub ai_gain_pct: f64,
    /// Offset of analog inputs, % of range.
    pub ai_offset_pct_of_range: f64,
    /// Noise of analog inputs, LSB (standard deviation).
    pub ai_noise_lsb: f64,
    /// Gain of analog outputs, %.
    pub ao_gain_pct: f64,
    /// Offset of analog outputs, mV at the terminal.
    pub ao_offset_mv: f64,
    /// Slope of analog outputs, %.
    pub ao_slope_pct: f64,
    /// Time between two steps of an analog output while it ramps, ms.
    #[serde(default = "AccuracySettings::usual_refresh_ms")]
    pub ao_refresh_ms: f64,
    /// Delay of the counter gates, us.
    pub gate_delay_us: f64,
    /// Thermometers, K (standard deviation).
    pub rtd_k: f64,
    /// Part against track, K (standard deviation).
    pub part_minus_track_k: f64,
    /// Threshold of a coil of [`SCATTERING_COIL_V`] from operation to operation, mV (standard deviation).
    pub operation_scatter_mv: f64,
    /// Conversions of an I-7017F in fast mode, all enabled channels together, per second.
    pub conversions_per_s: f64,
}

/// Nominal voltage of the coils whose scatter a rig's file states. Whatever makes a threshold scatter acts on the current, so
/// that in volts it goes with the coil.
const SCATTERING_COIL_V: f64 = 12.0;

impl AccuracySettings {
    /// Standard deviation of a threshold from operation to operation, volts, of a coil of this nominal voltage.
    pub fn operation_v(&self, nominal_v: f64) -> f64 {
        self.operation_scatter_mv / 1e3 * nominal_v / SCATTERING_COIL_V
    }

    /// Refresh interval of an I-7021P without a measured one.
    fn usual_refresh_ms() -> f64 {
        1.0
    }
}

/// How long a calibration holds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct CalibrationSettings {
    /// Age at which a lot is refused, hours.
    pub valid_h: f64,
    /// File of the reference parts, beside `rig.toml`.
    pub golden: String,
}

/// A certified value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Certified {
    /// The value in the unit of its key.
    pub value: f64,
    /// Standard uncertainty of the certificate, same unit.
    pub u: f64,
}

/// A relay with a certificate, run before a lot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferencePart {
    /// Serial number.
    pub serial: String,
    /// Nominal coil voltage: it serves recipes of this voltage.
    pub nominal_v: f64,
    /// Operate threshold, V.
    pub operate_voltage_v: Certified,
    /// Release threshold, V.
    pub release_voltage_v: Certified,
    /// Coil resistance, ohm.
    pub coil_resistance_ohm: Certified,
}

impl ReferencePart {
    /// What is certified of it.
    pub fn certified(&self) -> [(Parameter, Certified); 3] {
        [
            (Parameter::OperateVoltage, self.operate_voltage_v),
            (Parameter::ReleaseVoltage, self.release_voltage_v),
            (Parameter::CoilResistance, self.coil_resistance_ohm),
        ]
    }
}

/// All reference parts of the plant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceSet {
    /// Temperature of the certified values, degrees Celsius.
    pub reference_temperature_c: f64,
    /// The parts.
    #[serde(rename = "golden")]
    pub parts: Vec<ReferencePart>,
}

impl ReferenceSet {
    /// The certificates of all parts.
    pub fn certificates(&self) -> Vec<Certificate> {
        self.parts.iter().map(Certificate::from).collect()
    }

    /// The parts that serve recipes of this nominal coil voltage.
    pub fn of_nominal(&self, nominal_v: f64) -> impl Iterator<Item = &ReferencePart> {
        self.parts
            .iter()
            .filter(move |part| (part.nominal_v - nominal_v).abs() < 1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_of_a_coil_of_half_the_voltage_scatters_by_half_as_many_volts() {
        let accuracy = AccuracySettings {
            ai_gain_pct: 0.1,
            ai_offset_pct_of_range: 0.05,
            ai_noise_lsb: 0.5,
            ao_gain_pct: 0.05,
            ao_offset_mv: 2.0,
            ao_slope_pct: 0.2,
            ao_refresh_ms: 1.0,
            gate_delay_us: 10.0,
            rtd_k: 0.1,
            part_minus_track_k: 0.15,
            operation_scatter_mv: 2.0,
            conversions_per_s: 75.0,
        };
        let volts = [24.0, 12.0, 6.0].map(|nominal_v| accuracy.operation_v(nominal_v));
        assert_eq!(volts, [0.004, 0.002, 0.001]);
    }
}
