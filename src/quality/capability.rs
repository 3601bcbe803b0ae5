//! Can the process keep the limits: Cp, Cpk, Ppk.
//!
//! Cp and Cpk use the short-term deviation, mean moving range / d2 with d2 = 1.128 for pairs; Ppk uses
//! the deviation of all values. The interval of Cpk is Bissell's (1990):
//! `cpk -+ z sqrt(1 / (9 n) + cpk^2 / (2 (n - 1)))`.

/// d2 for moving ranges of two neighbours (ASTM manual of control charts, table of factors).
pub const D2_PAIR: f64 = 1.128;

/// Quantile of the normal distribution for a two-sided 95 % interval.
const Z_95: f64 = 1.959_963_984_540_054;

/// Limits, each of which may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Lower limit.
    pub low: Option<f64>,
    /// Upper limit.
    pub high: Option<f64>,
}

/// None where no limit, too few values or no spread leave nothing to say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Capability {
    /// Needs both limits.
    pub cp: Option<f64>,
    /// Towards the nearer limit.
    pub cpk: Option<f64>,
    /// Lower end of the two-sided 95 % interval of `cpk`.
    pub cpk_low95: Option<f64>,
    /// As `cpk`, from the deviation of all values.
    pub ppk: Option<f64>,
}

impl Capability {
    /// `within`: short-term deviation; `overall`: of all `n` values.
    pub fn of(
        limits: Limits,
        n: u64,
        mean: Option<f64>,
        within: Option<f64>,
        overall: Option<f64>,
    ) -> Self {
        let cpk = nearer(limits, mean, within);
        Self {
            cp: width(limits, within),
            cpk,
            cpk_low95: cpk.and_then(|cpk| bissell_low(cpk, n)),
            ppk: nearer(limits, mean, overall),
        }
    }
}

fn width(limits: Limits, sigma: Option<f64>) -> Option<f64> {
    let (low, high, sigma) = (limits.low?, limits.high?, positive(sigma)?);
    Some((high - low) / (6.0 * sigma))
}

fn nearer(limits: Limits, mean: Option<f64>, sigma: Option<f64>) -> Option<f64> {
    let (mean, sigma) = (mean?, positive(sigma)?);
    let below = limits.low.map(|low| mean - low);
    let above = limits.high.map(|high| high - mean);
    let room = match (below, above) {
        (Some(below), Some(above)) => below.min(above),
        (one, other) => one.or(other)?,
    };
    Some(room / (3.0 * sigma))
}

fn bissell_low(cpk: f64, n: u64) -> Option<f64> {
    let n = n as f64;
    (n >= 2.0).then(|| cpk - Z_95 * (1.0 / (9.0 * n) + cpk * cpk / (2.0 * (n - 1.0))).sqrt())
}

fn positive(sigma: Option<f64>) -> Option<f64> {
    sigma.filter(|&sigma| sigma > 0.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn of(low: Option<f64>, high: Option<f64>) -> Capability {
        Capability::of(Limits { low, high }, 50, Some(10.0), Some(1.0), Some(1.25))
    }

    #[test]
    fn the_nearer_limit_decides() {
        let both = of(Some(4.0), Some(13.0));
        assert_eq!(
            (both.cp, both.cpk, both.ppk),
            (Some(1.5), Some(1.0), Some(0.8))
        );
    }

    #[test]
    fn one_limit_gives_cpk_but_no_cp() {
        let high = of(None, Some(13.0));
        assert_eq!((high.cp, high.cpk), (None, Some(1.0)));
        assert_eq!(of(None, None), Capability::default());
    }

    #[test]
    fn bissells_lower_end_for_fifty_values_at_one() {
        let expected = 1.0 - 1.959964 * (1.0_f64 / 450.0 + 1.0 / 98.0).sqrt();
        assert!((of(None, Some(13.0)).cpk_low95.unwrap() - expected).abs() < 1e-6);
    }

    #[test]
    fn no_spread_leaves_nothing_to_say() {
        let limits = Limits {
            low: Some(0.0),
            high: Some(1.0),
        };
        assert_eq!(
            Capability::of(limits, 9, Some(0.5), Some(0.0), None),
            Capability::default()
        );
    }
}
