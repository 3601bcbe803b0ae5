//! Gauge repeatability and reproducibility by averages and ranges (AIAG MSA): the method for hand calculation, which
//! many customers still require in addition to the analysis of variance.
//!
//! `EV = R K1`, `AV = sqrt((Xdiff K2)^2 - EV^2 / (parts trials))`, `PV = Rp K3`. EV, AV and PV are the standard
//! deviations of repeatability, of operators and of parts. R is the mean range of the trials, Xdiff the range of the
//! operators' means, Rp the range of the parts' means; K1, K2 and K3 are 1 / d2*, which turns a mean range into a
//! standard deviation (Duncan's table). The method has no term for interaction, so interaction adds to the
//! reproducibility.

use super::crossing;
use super::gauge_rr::{GaugeRr, GaugeRrError, Reading, deviations};
use super::squares::{Means, mean};
use std::f64::consts::FRAC_1_SQRT_2;

/// K1 for 2 and 3 trials (AIAG MSA, 4th edition; Duncan's d2*).
const K_OF_RANGE: [f64; 2] = [0.8862, 0.5908];
/// K2 for 2 and 3 operators.
const K_OF_OPERATORS: [f64; 2] = [FRAC_1_SQRT_2, 0.5231];
/// K3 for 2 to 10 parts.
const K_OF_PARTS: [f64; 9] = [
    FRAC_1_SQRT_2,
    0.5231,
    0.4467,
    0.4030,
    0.3742,
    0.3534,
    0.3375,
    0.3249,
    0.3146,
];

/// Evaluates a complete crossed study of 2 or 3 trials, up to 3 operators and 2 to 10 parts.
///
/// # Errors
/// Fails as [`super::gauge_rr::anova`] does, and when the study is larger than AIAG's tables of K1, K2 and K3.
pub fn average_and_range(readings: &[Reading]) -> Result<GaugeRr, GaugeRrError> {
    let cells = crossing::cells(readings)?;
    let (parts, operators) = (cells.len(), cells[0].len());
    let trials = cells[0][0].len();
    let factors = (
        K_OF_RANGE.get(trials - 2),
        operators
            .checked_sub(2)
            .map_or(Some(&0.0), |at| K_OF_OPERATORS.get(at)),
        K_OF_PARTS.get(parts - 2),
    );
    let (Some(k1), Some(k2), Some(k3)) = factors else {
        return Err(GaugeRrError::NoFactors {
            parts,
            operators,
            trials,
        });
    };
    let ranges: Vec<f64> = cells.iter().flatten().map(|cell| range(cell)).collect();
    let repeatability = k1 * mean(&ranges);
    let means = Means::of(&cells);
    let part = k3 * range(&means.part);
    let apart = range(&means.operator);
    let own = repeatability * repeatability / (parts * trials) as f64;
    let reproducibility = ((apart * k2).powi(2) - own).max(0.0);
    let variances = [
        repeatability * repeatability,
        reproducibility,
        0.0,
        part * part,
    ];
    Ok(deviations("average and range", variances, None))
}

fn range(values: &[f64]) -> f64 {
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - values.iter().copied().fold(f64::INFINITY, f64::min)
}
