//! Buffer of readings with the source level of each.

use crate::scpi::instrument::Outcome;
use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

/// Time to send one point, microseconds.
const POINT_US: u64 = 20;

/// Source level and reading of each point, oldest first.
#[derive(Default)]
pub(super) struct Buffer(Vec<(f64, f64)>);

impl Buffer {
    pub(super) fn push(&mut self, level: f64, read: f64) {
        self.0.push((level, read));
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns the last reading.
    ///
    /// # Errors
    /// Fails with -230 when the buffer is empty.
    pub(super) fn last(&self) -> Result<f64, Failure> {
        let (_, read) = self.0.last().ok_or(Failure::DATA_STALE)?;
        Ok(*read)
    }

    /// Answers `TRACe:DATA?`: first and last point from 1, name of the buffer, columns.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    pub(super) fn data(&self, unit: &Unit) -> Result<Outcome, Failure> {
        let (from, to) = match unit.parameters.len() {
            0 => (1, self.0.len()),
            _ => (
                unit.number(0, 1.0, 1e6, 1.0)? as usize,
                unit.number(1, 1.0, 1e6, 1.0)? as usize,
            ),
        };
        let points = self.0.get(from - 1..to).ok_or(Failure::OUT_OF_RANGE)?;
        let mut columns: Vec<bool> = Vec::new();
        for number in 3..unit.parameters.len() {
            columns.push(match unit.word(number)?.as_str() {
                "SOUR" | "SOURCE" => true,
                "READ" | "READING" => false,
                _ => return Err(Failure::ILLEGAL_VALUE),
            });
        }
        if columns.is_empty() {
            columns.push(false);
        }
        let row = |(source, read): &(f64, f64)| {
            let cell = |is_source: &bool| nr3(if *is_source { *source } else { *read });
            columns.iter().map(cell).collect::<Vec<_>>().join(",")
        };
        let text = points.iter().map(row).collect::<Vec<_>>().join(",");
        Ok(Outcome::Text(text, POINT_US * points.len() as u64))
    }

    /// Answers a query of `TRACe:STATistics`.
    ///
    /// # Errors
    /// Fails with -113 for an unknown statistic, with -230 when the buffer is empty.
    pub(super) fn statistic(&self, unit: &Unit) -> Result<f64, Failure> {
        let is = |name: &str| unit.matches(&format!(":TRACe:STATistics:{name}")).is_some();
        let reads = || self.0.iter().map(|(_, read)| *read);
        let count = self.0.len() as f64;
        let mean = reads().sum::<f64>() / count;
        let value = if is("AVERage") {
            mean
        } else if is("MAXimum") {
            reads().fold(f64::MIN, f64::max)
        } else if is("MINimum") {
            reads().fold(f64::MAX, f64::min)
        } else if is("STDDev") {
            let squares: f64 = reads().map(|read| (read - mean).powi(2)).sum();
            (squares / (count - 1.0).max(1.0)).sqrt()
        } else {
            return Err(Failure::UNDEFINED_HEADER);
        };
        self.last().map(|_| value)
    }
}
