//! The factors of a calibration by name, and whether those found again agree with those stored.

use crate::gauge::Calibration;
use crate::gauge::calibration::Factor;
use std::fmt;

/// Coverage factor of what is told: about 95 %.
pub const K: f64 = 2.0;

/// Coverage factor of a comparison. Fourteen factors have to agree at once: at 2 every second rig that has not changed
/// would fail (1 - 0.95^14), at 3 one in thirty (1 - 0.9973^14), and terms that both measurements share make it fewer.
pub const K_OF_ALL: f64 = 3.0;

/// One factor as it is told.
pub struct Named {
    /// Name in the table.
    pub name: &'static str,
    /// Unit of value and uncertainty, `1` for a ratio.
    pub unit: &'static str,
    /// Value and standard uncertainty.
    pub factor: Factor,
}

/// A factor found again.
pub struct Compared {
    /// Name in the table.
    pub name: &'static str,
    /// Unit of the figures.
    pub unit: &'static str,
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

/// Every factor that was measured. The slope of the coarse ramp is the maker's and not among them.
pub fn factors(of: &Calibration) -> Vec<Named> {
    let named = |name, unit, factor| Named { name, unit, factor };
    let mut all = vec![
        named("coil_input_gain", "1", of.coil_input.gain),
        named("coil_input_offset", "V", of.coil_input.offset_v),
        named("coil_fine", "ohm", of.ohm_fine),
        named("coil_wide", "ohm", of.ohm_wide),
        named("contact", "mohm/V", of.contact_mohm_per_v),
        named("gate_delay_0", "us", of.gate_delay_us[0]),
        named("gate_delay_1", "us", of.gate_delay_us[1]),
        named("level_gain", "1", of.level.gain),
        named("level_offset", "V", of.level.offset_v),
        named("coarse_gain", "1", of.coarse.gain),
        named("fine_gain", "1", of.fine.gain),
        named("fine_slope", "V/s", of.fine_v_per_s),
    ];
    if let Some(lags) = &of.lags {
        all.push(named("operate_lag", "V", lags.operate.fine_v));
        all.push(named("release_lag", "V", lags.release.fine_v));
    }
    all
}

/// Factor by factor.
pub fn compare(found: &Calibration, expected: &Calibration) -> Vec<Compared> {
    factors(found)
        .into_iter()
        .zip(factors(expected))
        .map(|(found, expected)| Compared {
            name: found.name,
            unit: found.unit,
            found: found.factor.value,
            expected: expected.factor.value,
            expanded_u: K_OF_ALL * found.factor.u.hypot(expected.factor.u),
        })
        .collect()
}
