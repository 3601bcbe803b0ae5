//! Statistics of a lot of solid-state relays, for made-up parts.

use super::Parameter;
use super::recipe::SsrRecipe;
use crate::dut::made_up::{MadeUp, Scatter};
use crate::dut::recipe::Limits;
use crate::gauge::Budget;

/// Ratio of the mean to the upper limit of a characteristic that has no lower one.
const BELOW: f64 = 0.6;
/// Ratio of the mean to the lower limit of a characteristic that has no upper one.
const ABOVE: f64 = 1.6;
/// Standard deviation as a share of the mean.
const SPREAD: f64 = 0.05;
/// Standard uncertainty as a share of the mean.
const DOUBT: f64 = 0.002;

/// Returns the scatter of every characteristic: midway between its limits, or well inside the only one.
pub fn made_up(ssr: &SsrRecipe, limits: &Limits) -> MadeUp {
    let one = |of: Parameter| {
        let limit = limits.of(of);
        let (mean, sd) = match (limit.low, limit.high) {
            (Some(low), Some(high)) => (f64::midpoint(low, high), (high - low) / 10.0),
            (Some(low), None) => (ABOVE * low, SPREAD * ABOVE * low),
            (None, Some(high)) => (BELOW * high, SPREAD * BELOW * high),
            (None, None) => (ssr.part.control_v, SPREAD * ssr.part.control_v),
        };
        let u = DOUBT * mean;
        let scatter = Scatter {
            mean,
            sd,
            logarithmic: false,
            u,
            budget: Budget::default().with("gain", u),
        };
        (of.into(), scatter)
    };
    MadeUp {
        scatter: Parameter::ALL.map(one).to_vec(),
        looks: Vec::new(),
    }
}
