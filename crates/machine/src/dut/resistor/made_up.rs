//! Statistics of a lot of resistors, for made-up parts.

use super::Parameter;
use crate::dut::made_up::{MadeUp, Scatter};
use crate::dut::recipe::Limits;
use crate::gauge::Budget;

/// Resistance for a recipe without any limit, ohm.
const USUAL_OHM: f64 = 390.0;

/// Returns the scatter of the resistance: around the middle of the limits, with a tenth of their distance as standard
/// deviation.
pub fn made_up(limits: &Limits) -> MadeUp {
    let limit = limits.of(Parameter::Resistance);
    let (mean, sd) = match (limit.low, limit.high) {
        (Some(low), Some(high)) => ((low + high) / 2.0, (high - low) / 10.0),
        (Some(end), None) | (None, Some(end)) => (end, end / 100.0),
        (None, None) => (USUAL_OHM, USUAL_OHM / 100.0),
    };
    let u = mean / 1000.0;
    let scatter = Scatter {
        mean,
        sd,
        logarithmic: false,
        u,
        budget: Budget::default().with("level", u),
    };
    MadeUp {
        scatter: vec![(Parameter::Resistance.into(), scatter)],
        looks: Vec::new(),
    }
}
