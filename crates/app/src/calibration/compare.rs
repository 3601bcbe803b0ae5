//! Compares the factors of two calibrations of the same rig, one by one.

use machine::dut::Calibration;
use machine::gauge::factor::Named;
use std::fmt;
use units::Unit;

/// Coverage factor of printed uncertainties: about 95 %.
pub const K: f64 = 2.0;

/// Coverage factor of a comparison. All fifteen factors must agree: with k = 2, an unchanged rig would fail about every
/// second verification (1 - 0.95^15); with k = 3, at most one in 25 (1 - 0.9973^15), and fewer because both
/// measurements share error terms.
pub const K_JOINT: f64 = 3.0;

/// A factor measured again, beside the stored one.
#[derive(Debug)]
pub struct FactorComparison {
    /// Name of the factor in the printed table.
    pub name: &'static str,
    /// Unit of `found`, `expected` and `expanded_u`.
    pub unit: Unit,
    /// Value measured now.
    pub found: f64,
    /// Stored value.
    pub expected: f64,
    /// Expanded uncertainty of the difference, coverage factor [`K_JOINT`].
    pub expanded_u: f64,
}

impl FactorComparison {
    /// Returns true when `found` and `expected` differ by at most `expanded_u`; NaN never agrees.
    pub fn agrees(&self) -> bool {
        (self.found - self.expected).abs() <= self.expanded_u
    }
}

impl fmt::Display for FactorComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:<18} found {:>14.6}, expected {:>14.6} +- {:<10.6} {:<6} {}",
            self.name,
            self.found,
            self.expected,
            self.expanded_u,
            self.unit,
            if self.agrees() { "agrees" } else { "FAILED" }
        )
    }
}

/// Pairs the factors of both calibrations by name; leaves out a factor that one of the calibrations lacks.
pub fn compare(found: &Calibration, expected: &Calibration) -> Vec<FactorComparison> {
    let expected = expected.facts().factors;
    let compared = |found: Named| {
        let expected = expected.iter().find(|it| it.name == found.name)?;
        Some(FactorComparison {
            name: found.name,
            unit: found.unit,
            found: found.factor.value,
            expected: expected.factor.value,
            expanded_u: K_JOINT * found.factor.u.hypot(expected.factor.u),
        })
    };
    let found = found.facts().factors.into_iter();
    found.filter_map(compared).collect()
}
