//! Errors of the estimates against the truth, and whether the stated uncertainty covers them.

use super::rig::Outcome;
use crate::controllers::plant::CHAIN_K;
use crate::figure::{mean, percent, rms};
use chamber::budget::Calibrations;
use chamber::lag::{Estimate, Value};

/// Calibrations of the study: the chain, and the map of the sockets.
const CALIBRATED: Calibrations = Calibrations {
    chain_k: Some(CHAIN_K),
    map_k: Some(0.10),
};

/// A quantity of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Operate temperature.
    Operate,
    /// Reset temperature.
    Reset,
    /// Operate less reset temperature.
    Differential,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 3] = [Self::Operate, Self::Reset, Self::Differential];

    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Operate => "operate",
            Self::Reset => "reset",
            Self::Differential => "differential",
        }
    }
}

/// Error and expanded uncertainty of one value, K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Miss {
    /// Estimate minus truth, K.
    pub error_k: f64,
    /// Expanded uncertainty of the estimate, K.
    pub u_k: f64,
}

/// Returns the errors of a quantity over batches, without parts that have no value of it.
pub fn misses<'a>(
    outcomes: impl IntoIterator<Item = &'a Outcome>,
    quantity: Quantity,
) -> Vec<Miss> {
    let parts = outcomes
        .into_iter()
        .flat_map(|it| it.parts.iter().map(move |part| (it, part)));
    let miss = |(it, (found, [operate_c, reset_c])): (&Outcome, &(Estimate, [f64; 2]))| {
        let (value, truth): (Option<Value>, f64) = match quantity {
            Quantity::Operate => (found.operate, *operate_c),
            Quantity::Reset => (found.reset, *reset_c),
            Quantity::Differential => (found.differential, operate_c - reset_c),
        };
        let Value { value, u_k } = value?;
        let budget = match quantity {
            Quantity::Operate | Quantity::Reset => {
                CALIBRATED.of_temperature(value - it.ambient_c, u_k)
            }
            Quantity::Differential => CALIBRATED.of_differential(value, u_k),
        };
        Some(Miss {
            error_k: value - truth,
            u_k: budget.expanded_k(),
        })
    };
    parts.filter_map(miss).collect()
}

/// Returns the root mean square of the errors, K.
pub fn rms_k(misses: &[Miss]) -> Option<f64> {
    rms(misses.iter().map(|it| it.error_k))
}

/// Returns the mean error, K.
pub fn mean_k(misses: &[Miss]) -> Option<f64> {
    mean(misses.iter().map(|it| it.error_k))
}

/// Returns the mean expanded uncertainty, K.
pub fn u_k(misses: &[Miss]) -> Option<f64> {
    mean(misses.iter().map(|it| it.u_k))
}

/// Returns the share of values whose uncertainty covers the truth, percent.
pub fn coverage_pct(misses: &[Miss]) -> Option<f64> {
    let covered = misses
        .iter()
        .filter(|it| it.error_k.abs() <= it.u_k)
        .count();
    percent(covered as u64, misses.len() as u64)
}
