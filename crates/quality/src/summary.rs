//! Statistics of one parameter; the fields are the keys of `history stats --json`.

use super::capability::{Capability, D2_PAIR, Index, Limits, lower_bound};
use super::spread::{self, Spread};
use serde::Serialize;
use utoipa::ToSchema;

/// Statistics of one parameter. A figure that cannot be computed is `None`, null in JSON.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Summary {
    /// Key of the parameter.
    pub param: String,
    /// Number of values.
    pub n: u64,
    /// Number of tests without a value, for example because the coil current was over range; `None` when the number of
    /// tests that should have a value is unknown.
    pub without_value: Option<u64>,
    /// Mean.
    pub mean: Option<f64>,
    /// Standard deviation with n - 1.
    pub sd: Option<f64>,
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// Median.
    pub median: Option<f64>,
    /// Lag-1 autocorrelation, in order of time.
    pub lag1: Option<f64>,
    /// Cp, with the short-term deviation from the mean moving range.
    pub cp: Option<f64>,
    /// Cpk, with the short-term deviation from the mean moving range.
    pub cpk: Option<f64>,
    /// One-sided lower 95 % confidence bound of `cpk`.
    pub cpk_low95: Option<f64>,
    /// Ppk, with the standard deviation `sd`.
    pub ppk: Option<f64>,
}

impl Summary {
    /// Computes the statistics of `values`, which must be in order of time.
    pub fn of(param: &str, values: &[f64], limits: Limits) -> Self {
        let spread = Spread::of(values);
        let within = spread::mean_moving_range(values).map(|range| range / D2_PAIR);
        let value = |index: Option<Index>| index.map(|it| it.value);
        let able = Capability::of(limits, spread.n(), spread.mean(), within, spread.sd());
        Self {
            param: param.to_owned(),
            n: spread.n(),
            without_value: None,
            mean: spread.mean(),
            sd: spread.sd(),
            min: spread.min(),
            max: spread.max(),
            median: spread::median(values),
            lag1: spread::lag1_about(&spread, values),
            cp: value(able.cp),
            cpk: value(able.cpk),
            cpk_low95: value(able.cpk).and_then(|it| lower_bound(it, spread.n())),
            ppk: value(able.ppk),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_summary_has_exactly_the_agreed_keys() {
        let json = serde_json::to_value(Summary::of("x", &[1.0, 2.0], Limits::default())).unwrap();
        let mut keys: Vec<_> = json.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        let agreed = "cp cpk cpk_low95 lag1 max mean median min n param ppk sd without_value";
        assert_eq!(keys.join(" "), agreed);
        assert!(json["cpk"].is_null());
    }

    #[test]
    fn cpk_uses_the_moving_range_ppk_the_spread() {
        let limits = Limits {
            low: Some(0.0),
            high: Some(5.0),
        };
        let it = Summary::of("x", &[1.0, 2.0, 3.0, 4.0], limits);
        let within = 1.0 / 1.128;
        assert!((it.cp.unwrap() - 5.0 / (6.0 * within)).abs() < 1e-12);
        assert!((it.cpk.unwrap() - 2.5 / (3.0 * within)).abs() < 1e-12);
        assert!((it.ppk.unwrap() - 2.5 / (3.0 * (5.0_f64 / 3.0).sqrt())).abs() < 1e-12);
    }
}
