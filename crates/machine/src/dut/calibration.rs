//! Calibration of a rig for any kind: dates and factors.

use super::em_relay;
use crate::gauge::factor::Named;
use serde::{Deserialize, Serialize};

/// Factors of a kind, as the history keeps them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Calibration {
    /// Factors of the coil board, for relays.
    EmRelay(em_relay::Calibration),
}

impl Calibration {
    /// Returns the data that every kind of calibration has.
    pub fn facts(&self) -> CalibrationFacts {
        match self {
            Self::EmRelay(relay) => relay.facts(),
        }
    }
}

/// Data that every kind of calibration has.
#[derive(Debug, Clone)]
pub struct CalibrationFacts {
    /// When the factors were found, microseconds since 1970 UTC.
    pub made_at_us: i64,
    /// When they expire, microseconds since 1970 UTC.
    pub due_at_us: i64,
    /// True on a simulated rig.
    pub is_simulated: bool,
    /// Nominal voltage of the parts that it holds for, V.
    pub nominal_v: f64,
    /// Factor of the supply range that it was made in.
    pub range_factor: f64,
    /// True when it has everything that the kind needs, reference parts included.
    pub is_complete: bool,
    /// Every measured factor, with its name and unit.
    pub factors: Vec<Named>,
}
