//! Characteristics (measured quantities) of every kind of device, as data.
//!
//! A kind declares its own in one table of [`Definition`]s; [`Characteristic`] is the closed enum over them. The key is
//! the same in recipes, rows, files and API.

use super::Kind;
use super::verdict::Bin;
use super::{em_relay, resistor, ssr, thermostat};
use crate::gauge::repetition::MeanOf;
use crate::instrument::curve::Curve;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::ops::Deref;
use texts::Lang;
use units::{Celsius, Unit};

/// Constant data of a characteristic.
#[derive(Debug, Clone, Copy)]
pub struct Definition {
    /// Key with the unit as suffix.
    pub key: &'static str,
    /// Unit in which values and limits are written.
    pub unit: Unit,
    /// What the mean of several readings estimates, which decides how their scatter enters the uncertainty.
    pub mean_of: MeanOf,
    /// Bin for a part that fails this characteristic.
    pub bin: Bin,
}

/// How the error of a result is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorUnit {
    /// In percent of the true value.
    Percent,
    /// In the unit of the key.
    Own,
    /// In millivolts, for a key in volts.
    Millivolt,
}

/// Greatest rms error of a result against the truth that is acceptable over a lot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcceptedError {
    /// Unit of `rms`.
    pub unit: ErrorUnit,
    /// The error at a true value of 0.
    pub rms: f64,
    /// What the true value adds to it, as a share of that value, which has the same unit.
    pub share: f64,
}

impl AcceptedError {
    /// An error that does not depend on the true value.
    pub const fn of(unit: ErrorUnit, rms: f64) -> Self {
        let share = 0.0;
        Self { unit, rms, share }
    }
}

/// A characteristic of one kind of device. The default methods suit a characteristic that does not depend on
/// temperature and has no lower bound in stored curves.
pub trait KindCharacteristic {
    /// Returns the constant data of the characteristic.
    fn definition(&self) -> &'static Definition;

    /// Returns the factor that converts a result at temperature `_from` to `_to`.
    fn conversion(&self, _from: Celsius, _to: Celsius) -> f64 {
        1.0
    }

    /// Returns the greatest rms error that is acceptable; `None` for a characteristic without true values. `_rated_v`:
    /// nominal voltage of the part, V.
    fn accepted_error(&self, _rated_v: Option<f64>) -> Option<AcceptedError> {
        None
    }

    /// Returns the lower bound that stored curves prove for a part without a measured value, in the unit of the key,
    /// less a margin for effects for which the curves are not corrected. `_rated_v`: nominal voltage of the part, V.
    fn lower_bound(&self, _curves: &[Curve], _rated_v: Option<f64>) -> Option<f64> {
        None
    }
}

/// One measured quantity of one kind. Sorts by kind, then in the order of reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Characteristic {
    /// Characteristic of an electromagnetic relay.
    EmRelay(em_relay::Parameter),
    /// Characteristic of a resistor.
    Resistor(resistor::Parameter),
    /// Characteristic of a solid-state relay.
    Ssr(ssr::Parameter),
    /// Characteristic of a temperature relay.
    Thermostat(thermostat::Parameter),
}

impl Characteristic {
    /// Returns every characteristic of every kind.
    pub fn all() -> impl Iterator<Item = Self> {
        Kind::ALL.into_iter().flat_map(Kind::characteristics)
    }

    /// Returns the characteristic with this key; `None` when no kind has it.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::all().find(|it| it.key() == key)
    }

    /// Returns the key, with the unit as suffix.
    pub fn key(self) -> &'static str {
        self.definition().key
    }

    /// Returns the name on pages and paper.
    pub fn name(self, lang: Lang) -> &'static str {
        lang.text(&format!("characteristic-{}", self.key()))
    }

    /// Returns the unit in which values and limits are written.
    pub fn unit(self) -> Unit {
        self.definition().unit
    }

    /// Returns the bin for a part that fails this characteristic.
    pub fn bin(self) -> Bin {
        self.definition().bin
    }
}

impl Deref for Characteristic {
    type Target = dyn KindCharacteristic;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::EmRelay(parameter) => parameter,
            Self::Resistor(parameter) => parameter,
            Self::Ssr(parameter) => parameter,
            Self::Thermostat(parameter) => parameter,
        }
    }
}

impl fmt::Display for Characteristic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

impl Serialize for Characteristic {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de> Deserialize<'de> for Characteristic {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let unknown = || serde::de::Error::custom(format!("{key} is no characteristic"));
        Self::from_key(&key).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_key_is_the_same_in_code_and_files() {
        for characteristic in Characteristic::all() {
            let json = serde_json::to_string(&characteristic).unwrap();
            assert_eq!(json, format!("\"{characteristic}\""));
            let back: Characteristic = serde_json::from_str(&json).unwrap();
            assert_eq!(back, characteristic);
        }
    }
}
