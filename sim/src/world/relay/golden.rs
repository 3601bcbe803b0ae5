//! Parts with a certificate and the nominal values of a recipe, as their files say.

use std::path::Path;

use serde::Deserialize;

use super::drawn::Scale;
use crate::config::{ConfigError, content, read_text};

/// A certified value with its standard uncertainty.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct Certified {
    /// Value at 23 C.
    pub value: f64,
    /// Standard uncertainty.
    pub u: f64,
}

/// Certificate of one golden part.
#[derive(Debug, Clone, Deserialize)]
pub struct Certificate {
    nominal_v: f64,
    /// Operate threshold.
    pub operate_voltage_v: Certified,
    /// Release threshold.
    pub release_voltage_v: Certified,
    /// Coil resistance.
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

/// Certificates of the golden parts for a nominal voltage, in order of the file.
///
/// # Errors
/// The file cannot be read or is no list of certificates.
pub fn read_golden(dir: &Path, nominal_v: f64) -> Result<Vec<Certificate>, ConfigError> {
    let path = dir.join("golden.toml");
    let text = read_text(&path)?;
    let file: GoldenFile = toml::from_str(&text).map_err(|e| content(&path, &text, &e))?;
    Ok(file
        .golden
        .into_iter()
        .filter(|g| (g.nominal_v - nominal_v).abs() < 1e-6)
        .collect())
}

/// Nominal volts and ohms of a recipe.
///
/// # Errors
/// There is no such recipe, or it lacks its part.
pub fn read_scale(dir: &Path, recipe: &str) -> Result<Scale, ConfigError> {
    let path = dir.join("recipes").join(format!("{recipe}.toml"));
    let text = read_text(&path)?;
    let file: RecipeFile = toml::from_str(&text).map_err(|e| content(&path, &text, &e))?;
    let RecipePart {
        nominal_v,
        nominal_coil_ohm,
    } = file.part;
    Ok(Scale {
        nominal_v,
        nominal_coil_ohm,
    })
}
