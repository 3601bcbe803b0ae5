//! Stands in for module `bodies` in a program without the feature `bodies`; detects no crash.

use std::collections::BTreeSet;

use super::posture::Posture;
use crate::config::{ConfigError, Files};

/// False: this program does not detect crashes.
pub const WATCHED: bool = false;

/// Empty replacement of the bodies.
#[derive(Debug, Clone)]
pub struct Bodies;

impl Bodies {
    /// Returns the replacement without reading a file.
    ///
    /// # Errors
    /// Never fails.
    pub fn read(_files: &Files, _recipe: &str) -> Result<Self, ConfigError> {
        Ok(Self)
    }

    /// Returns 0 mm for every actuator, so that a posture never changes.
    pub fn stroke_mm(&self, _actuator: usize) -> f64 {
        0.0
    }

    /// Returns no crash.
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
