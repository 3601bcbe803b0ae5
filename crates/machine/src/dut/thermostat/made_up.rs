//! Means and spreads for made-up lots of temperature relays.

use super::Parameter;
use crate::dut::made_up::{MadeUp, Scatter};
use crate::dut::recipe::Limits;
use crate::gauge::Budget;

/// Mean of a characteristic with an upper limit alone, as a share of it; with a lower limit alone, the limit as a share
/// of the mean.
const BELOW: f64 = 0.6;
/// Standard deviation of a characteristic with one limit or none, as a share of the limit or of [`USUAL`].
const SPREAD: f64 = 0.05;
/// Mean of a characteristic without any limit, in its unit.
const USUAL: f64 = 1.0;

/// Returns mean and spread of every characteristic: midway between its limits, or well inside the only one.
pub fn made_up(limits: &Limits) -> MadeUp {
    let one = |of: Parameter| {
        let limit = limits.of(of);
        let (mean, sd) = match (limit.low, limit.high) {
            (Some(low), Some(high)) => (f64::midpoint(low, high), (high - low) / 10.0),
            (Some(low), None) => (low / BELOW, SPREAD * low),
            (None, Some(high)) => (BELOW * high, SPREAD * high),
            (None, None) => (USUAL, SPREAD * USUAL),
        };
        let u = sd / 4.0;
        let scatter = Scatter {
            mean,
            sd,
            logarithmic: false,
            u,
            budget: Budget::default().with("fit", u),
        };
        (of.into(), scatter)
    };
    MadeUp {
        scatter: Parameter::ALL.map(one).to_vec(),
        looks: Vec::new(),
    }
}
