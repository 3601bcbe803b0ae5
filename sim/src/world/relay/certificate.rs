//! Reads the certificates of reference parts, and the nominal values of a recipe.

use super::values::Scale;
use crate::config::{ConfigError, Files};
use crate::table::read_fields;

/// A certified value with its standard uncertainty, in the unit of the value.
#[derive(Debug, Clone, Copy)]
pub struct Certified {
    /// Value at 23 C.
    pub value: f64,
    /// Standard uncertainty.
    pub u: f64,
}

/// Certificate of one reference part.
#[derive(Debug, Clone)]
pub struct Certificate {
    nominal_v: f64,
    /// Operate threshold, V.
    pub operate_voltage_v: Certified,
    /// Release threshold, V.
    pub release_voltage_v: Certified,
    /// Coil resistance, ohm.
    pub coil_resistance_ohm: Certified,
}

read_fields!(Certified { value, u });
read_fields!(Certificate {
    nominal_v,
    operate_voltage_v,
    release_voltage_v,
    coil_resistance_ohm,
});

/// Reads the certificates of the reference parts with this nominal voltage, in the order of the file.
///
/// # Errors
/// Fails when the file cannot be read or is not a list of certificates.
pub fn read_certificates(files: &Files, nominal_v: f64) -> Result<Vec<Certificate>, ConfigError> {
    let mut golden: Vec<Certificate> = files.read("golden.toml")?.get_or("golden", Vec::new())?;
    golden.retain(|golden| (golden.nominal_v - nominal_v).abs() < 1e-6);
    Ok(golden)
}

read_fields!(Scale {
    nominal_v,
    nominal_coil_ohm
});
