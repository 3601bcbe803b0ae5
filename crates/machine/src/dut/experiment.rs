//! Experiments without parts on a rig with a rack: what a person orders, and the figures found.

use serde::Serialize;

/// What an experiment shall find.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Experiment {
    /// The response of the air to the heater.
    Identify,
    /// That response, and settings of the controller from an oscillation.
    Tune,
}

/// A figure that an experiment has found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figure {
    /// Table of the configuration to which it belongs.
    pub table: &'static str,
    /// Key in that table, which ends with the unit.
    pub key: &'static str,
    /// Value, in the unit of the key.
    pub value: f64,
    /// Standard uncertainty, in the same unit; null for a value that follows from others.
    pub u: Option<f64>,
}

/// What an experiment has found, in the order of the configuration.
pub type Found = Vec<Figure>;
