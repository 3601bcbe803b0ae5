//! What made-up parts of a kind look like, for trying a history: how values scatter, and what a test would have seen.

use super::Characteristic;
use crate::gauge::Budget;
use crate::instrument::trace::Signal;

/// What made-up parts of a recipe look like: means from the recipe where it knows them, else those of the default world.
#[derive(Debug, Clone)]
pub struct MadeUp {
    /// Of every characteristic, in the order of reports.
    pub scatter: Vec<(Characteristic, Scatter)>,
    /// As many as a test of the default recipe has.
    pub looks: Vec<Looks>,
}

/// How a characteristic scatters over a lot, and how well a value is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatter {
    /// Of the values.
    pub mean: f64,
    /// Standard deviation of the values, or of their logarithm.
    pub sd: f64,
    /// The logarithm scatters, about the logarithm of the mean.
    pub logarithmic: bool,
    /// Standard uncertainty of a value.
    pub u: f64,
    /// Budget as a run stores it.
    pub budget: Budget,
}

/// Looks at one signal, equally far apart.
#[derive(Debug, Clone, Copy)]
pub struct Looks {
    /// At what.
    pub signal: Signal,
    /// How many.
    pub count: i64,
    /// Value of the look with this number, from 0.
    pub value: fn(i64) -> f64,
}
