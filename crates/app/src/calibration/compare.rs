//! The factors of a calibration by name, and whether those found again agree with those stored.

use machine::dut::Calibration;
use machine::gauge::factor::Named;
use std::fmt;
use units::Unit;

/// Coverage factor of what is told: about 95 %.
pub const K: f64 = 2.0;

/// Coverage factor of a comparison. Fifteen factors have to agree at once: at 2 every second rig that has not changed
/// would fail (1 - 0.95^15), at 3 one in 25 (1 - 0.9973^15), and terms that both measurements share make it fewer.
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

/// Factor by factor; one that either calibration lacks is left out.
pub fn compare(found: &Calibration, expected: &Calibration) -> Vec<Compared> {
    let expected = expected.factors();
    let of_both = |found: Named| {
        let mut named = expected.iter().filter(|it| it.name == found.name);
        named.next().map(|expected| (found, *expected))
    };
    let pairs = found.factors().into_iter().filter_map(of_both);
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
