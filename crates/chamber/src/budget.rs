//! Uncertainty of a switching temperature. It has three terms: chain of the reference sensor, map of the sockets, fit
//! of the events.
//!
//! | term | without calibration | with |
//! |---|---|---|
//! | chain: reference sensor and module | 0.22 K: class A and 0.1 % of the range | what the calibration says |
//! | map: air temperature at a socket minus reference | 0.30 K | what remains after the map |
//! | fit: scatter, lag and instants of the events | covariance of the estimate | the same |

/// Standard uncertainty of a chain that is not calibrated, K.
const RAW_CHAIN_K: f64 = 0.22;
/// Standard uncertainty of sockets that are not mapped, K.
const RAW_MAP_K: f64 = 0.30;
/// Least expanded uncertainty without both calibrations, K.
const LEAST_RAW_U_K: f64 = 0.8;
/// Excess over ambient for which the uncertainty of the map is stated, K; the offsets of sockets grow with it.
const MAP_EXCESS_K: f64 = 75.0;
/// Coverage factor.
const COVERAGE: f64 = 2.0;

/// Calibrations of a rig, standard uncertainties in K; `None` for one that is missing or overdue.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Calibrations {
    /// Chain of sensor and module.
    pub chain_k: Option<f64>,
    /// Map of the sockets, at 75 K over ambient.
    pub map_k: Option<f64>,
}

/// Returns the uncertainty of a map at 75 K over ambient from that at the excess at which it was made, both K.
pub fn map_k(u_k: f64, excess_k: f64) -> f64 {
    u_k * MAP_EXCESS_K / excess_k
}

/// Terms of one value, standard uncertainties in K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Chain of sensor and module.
    pub chain_k: f64,
    /// Map of the sockets.
    pub map_k: f64,
    /// Fit of the events.
    pub fit_k: f64,
    /// Least expanded uncertainty, K.
    floor_k: f64,
}

impl Calibrations {
    fn complete(&self) -> bool {
        self.chain_k.is_some() && self.map_k.is_some()
    }

    /// Returns the budget of a switching temperature. Excess over ambient and fit are in K; the term of the map grows
    /// with the excess.
    pub fn of_temperature(&self, excess_k: f64, fit_k: f64) -> Budget {
        Budget {
            chain_k: self.chain_k.unwrap_or(RAW_CHAIN_K),
            map_k: self.map_k.unwrap_or(RAW_MAP_K) * excess_k.abs() / MAP_EXCESS_K,
            fit_k,
            floor_k: if self.complete() { 0.0 } else { LEAST_RAW_U_K },
        }
    }

    /// Returns the budget of a differential. An error of chain or map shifts both temperatures; it counts only for
    /// their difference, in proportion to `differential_k`, K.
    pub fn of_differential(&self, differential_k: f64, fit_k: f64) -> Budget {
        let whole = self.of_temperature(differential_k, fit_k);
        let share = (differential_k / MAP_EXCESS_K).abs().min(1.0);
        Budget {
            chain_k: whole.chain_k * share,
            ..whole
        }
    }
}

impl Budget {
    /// Returns the expanded uncertainty, k = 2, K.
    pub fn expanded_k(&self) -> f64 {
        let standard_k = self.chain_k.hypot(self.map_k).hypot(self.fit_k);
        (COVERAGE * standard_k).max(self.floor_k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: Calibrations = Calibrations {
        chain_k: Some(0.05),
        map_k: Some(0.10),
    };

    #[test]
    fn the_published_budget_gives_a_fifth_of_a_kelvin() {
        assert!((BOTH.of_temperature(75.0, 0.18).expanded_k() / 2.0 - 0.21).abs() < 0.005);
    }

    #[test]
    fn a_missing_calibration_leaves_four_fifths_of_a_kelvin() {
        for missing in [
            Calibrations::default(),
            Calibrations {
                map_k: None,
                ..BOTH
            },
            Calibrations {
                chain_k: None,
                ..BOTH
            },
        ] {
            assert!(missing.of_temperature(60.0, 0.01).expanded_k() >= 0.8);
        }
    }

    #[test]
    fn chain_and_map_all_but_cancel_in_a_differential() {
        let found = BOTH.of_differential(20.0, 0.1);
        assert!(found.chain_k < 0.02 && found.map_k < 0.03);
    }
}
