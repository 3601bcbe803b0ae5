//! Stands in for the bodies in a program that is built without the feature `bodies`: nothing is seen to touch.

use std::collections::BTreeSet;
use std::path::Path;

use super::posture::Posture;
use crate::config::ConfigError;

/// False: this program does not look for bodies that touch.
pub const WATCHED: bool = false;

/// No body.
#[derive(Debug, Clone)]
pub struct Bodies;

impl Bodies {
    /// Reads nothing.
    ///
    /// # Errors
    /// None.
    pub fn read(_dir: &Path, _recipe: &str) -> Result<Self, ConfigError> {
        Ok(Self)
    }

    /// Stroke of an actuator, mm: 0, so that a posture never changes.
    pub fn stroke_mm(&self, _actuator: usize) -> f64 {
        0.0
    }

    /// Finds no pair.
    pub fn watch(
        &self,
        _from: &Posture,
        _to: &Posture,
        _between: impl Fn(f64) -> Posture,
        _touching: &mut BTreeSet<(usize, usize)>,
    ) -> Vec<String> {
        Vec::new()
    }
}
