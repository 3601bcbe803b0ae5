//! The factors of a calibration by name, and whether those found again agree with those stored.

use machine::dut::Calibration;
use std::fmt;
use units::Unit;

/// Coverage factor of what is told: about 95 %.
pub const K: f64 = 2.0;

/// Coverage factor of a comparison. Fourteen factors have to agree at once: at 2 every second rig that has not changed
/// would fail (1 - 0.95^14), at 3 one in thirty (1 - 0.9973^14), and terms that both measurements share make it fewer.
pub const K_OF_ALL: f64 = 3.0;

/// A factor found again.
#[derive(Debug)]
pub struct Compared {
    /// Name in the table.
    pub name: &'static str,
    /// Unit of the figures.
    pub unit: Unit,
    /// Measured now.
    pub found: f64,
    /// Stored.
    pub expected: f64,
    /// Expanded uncertainty of both together.
    pub expanded_u: f64,
}

impl Compared {
    /// Found and stored agree; NaN never does.
    pub fn holds(&self) -> bool {
        (self.found - self.expected).abs() <= self.expanded_u
    }
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:<18} found {:>14.6}, expected {:>14.6} +- {:<10.6} {:<6} {}",
            self.name,
            self.found,
            self.expected,
            self.expanded_u,
            self.unit,
            if self.holds() { "holds" } else { "FAILED" }
        )
    }
}

/// Factor by factor.
pub fn compare(found: &Calibration, expected: &Calibration) -> Vec<Compared> {
    let pairs = found
        .facts()
        .factors
        .into_iter()
        .zip(expected.facts().factors);
    pairs
        .map(|(found, expected)| Compared {
            name: found.name,
            unit: found.unit,
            found: found.factor.value,
            expected: expected.factor.value,
            expanded_u: K_OF_ALL * found.factor.u.hypot(expected.factor.u),
        })
        .collect()
}
