//! Errors of the estimates against the truth, and whether the stated uncertainty covers them.

use super::rig::Outcome;
use crate::figure::{mean, percent, rms};
use machine::dut::batch::SocketResult;
use machine::dut::thermostat::Parameter;

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
    let miss = |(found, [operate_c, reset_c]): &(SocketResult, [f64; 2])| {
        let (of, truth) = match quantity {
            Quantity::Operate => (Parameter::Operate, *operate_c),
            Quantity::Reset => (Parameter::Reset, *reset_c),
            Quantity::Differential => (Parameter::Differential, operate_c - reset_c),
        };
        let reading = found.record.each(of).next()?;
        Some(Miss {
            error_k: reading.value - truth,
            u_k: reading.budget.expanded(),
        })
    };
    outcomes
        .into_iter()
        .flat_map(|it| &it.parts)
        .filter_map(miss)
        .collect()
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
