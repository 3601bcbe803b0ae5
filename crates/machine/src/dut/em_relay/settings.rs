//! References, calibration interval and reference parts, from `config/rig.toml` and `config/golden.toml`.

use super::Parameter;
use super::threshold::Direction;
use crate::dut::instruments::Certificate;
use serde::{Deserialize, Serialize};

/// References on the interface board. Tolerances are half widths.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct ReferenceSettings {
    /// Resistor in place of the coil, ohm.
    pub coil_ohm: f64,
    /// Tolerance of `coil_ohm`, %.
    pub coil_tolerance_pct: f64,
    /// Four-wire resistor in place of the contact, mOhm.
    pub contact_mohm: f64,
    /// Tolerance of `contact_mohm`, %.
    pub contact_tolerance_pct: f64,
    /// Voltage at the input `reference_voltage`, V.
    pub voltage_v: f64,
    /// Tolerance of `voltage_v`, %.
    pub voltage_tolerance_pct: f64,
    /// Time for which the output `arm` opens both counter gates while the contact reference is selected, ms.
    pub gate_pulse_ms: f64,
    /// Clock of the gated counters, Hz.
    pub counter_clock_hz: f64,
    /// Tolerance of `counter_clock_hz`, ppm.
    pub counter_clock_tolerance_ppm: f64,
}

/// Validity and source of a calibration.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct CalibrationSettings {
    /// Age of a calibration beyond which the rig refuses to begin a lot with it, hours.
    pub valid_h: f64,
    /// File of the reference parts, next to `rig.toml`; `None` when no recipe needs them.
    #[serde(rename = "golden")]
    pub reference_file: Option<String>,
    /// File with the certificate of the rack, next to `rig.toml`; `None` when there is none.
    #[serde(rename = "rack")]
    pub certificate_file: Option<String>,
}

/// A certified value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Certified {
    /// Value in the unit of its key.
    pub value: f64,
    /// Standard uncertainty of the certificate, same unit.
    pub u: f64,
}

/// A relay with a certificate that the rig measures to calibrate itself or to check itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferencePart {
    /// Serial number.
    pub serial: String,
    /// Nominal coil voltage of the recipes that the part calibrates, V.
    pub nominal_v: f64,
    /// Operate threshold, V.
    pub operate_voltage_v: Certified,
    /// Release threshold, V.
    pub release_voltage_v: Certified,
    /// Coil resistance, ohm.
    pub coil_resistance_ohm: Certified,
}

impl ReferencePart {
    /// Returns the certified threshold of a direction, V.
    pub fn threshold(&self, direction: Direction) -> Certified {
        match direction {
            Direction::Rising => self.operate_voltage_v,
            Direction::Falling => self.release_voltage_v,
        }
    }

    /// Returns the certified values.
    pub fn certified(&self) -> [(Parameter, Certified); 3] {
        [
            (Parameter::OperateVoltage, self.operate_voltage_v),
            (Parameter::ReleaseVoltage, self.release_voltage_v),
            (Parameter::CoilResistance, self.coil_resistance_ohm),
        ]
    }
}

/// All reference parts of the plant.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ReferenceSet {
    /// Temperature to which the certified values refer, degrees Celsius.
    pub reference_temperature_c: f64,
    /// The parts.
    #[serde(rename = "golden")]
    pub parts: Vec<ReferencePart>,
}

impl ReferenceSet {
    /// Returns the certificates of all parts.
    pub fn certificates(&self) -> Vec<Certificate> {
        self.parts.iter().map(Certificate::from).collect()
    }

    /// Returns the parts for recipes of this nominal coil voltage.
    pub fn of_nominal(&self, nominal_v: f64) -> impl Iterator<Item = &ReferencePart> {
        self.parts
            .iter()
            .filter(move |part| (part.nominal_v - nominal_v).abs() < 1e-6)
    }
}
