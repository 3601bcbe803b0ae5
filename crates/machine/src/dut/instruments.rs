//! Factors of a calibration and certificates of reference parts as people read them, in one form for every kind.

use super::calibration::Calibration;
use super::characteristic::Characteristic;
use super::em_relay::settings::{Certified, ReferencePart};
use crate::gauge::factor::Named;

/// Certificate of a reference part.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Serial number.
    pub serial: String,
    /// Nominal voltage of the recipes for which the part is a reference, V.
    pub nominal_v: f64,
    /// Every certified quantity, in the unit of its key.
    pub values: Vec<(Characteristic, Certified)>,
}

impl From<&ReferencePart> for Certificate {
    fn from(part: &ReferencePart) -> Self {
        let values = part.certified();
        Self {
            serial: part.serial.clone(),
            nominal_v: part.nominal_v,
            values: values.map(|(it, value)| (it.into(), value)).to_vec(),
        }
    }
}

/// Returns every factor of a stored calibration; empty when the calibration has a form that this version of the program
/// cannot read.
pub fn factors(calibration: serde_json::Value) -> Vec<Named> {
    let read = serde_json::from_value::<Calibration>(calibration);
    read.map_or_else(|_| Vec::new(), |it| it.facts().factors)
}
