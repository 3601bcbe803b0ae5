//! Calibration of a rig, whatever kind of device it tests: dates and factors.

use super::{em_relay, thermostat};
use crate::gauge::factor::Named;
use serde::{Deserialize, Serialize};

/// Calibration for one kind of device, as the history stores it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Calibration {
    /// Factors of the coil board, for relays.
    EmRelay(Box<em_relay::Calibration>),
    /// Certificate of thermometer chain and sockets, for temperature relays.
    Thermostat(thermostat::certificate::Calibration),
}

impl Calibration {
    /// Returns the data that every kind of calibration has.
    pub fn facts(&self) -> CalibrationFacts {
        match self {
            Self::EmRelay(relay) => relay.facts(),
            Self::Thermostat(of_rack) => of_rack.facts(),
        }
    }

    /// Returns true when both follow from one certificate; false for relays, whose factors come from parts.
    pub fn has_certificate_of(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Thermostat(it), Self::Thermostat(other)) => it.certificate == other.certificate,
            (Self::EmRelay(_), Self::EmRelay(_) | Self::Thermostat(_))
            | (Self::Thermostat(_), Self::EmRelay(_)) => false,
        }
    }
}

/// Data that every kind of calibration has.
#[derive(Debug, Clone)]
pub struct CalibrationFacts {
    /// When the calibration was made, microseconds since 1970 UTC.
    pub made_at_us: i64,
    /// When the calibration expires, microseconds since 1970 UTC.
    pub due_at_us: i64,
    /// True on a simulated rig.
    pub is_simulated: bool,
    /// Nominal voltage of the parts for which the calibration holds, V; 0 when it holds for every part.
    pub nominal_v: f64,
    /// Voltage factor of the supply range in which the calibration was made, see
    /// [`crate::rig::supply::SupplyRange::factor`].
    pub range_factor: f64,
    /// True when the calibration has every factor that its kind of device needs, those from reference parts included.
    pub is_complete: bool,
    /// Every measured factor, with its name and unit.
    pub factors: Vec<Named>,
}
