//! Reads the certificates of reference parts, and the nominal values of a recipe.

use serde::Deserialize;

use super::values::Scale;
use crate::config::{ConfigError, Files};

/// A certified value with its standard uncertainty, in the unit of the value.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct Certified {
    /// Value at 23 C.
    pub value: f64,
    /// Standard uncertainty.
    pub u: f64,
}

/// Certificate of one reference part.
#[derive(Debug, Clone, Deserialize)]
pub struct Certificate {
    nominal_v: f64,
    /// Operate threshold, V.
    pub operate_voltage_v: Certified,
    /// Release threshold, V.
    pub release_voltage_v: Certified,
    /// Coil resistance, ohm.
    pub coil_resistance_ohm: Certified,
}

#[derive(Deserialize)]
struct GoldenFile {
    #[serde(default)]
    golden: Vec<Certificate>,
}

#[derive(Deserialize)]
struct RecipeFile {
    part: RecipePart,
}

#[derive(Deserialize)]
struct RecipePart {
    nominal_v: f64,
    nominal_coil_ohm: f64,
}

/// Reads the certificates for a nominal voltage, in the order of the file.
///
/// # Errors
/// Fails when the file cannot be read or is not a list of certificates.
pub fn read_certificates(files: &Files, nominal_v: f64) -> Result<Vec<Certificate>, ConfigError> {
    let file: GoldenFile = files.read("golden.toml")?.parse()?;
    Ok(file
        .golden
        .into_iter()
        .filter(|g| (g.nominal_v - nominal_v).abs() < 1e-6)
        .collect())
}

/// Reads the nominal volts and ohms of a recipe.
///
/// # Errors
/// Fails when the recipe does not exist or lacks the nominal values.
pub fn read_scale(files: &Files, recipe: &str) -> Result<Scale, ConfigError> {
    let file: RecipeFile = files.recipe(recipe)?;
    let RecipePart {
        nominal_v,
        nominal_coil_ohm,
    } = file.part;
    Ok(Scale {
        nominal_v,
        nominal_coil_ohm,
    })
}
