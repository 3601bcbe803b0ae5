//! Errors of one parameter against the truth, over good parts.
//!
//! The units are those of the bars: ohm in percent of the true value, volt in mV, all else as its key says.
//! Covered means `|value - truth| <= U`, `U` expanded with k = 2; a value without an uncertainty covers nothing.

use super::lot::{Lot, Part, Reading};
use machine::dut::em_relay::Parameter;
use quality::Spread;
use quality::spread::median;
use units::Unit;

/// Unit of the error of a parameter in reports.
pub fn unit(parameter: Parameter) -> &'static str {
    match parameter.facts().definition.unit {
        Unit::Ohm => "%",
        Unit::Volt => "mV",
        unit => unit.symbol(),
    }
}

/// The error of a reading in [`unit`].
pub fn error(parameter: Parameter, reading: &Reading) -> f64 {
    let difference = reading.value - reading.truth;
    match parameter.facts().definition.unit {
        Unit::Ohm => 100.0 * difference / reading.truth,
        Unit::Volt => 1000.0 * difference,
        _ => difference,
    }
}

/// Errors of one parameter in one lot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Errors {
    spread: Spread,
    covered: u64,
}

impl Errors {
    /// Of the good parts of a lot.
    pub fn of(parameter: Parameter, lot: &Lot) -> Self {
        let readings: Vec<Reading> = lot
            .good()
            .filter_map(|part| part.reading(parameter))
            .collect();
        Self {
            covered: readings
                .iter()
                .filter(|reading| is_covered(reading))
                .count() as u64,
            ..Self::listed(readings.iter().map(|reading| error(parameter, reading)))
        }
    }

    /// Of errors without an uncertainty beside them.
    fn listed(errors: impl Iterator<Item = f64>) -> Self {
        Self {
            spread: Spread::of(&errors.collect::<Vec<f64>>()),
            covered: 0,
        }
    }

    /// Number of values.
    pub fn n(&self) -> u64 {
        self.spread.n()
    }

    /// Mean error.
    pub fn bias(&self) -> Option<f64> {
        self.spread.mean()
    }

    /// Root of the mean square: `rms^2 = mean^2 + sd^2 (n - 1) / n`.
    pub fn rms(&self) -> Option<f64> {
        let mean = self.spread.mean()?;
        let n = self.n() as f64;
        let sd = self.spread.sd().unwrap_or(0.0);
        Some((mean * mean + sd * sd * (n - 1.0) / n).sqrt())
    }

    /// Greatest error, as an absolute value.
    pub fn worst(&self) -> Option<f64> {
        Some(self.spread.min()?.abs().max(self.spread.max()?.abs()))
    }
}

fn is_covered(reading: &Reading) -> bool {
    reading
        .uncertainty
        .is_some_and(|u| (reading.value - reading.truth).abs() <= u)
}

/// Errors of one parameter in every lot of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Pooled(Vec<Errors>);

impl Pooled {
    /// Of the good parts of all lots.
    pub fn of(parameter: Parameter, lots: &[Lot]) -> Self {
        Self(lots.iter().map(|lot| Errors::of(parameter, lot)).collect())
    }

    /// Of good parts of all lots, of those for which `error` has one.
    pub fn by(lots: &[Lot], error: impl Fn(&Part) -> Option<f64>) -> Self {
        let of = |lot: &Lot| Errors::listed(lot.good().filter_map(&error));
        Self(lots.iter().map(of).collect())
    }

    /// Number of values in all lots.
    pub fn n(&self) -> u64 {
        self.0.iter().map(Errors::n).sum()
    }

    /// Median over lots of the rms error; none when a lot has no value at all.
    pub fn median_rms(&self) -> Option<f64> {
        let each: Option<Vec<f64>> = self.0.iter().map(Errors::rms).collect();
        median(&each?)
    }

    /// Greatest rms error of a lot.
    pub fn worst_rms(&self) -> Option<f64> {
        self.0.iter().filter_map(Errors::rms).reduce(f64::max)
    }

    /// Median over lots of the mean error.
    pub fn median_bias(&self) -> Option<f64> {
        let each: Vec<f64> = self.0.iter().filter_map(Errors::bias).collect();
        median(&each)
    }

    /// Greatest error of any part.
    pub fn worst(&self) -> Option<f64> {
        self.0.iter().filter_map(Errors::worst).reduce(f64::max)
    }

    /// Percent of all values whose stated uncertainty covers the truth.
    pub fn coverage_pct(&self) -> Option<f64> {
        let covered: u64 = self.0.iter().map(|errors| errors.covered).sum();
        percent(covered, self.n())
    }

    /// Least coverage of a lot, percent.
    pub fn worst_coverage_pct(&self) -> Option<f64> {
        self.0
            .iter()
            .filter_map(|errors| percent(errors.covered, errors.n()))
            .reduce(f64::min)
    }
}

/// Returns the share in percent; none when `all` is 0.
pub fn percent(some: u64, all: u64) -> Option<f64> {
    (all > 0).then(|| 100.0 * some as f64 / all as f64)
}
