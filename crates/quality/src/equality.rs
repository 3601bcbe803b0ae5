//! Tests whether several groups of values, such as lots, have the same mean and the same spread.
//!
//! - Means: Welch's analysis of variance (Welch 1951), which does not assume equal spreads. With two groups it is
//!   Welch's t test, F = t^2.
//! - Spreads: Brown and Forsythe (1974), an analysis of variance of the distances from the median of each group, which
//!   suits skewed values.

use super::spread::{Spread, median};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use utoipa::ToSchema;

/// Result of a test of equality.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
pub struct Equality {
    /// Ratio of the variation between the groups to that within them.
    pub f: f64,
    /// Degrees of freedom between the groups.
    pub df1: f64,
    /// Degrees of freedom within the groups.
    pub df2: f64,
    /// Probability that equal groups show this ratio or a larger one.
    pub p: f64,
}

impl Equality {
    fn of(f: f64, df1: f64, df2: f64) -> Option<Self> {
        let distribution = FisherSnedecor::new(df1, df2)
            .ok()
            .filter(|_| f.is_finite())?;
        let p = distribution.sf(f);
        Some(Self { f, df1, df2, p })
    }
}

/// Tests whether the groups have the same mean; `None` with fewer than two groups, or when a group has fewer than two
/// values or no spread.
pub fn means(groups: &[&[f64]]) -> Option<Equality> {
    let k = groups.len() as f64;
    let figures = groups.iter().map(|values| {
        let spread = Spread::of(values);
        let variance = spread.sd()?.powi(2);
        (variance > 0.0).then(|| {
            (
                spread.n() as f64,
                spread.mean().unwrap_or(f64::NAN),
                variance,
            )
        })
    });
    let figures: Vec<(f64, f64, f64)> = figures.collect::<Option<_>>()?;
    let weights: Vec<f64> = figures
        .iter()
        .map(|(n, _, variance)| n / variance)
        .collect();
    let all: f64 = weights.iter().sum();
    let weighed = figures.iter().zip(&weights);
    let mean = weighed
        .clone()
        .map(|((_, mean, _), w)| w * mean)
        .sum::<f64>()
        / all;
    let between = weighed
        .clone()
        .map(|((_, it, _), w)| w * (it - mean).powi(2));
    let between = between.sum::<f64>() / (k - 1.0);
    let unsure = weighed.map(|((n, _, _), w)| (1.0 - w / all).powi(2) / (n - 1.0));
    let unsure: f64 = unsure.sum();
    let within = 1.0 + 2.0 * (k - 2.0) / (k * k - 1.0) * unsure;
    Equality::of(between / within, k - 1.0, (k * k - 1.0) / (3.0 * unsure))
}

/// Tests whether the groups have the same spread; `None` with fewer than two groups, with a group of fewer than two
/// values, and when all values of each group lie equally far from its median.
pub fn spreads(groups: &[&[f64]]) -> Option<Equality> {
    let distances = groups.iter().map(|values| {
        let middle = median(values).filter(|_| values.len() > 1)?;
        let distances: Vec<f64> = values.iter().map(|it| (it - middle).abs()).collect();
        Some(Spread::of(&distances))
    });
    let distances: Vec<Spread> = distances.collect::<Option<_>>()?;
    let k = distances.len() as f64;
    let all = distances
        .iter()
        .copied()
        .fold(Spread::default(), Spread::merged);
    let (n, mean) = (all.n() as f64, all.mean()?);
    let between = |it: &Spread| Some(it.n() as f64 * (it.mean()? - mean).powi(2));
    let between: f64 = distances.iter().map(between).sum::<Option<f64>>()?;
    let within = |it: &Spread| Some((it.n() - 1) as f64 * it.sd()?.powi(2));
    let within: f64 = distances.iter().map(within).sum::<Option<f64>>()?;
    let f = (between / (k - 1.0)) / (within / (n - k));
    Equality::of(f, k - 1.0, n - k)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const A: [f64; 10] = [7.1, 7.3, 7.2, 7.6, 7.4, 7.5, 7.2, 7.3, 7.1, 7.4];
    const B: [f64; 8] = [7.9, 8.4, 7.2, 8.8, 7.5, 8.1, 7.0, 8.6];
    const C: [f64; 6] = [7.3, 7.4, 7.3, 7.5, 7.2, 7.6];

    // Computed with exact fractions, p by the continued fraction of the incomplete beta function.
    const TWO_MEANS: [f64; 4] = [
        6.90436330047333,
        1.0,
        7.716397565885319,
        0.031241165503297943,
    ];
    const TWO_SPREADS: [f64; 4] = [14.061857034170222, 1.0, 16.0, 0.0017480771428956558];
    const THREE_MEANS: [f64; 4] = [
        3.4083648084384524,
        2.0,
        11.887532821032266,
        0.06760461868380319,
    ];
    const THREE_SPREADS: [f64; 4] = [10.921924214947026, 2.0, 21.0, 0.0005603683723398912];

    fn near(found: Equality, expected: [f64; 4]) {
        let found = [found.f, found.df1, found.df2, found.p];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() <= 1e-9 * expected.abs(),
                "{found}, expected {expected}"
            );
        }
    }

    #[test]
    fn two_groups_give_the_test_of_welch() {
        near(means(&[&A, &B]).unwrap(), TWO_MEANS);
        near(spreads(&[&A, &B]).unwrap(), TWO_SPREADS);
    }

    #[test]
    fn several_groups_are_tested_together() {
        near(means(&[&A, &B, &C]).unwrap(), THREE_MEANS);
        near(spreads(&[&A, &B, &C]).unwrap(), THREE_SPREADS);
    }

    #[test]
    fn groups_without_spread_have_no_test() {
        assert_eq!(means(&[&A, &[1.0, 1.0]]), None);
        assert_eq!(means(&[&A, &[1.0]]), None);
        assert_eq!(spreads(&[&[1.0, 1.0], &[2.0, 2.0]]), None);
        assert_eq!(means(&[&A]), None);
    }
}
