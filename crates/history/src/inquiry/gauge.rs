//! Reads the measurements of a gauge study from CSV.

use crate::csv::{self, CsvError};
use quality::Reading;

/// Columns of the file, in any order.
const COLUMNS: [&str; 4] = ["part", "operator", "trial", "value"];

/// Reason why a file holds no study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The text is not CSV.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The header lacks a column.
    #[error("line 1: column {name} is missing; expected part, operator, trial, value")]
    NoColumn {
        /// Name of the column.
        name: &'static str,
    },
    /// A value is not a finite number.
    #[error("line {line}, column value: found {found:?}, expected a finite number")]
    Value {
        /// Line of the file, from 1.
        line: usize,
        /// Text of the cell.
        found: String,
    },
}

/// Reads the readings from CSV with the columns part, operator, trial and value.
///
/// # Errors
/// Fails when a column is missing or a value is not a finite number; the error names the line.
pub fn read_csv(text: &str) -> Result<Vec<Reading>, StudyError> {
    let records = csv::read(text)?;
    let (header, rows) = match records.split_first() {
        Some((header, rows)) => (header.fields.as_slice(), rows),
        None => (&[][..], &[][..]),
    };
    let mut at = [0; COLUMNS.len()];
    for (at, name) in at.iter_mut().zip(COLUMNS) {
        let found = header
            .iter()
            .position(|it| it.trim().eq_ignore_ascii_case(name));
        *at = found.ok_or(StudyError::NoColumn { name })?;
    }
    let readings = rows.iter().map(|row| {
        let [part, operator, trial, value] = at.map(|at| row.fields[at].trim());
        let number = value.parse().ok().filter(|it: &f64| it.is_finite());
        Ok(Reading {
            part: part.to_owned(),
            operator: operator.to_owned(),
            trial: trial.to_owned(),
            value: number.ok_or_else(|| StudyError::Value {
                line: row.line,
                found: value.to_owned(),
            })?,
        })
    });
    readings.collect()
}
