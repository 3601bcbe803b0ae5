//! Statistics of a lot of resistors, for made-up parts.

use super::Parameter;
use crate::dut::made_up::{MadeUp, Scatter};
use crate::dut::recipe::Limits;
use crate::gauge::Budget;

/// Resistance for a recipe without any limit, ohm.
const USUAL_OHM: f64 = 390.0;

/// Distance of the mean from the limit in a recipe with only one limit, as a share of this limit: five standard
/// deviations.
const INSIDE: f64 = 0.05;

/// Returns the scatter of the resistance. With two limits the mean is their middle, and the standard deviation a tenth
/// of their distance; with one limit, the mean lies inside it.
pub fn made_up(limits: &Limits) -> MadeUp {
    let limit = limits.of(Parameter::Resistance);
    let (mean, sd) = match (limit.low, limit.high) {
        (Some(low), Some(high)) => ((low + high) / 2.0, (high - low) / 10.0),
        (Some(low), None) => (low * (1.0 + INSIDE), low * INSIDE / 5.0),
        (None, Some(high)) => (high * (1.0 - INSIDE), high * INSIDE / 5.0),
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn made_up_parts_lie_inside_every_limit() {
        for ends in ["low = 380.0", "high = 400.0", "low = 380.0, high = 400.0"] {
            let limits: Limits = toml::from_str(&format!("resistance_ohm = {{ {ends} }}")).unwrap();
            let (_, of) = &made_up(&limits).scatter[0];
            let limit = limits.of(Parameter::Resistance);
            let reach = 4.9 * of.sd;
            assert!(limit.low.is_none_or(|low| low < of.mean - reach), "{of:?}");
            assert!(
                limit.high.is_none_or(|high| of.mean + reach < high),
                "{of:?}"
            );
        }
    }
}
