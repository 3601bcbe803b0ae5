//! A calibration factor with its uncertainty.

use serde::{Deserialize, Serialize};
use units::Unit;

/// A calibration factor with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Factor {
    /// Value, in the unit that the field or the name of the factor states.
    pub value: f64,
    /// Standard uncertainty in the same unit.
    pub u: f64,
}

impl Factor {
    /// Makes a factor from a value and its standard uncertainty.
    pub fn new(value: f64, u: f64) -> Self {
        Self { value, u }
    }
}

/// A standard deviation that is itself an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Value, in the unit that the field or the method states.
    pub value: f64,
    /// Degrees of freedom; infinite for a value that counts as exactly known.
    pub freedom: f64,
}

impl Deviation {
    /// Makes a standard deviation that counts as known.
    pub fn known(value: f64) -> Self {
        Self {
            value,
            freedom: f64::INFINITY,
        }
    }

    /// Returns the standard deviation of `factor` times the quantity.
    pub fn times(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            ..self
        }
    }
}

/// A factor with its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Named {
    /// Name in tables.
    pub name: &'static str,
    /// Unit of value and uncertainty.
    pub unit: Unit,
    /// Value and standard uncertainty.
    pub factor: Factor,
}
