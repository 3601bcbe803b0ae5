//! Errors of one characteristic against the truth, over good parts.
//!
//! The kind of part states the unit of the error of each characteristic ([`ErrorUnit`]). The uncertainty U (k = 2) of a
//! value covers the truth when `|value - truth| <= U`; a value without an uncertainty does not cover the truth.

use super::figure::percent;
use super::lot::{Lot, Part, Reading};
use machine::dut::Characteristic;
use machine::dut::characteristic::ErrorUnit;
use quality::Spread;
use quality::spread::median;

/// Returns how errors of a characteristic are stated.
fn stated(characteristic: Characteristic) -> ErrorUnit {
    // The unit does not depend on the rated voltage.
    let accepted = characteristic.accepted_error(Some(1.0));
    accepted.map_or(ErrorUnit::Own, |it| it.unit)
}

/// Returns the unit of the error of a characteristic.
pub fn unit(characteristic: Characteristic) -> &'static str {
    match stated(characteristic) {
        ErrorUnit::Percent => "%",
        ErrorUnit::Own => characteristic.unit().symbol(),
        ErrorUnit::Millivolt => "mV",
    }
}

/// Returns the error of a reading in [`unit()`].
pub fn error(characteristic: Characteristic, reading: &Reading) -> f64 {
    let difference = reading.value - reading.truth;
    match stated(characteristic) {
        ErrorUnit::Percent => 100.0 * difference / reading.truth,
        ErrorUnit::Own => difference,
        ErrorUnit::Millivolt => 1000.0 * difference,
    }
}

/// Errors of one characteristic in one lot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Errors {
    spread: Spread,
    covered: u64,
    truths: Spread,
}

impl Errors {
    /// Collects the errors of the good parts of a lot.
    pub fn of(characteristic: Characteristic, lot: &Lot) -> Self {
        let readings = || lot.good().filter_map(|part| part.reading(characteristic));
        let truths: Vec<f64> = readings().map(|reading| reading.truth).collect();
        Self {
            covered: readings().filter(is_covered).count() as u64,
            truths: Spread::of(&truths),
            ..Self::listed(readings().map(|reading| error(characteristic, &reading)))
        }
    }

    /// Collects the given errors; their values have no uncertainty and thus no coverage, and no truth.
    fn listed(errors: impl Iterator<Item = f64>) -> Self {
        Self {
            spread: Spread::of(&errors.collect::<Vec<f64>>()),
            ..Self::default()
        }
    }

    /// Returns the number of values.
    pub fn n(&self) -> u64 {
        self.spread.n()
    }

    /// Returns the mean error.
    pub fn bias(&self) -> Option<f64> {
        self.spread.mean()
    }

    /// Returns the rms error: `rms^2 = mean^2 + sd^2 (n - 1) / n`.
    pub fn rms(&self) -> Option<f64> {
        let mean = self.spread.mean()?;
        let n = self.n() as f64;
        let sd = self.spread.sd().unwrap_or(0.0);
        Some((mean * mean + sd * sd * (n - 1.0) / n).sqrt())
    }

    /// Returns the greatest absolute error.
    pub fn worst(&self) -> Option<f64> {
        Some(self.spread.min()?.abs().max(self.spread.max()?.abs()))
    }
}

fn is_covered(reading: &Reading) -> bool {
    reading
        .uncertainty
        .is_some_and(|u| (reading.value - reading.truth).abs() <= u)
}

/// Errors of one characteristic in every lot of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Pooled(Vec<Errors>);

impl Pooled {
    /// Collects the errors of the good parts of all lots.
    pub fn of(characteristic: impl Into<Characteristic>, lots: &[Lot]) -> Self {
        let characteristic = characteristic.into();
        Self(
            lots.iter()
                .map(|lot| Errors::of(characteristic, lot))
                .collect(),
        )
    }

    /// Collects the errors that `error` returns for the good parts of all lots.
    pub fn by(lots: &[Lot], error: impl Fn(&Part) -> Option<f64>) -> Self {
        let of = |lot: &Lot| Errors::listed(lot.good().filter_map(&error));
        Self(lots.iter().map(of).collect())
    }

    /// Returns the number of values in all lots.
    pub fn n(&self) -> u64 {
        self.0.iter().map(Errors::n).sum()
    }

    /// Returns the median over lots of the rms error; `None` when a lot has no value.
    pub fn median_rms(&self) -> Option<f64> {
        let each: Option<Vec<f64>> = self.0.iter().map(Errors::rms).collect();
        median(&each?)
    }

    /// Returns the rms error of the worst lot.
    pub fn worst_rms(&self) -> Option<f64> {
        self.0.iter().filter_map(Errors::rms).reduce(f64::max)
    }

    /// Returns the median over lots of the mean error.
    pub fn median_bias(&self) -> Option<f64> {
        let each: Vec<f64> = self.0.iter().filter_map(Errors::bias).collect();
        median(&each)
    }

    /// Returns the median over lots of the mean true value, in the unit of the characteristic.
    pub fn median_truth(&self) -> Option<f64> {
        let each: Vec<f64> = self.0.iter().filter_map(|it| it.truths.mean()).collect();
        median(&each)
    }

    /// Returns the greatest absolute error of any part.
    pub fn worst(&self) -> Option<f64> {
        self.0.iter().filter_map(Errors::worst).reduce(f64::max)
    }

    /// Returns the share of all values whose stated uncertainty covers the truth, percent.
    pub fn coverage_pct(&self) -> Option<f64> {
        let covered: u64 = self.0.iter().map(|errors| errors.covered).sum();
        percent(covered, self.n())
    }

    /// Returns the least coverage of any lot, percent.
    pub fn worst_coverage_pct(&self) -> Option<f64> {
        let each = self.0.iter();
        let covered = each.filter_map(|errors| percent(errors.covered, errors.n()));
        covered.reduce(f64::min)
    }
}
