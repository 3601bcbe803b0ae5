//! Made-up parts of a kind, for trying out a history without a rig: the scatter of their values, and the signals that a
//! test records.

use super::Characteristic;
use crate::gauge::Budget;
use crate::instrument::trace::Signal;

/// Statistics of the made-up parts of a recipe. A mean that the recipe does not state is that of the default simulated
/// rig.
#[derive(Debug, Clone)]
pub struct MadeUp {
    /// Scatter of each characteristic, in the order of reports.
    pub scatter: Vec<(Characteristic, Scatter)>,
    /// Recorded signals, with as many samples as a test of the default recipe has.
    pub looks: Vec<Looks>,
}

/// Scatter of a characteristic over a lot, and the uncertainty of a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatter {
    /// Mean of the values.
    pub mean: f64,
    /// Standard deviation of the values, or of their logarithm.
    pub sd: f64,
    /// True when the logarithm is normally distributed, around the logarithm of the mean.
    pub logarithmic: bool,
    /// Standard uncertainty of a value.
    pub u: f64,
    /// Uncertainty budget of a value.
    pub budget: Budget,
}

/// Samples of one signal, equally spaced in time.
#[derive(Debug, Clone, Copy)]
pub struct Looks {
    /// The signal.
    pub signal: Signal,
    /// Number of samples.
    pub count: i64,
    /// Returns the value of the sample with this number, from 0.
    pub value: fn(i64) -> f64,
}
