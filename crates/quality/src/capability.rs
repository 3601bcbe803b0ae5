//! Capability of a process to keep its limits: Cp, Cpk, Pp, Ppk, each with its 95 % interval.
//!
//! - Cp and Cpk use the short-term standard deviation: mean moving range / d2, with d2 = 1.128 for pairs. Pp and Ppk
//!   use the standard deviation of all values.
//! - Interval of Cp and Pp: `c sqrt(chi2(q; n-1) / (n-1))` for q = 0.025 and 0.975, exact for normal values.
//! - Interval of Cpk and Ppk: Bissell (1990), `c -+ z sqrt(1 / (9 n) + c^2 / (2 (n - 1)))`. [`lower_bound`] is its
//!   one-sided form.
//! - With one limit there are only Cpk and Ppk; Cp and Pp need both limits.
//! - For skewed values (contact resistance, bounce), [`by_percentiles`] uses the three percentiles of ISO 22514-2
//!   instead: `(high - x50) / (x99.865 - x50)` and `(x50 - low) / (x50 - x0.135)`.

use super::ordered::Ordered;
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use utoipa::ToSchema;

/// d2 of moving ranges between two neighbours (ASTM manual of control charts, table of factors).
pub const D2_PAIR: f64 = 1.128;

/// Quantile of the normal distribution for a two-sided 95 % interval.
const Z_95: f64 = 1.959_963_984_540_054;

/// Quantile of the normal distribution for a one-sided 95 % bound.
const Z_ONE_SIDED_95: f64 = 1.644_853_626_951_473;

/// Probability that a normal value lies more than three standard deviations below the mean.
const TAIL: f64 = 0.001_349_898_031_630_095;

/// Least number of values for which the percentile at [`TAIL`] needs no extrapolation: 1 / 0.00135.
const ENOUGH_FOR_TAILS: usize = 741;

/// Limits of a value, in its unit; either may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, ToSchema)]
pub struct Limits {
    /// Lower limit.
    pub low: Option<f64>,
    /// Upper limit.
    pub high: Option<f64>,
}

/// Two-sided 95 % interval of a capability index.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A capability index with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Index {
    /// Estimate.
    pub value: f64,
    /// 95 % interval; `None` with fewer than two values.
    pub interval: Option<Interval>,
}

/// Capability indices; an index is `None` when it lacks a limit, values or spread.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Capability {
    /// Distance between the limits, divided by six short-term standard deviations; needs both limits.
    pub cp: Option<Index>,
    /// Distance from the mean to the nearer limit, divided by three short-term standard deviations.
    pub cpk: Option<Index>,
    /// Distance between the limits, divided by six standard deviations of all values; needs both limits.
    pub pp: Option<Index>,
    /// Distance from the mean to the nearer limit, divided by three standard deviations of all values.
    pub ppk: Option<Index>,
}

impl Capability {
    /// Computes the indices. `within` is the short-term standard deviation, `overall` that of all `n` values.
    pub fn of(
        limits: Limits,
        n: u64,
        mean: Option<f64>,
        within: Option<f64>,
        overall: Option<f64>,
    ) -> Self {
        let wide = |sigma| {
            let value = width(limits, sigma)?;
            let interval = chi_square(value, n);
            Some(Index { value, interval })
        };
        let near = |sigma| {
            let value = nearer(limits, mean, sigma)?;
            let interval = bissell(value, n);
            Some(Index { value, interval })
        };
        Self {
            cp: wide(within),
            cpk: near(within),
            pp: wide(overall),
            ppk: near(overall),
        }
    }
}

/// Returns the capability index towards the nearer limit, computed from percentiles and so valid for any distribution.
/// Returns `None` without a limit, and with fewer than 741 values, whose outer percentiles would have to be
/// extrapolated.
pub fn by_percentiles(limits: Limits, values: &Ordered) -> Option<f64> {
    if values.len() < ENOUGH_FOR_TAILS {
        return None;
    }
    let [low, middle, high] = [TAIL, 0.5, 1.0 - TAIL].map(|p| values.quantile(p));
    let (low, middle, high) = (low?, middle?, high?);
    let above = limits.high.map(|limit| (limit - middle) / (high - middle));
    let below = limits.low.map(|limit| (middle - limit) / (middle - low));
    least(above, below).filter(|it| it.is_finite())
}

fn width(limits: Limits, sigma: Option<f64>) -> Option<f64> {
    let (low, high, sigma) = (limits.low?, limits.high?, positive(sigma)?);
    Some((high - low) / (6.0 * sigma))
}

fn nearer(limits: Limits, mean: Option<f64>, sigma: Option<f64>) -> Option<f64> {
    let (mean, sigma) = (mean?, positive(sigma)?);
    let below = limits.low.map(|low| mean - low);
    let above = limits.high.map(|high| high - mean);
    Some(least(below, above)? / (3.0 * sigma))
}

fn least(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.min(other)),
        (one, other) => one.or(other),
    }
}

/// Returns the one-sided lower 95 % confidence bound of a Cpk or Ppk of `n` values; `None` with fewer than two.
pub fn lower_bound(index: f64, n: u64) -> Option<f64> {
    Some(index - Z_ONE_SIDED_95 * deviation(index, n)?)
}

fn bissell(index: f64, n: u64) -> Option<Interval> {
    let half = Z_95 * deviation(index, n)?;
    Some(Interval {
        low: index - half,
        high: index + half,
    })
}

/// Returns Bissell's standard deviation of an estimated Cpk or Ppk.
fn deviation(index: f64, n: u64) -> Option<f64> {
    let n = n as f64;
    (n >= 2.0).then(|| (1.0 / (9.0 * n) + index * index / (2.0 * (n - 1.0))).sqrt())
}

fn chi_square(index: f64, n: u64) -> Option<Interval> {
    let freedom = n.checked_sub(1).filter(|&it| it > 0)? as f64;
    let chi = ChiSquared::new(freedom).ok()?;
    let end = |p| index * (chi.inverse_cdf(p) / freedom).sqrt();
    Some(Interval {
        low: end(0.025),
        high: end(0.975),
    })
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

    fn value(index: Option<Index>) -> Option<f64> {
        index.map(|it| it.value)
    }

    #[test]
    fn the_nearer_limit_decides() {
        let both = of(Some(4.0), Some(13.0));
        let found = [both.cp, both.cpk, both.pp, both.ppk].map(value);
        assert_eq!(found, [Some(1.5), Some(1.0), Some(1.2), Some(0.8)]);
    }

    #[test]
    fn one_limit_gives_cpk_but_no_cp() {
        let high = of(None, Some(13.0));
        assert_eq!((high.cp, value(high.cpk)), (None, Some(1.0)));
        let low = of(Some(4.0), None);
        assert_eq!((low.pp, value(low.ppk)), (None, Some(1.6)));
        assert_eq!(of(None, None), Capability::default());
    }

    #[test]
    fn bissells_interval_for_fifty_values_at_one() {
        let half = 1.959964 * (1.0_f64 / 450.0 + 1.0 / 98.0).sqrt();
        let found = of(None, Some(13.0)).cpk.unwrap().interval.unwrap();
        assert!((found.low - (1.0 - half)).abs() < 1e-6);
        assert!((found.high - (1.0 + half)).abs() < 1e-6);
    }

    /// Quality Digest, May 2000, last page: a Cpk of 1.15 from 45 values lies between 0.89 and 1.41 with 95 %. The same
    /// standard deviation, 0.26 / 1.96, gives the one-sided bound.
    #[test]
    fn a_published_interval_gives_the_one_sided_bound() {
        let found = bissell(1.15, 45).unwrap();
        assert!((found.low - 0.89).abs() < 0.005 && (found.high - 1.41).abs() < 0.005);
        let bound = lower_bound(1.15, 45).unwrap();
        assert!((bound - (1.15 - 1.645 * 0.26 / 1.96)).abs() < 0.005);
        assert!(bound > found.low + 0.03);
        assert_eq!(lower_bound(1.15, 1), None);
    }

    #[test]
    fn the_interval_of_cp_matches_published_quantiles() {
        // chi-square with 49 degrees of freedom has these quantiles: 31.5549 and 70.2224.
        let found = of(Some(4.0), Some(13.0)).cp.unwrap().interval.unwrap();
        assert!((found.low - 1.5 * (31.5549_f64 / 49.0).sqrt()).abs() < 1e-5);
        assert!((found.high - 1.5 * (70.2224_f64 / 49.0).sqrt()).abs() < 1e-5);
    }

    #[test]
    fn no_spread_gives_no_index() {
        let limits = Limits {
            low: Some(0.0),
            high: Some(1.0),
        };
        assert_eq!(
            Capability::of(limits, 9, Some(0.5), Some(0.0), None),
            Capability::default()
        );
    }

    #[test]
    fn a_skewed_process_is_judged_by_its_own_percentiles() {
        // Exponential values, drawn by inversion, have percentiles that are known exactly; the median is ln 2.
        let n = 100_000;
        let at = |k: u32| -(1.0 - (f64::from(k) + 0.5) / f64::from(n)).ln();
        let values = Ordered::of(&(0..n).map(at).collect::<Vec<f64>>());
        let limits = Limits {
            low: None,
            high: Some(10.0),
        };
        let tail = -TAIL.ln();
        let expected = (10.0 - 2_f64.ln()) / (tail - 2_f64.ln());
        assert!((by_percentiles(limits, &values).unwrap() - expected).abs() < 2e-3);
        let few = Ordered::of(&[1.0; 740]);
        assert_eq!(by_percentiles(limits, &few), None);
    }
}
