//! Imports CSV files: reads and checks the whole file before the first row is written.
//!
//! The header names parameter keys, and optionally `time` (RFC 3339), `verdict`, `serial` and `bin`. An empty cell
//! means that the value was not measured. The import ignores columns that only the export writes (`lot`, `seq`,
//! `uncertainty ...`), so that it takes an exported file. The import refuses any other unknown column, because a
//! misspelt key would lose its values unnoticed.

use super::columns::{UNCERTAINTY, VERDICT};
use super::csv::{self, CsvError, Record};
use super::inquiry::checks::VERDICTS;
use super::{MeasurementRecord, Moment, PartRecord};
use machine::dut::{External, Reason};

/// Columns of an export that an import ignores.
const IGNORED: [&str; 9] = [
    "type",
    "lot",
    "run",
    "kind",
    "seq",
    "recipe",
    "landed_bin",
    "test_s",
    "cycle_s",
];

/// One row of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportRow {
    /// The part, still without lot and number; its time is 0 when the row has no time.
    pub part: PartRecord,
    /// True when the row has a time.
    pub timed: bool,
}

/// Reason why the whole file is refused.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The text is not CSV.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// A column is neither a parameter key nor one of the other known names.
    #[error(
        "line 1: unknown column {found:?}; expected time, verdict, serial, bin or one of {known}"
    )]
    UnknownColumn {
        /// Name of the column.
        found: String,
        /// Accepted parameter keys.
        known: String,
    },
    /// Two columns have the same name.
    #[error("line 1: column {found:?} appears twice")]
    ColumnTwice {
        /// Name of the columns.
        found: String,
    },
    /// The caller renames a column that the file lacks.
    #[error("line 1: there is no column {column:?} to map")]
    NothingToMap {
        /// Name of the missing column.
        column: String,
    },
    /// No column is a parameter.
    #[error("line 1: expected at least one parameter key among the columns")]
    NoParameter,
    /// A cell does not fit its column.
    #[error("line {line}, column {column}: found {found:?}, expected {expected}")]
    Cell {
        /// Line number in the file.
        line: usize,
        /// Name of the column.
        column: String,
        /// Text of the cell.
        found: String,
        /// Accepted values.
        expected: &'static str,
    },
}

/// How a column of the file is read.
enum Column {
    Time,
    Verdict,
    Serial,
    Bin,
    Reasons,
    Parameter,
    Ignored,
}

/// Reads records, of which the first is the header. `maps` renames columns (from, to); `parameters` are the known keys.
pub fn parse_records(
    records: &[Record],
    maps: &[(String, String)],
    parameters: &[String],
) -> Result<Vec<ImportRow>, ImportError> {
    let (header, records) = records.split_first().ok_or(CsvError::Empty)?;
    let names: Vec<String> = header
        .fields
        .iter()
        .map(|name| renamed(name.trim(), maps))
        .collect();
    if let Some((missing, _)) = maps.iter().find(|(_, to)| !names.contains(to)) {
        let column = missing.clone();
        return Err(ImportError::NothingToMap { column });
    }
    let columns = columns(&names, parameters)?;
    records
        .iter()
        .map(|record| row(record, &columns, &names))
        .collect()
}

/// Returns the columns of the header that an import ignores, by their names in the file.
pub fn ignored_columns(records: &[Record]) -> Vec<String> {
    let header = records.first().map(|it| it.fields.iter());
    let names = header.into_iter().flatten().map(|it| it.trim());
    names
        .filter(|it| is_ignored(it))
        .map(str::to_owned)
        .collect()
}

/// Returns true for a column that only an export writes.
fn is_ignored(name: &str) -> bool {
    let is_external = || External::from_key(name).is_some() || name.starts_with(VERDICT);
    IGNORED.contains(&name) || name.starts_with(UNCERTAINTY) || is_external()
}

fn row(record: &Record, columns: &[Column], names: &[String]) -> Result<ImportRow, ImportError> {
    let mut row = ImportRow {
        part: blank(),
        timed: false,
    };
    for ((cell, column), name) in record.fields.iter().zip(columns).zip(names) {
        let cell = cell.trim();
        if cell.is_empty() {
            continue;
        }
        take(&mut row, column, name, cell).map_err(|expected| ImportError::Cell {
            line: record.line,
            column: name.clone(),
            found: cell.to_owned(),
            expected,
        })?;
    }
    Ok(row)
}

fn renamed(name: &str, maps: &[(String, String)]) -> String {
    let to = maps
        .iter()
        .find(|(from, _)| from == name)
        .map(|(_, to)| to.as_str());
    to.unwrap_or(name).to_owned()
}

fn blank() -> PartRecord {
    let (verdict, kind) = ("unjudged".to_owned(), "lot".to_owned());
    PartRecord {
        verdict,
        kind,
        test_s: f64::NAN,
        ..PartRecord::default()
    }
}

fn columns(names: &[String], parameters: &[String]) -> Result<Vec<Column>, ImportError> {
    let columns = names
        .iter()
        .enumerate()
        .map(|(n, name)| {
            if names[..n].contains(name) {
                return Err(ImportError::ColumnTwice {
                    found: name.clone(),
                });
            }
            column(name, parameters)
        })
        .collect::<Result<Vec<_>, _>>()?;
    if columns
        .iter()
        .any(|column| matches!(column, Column::Parameter))
    {
        Ok(columns)
    } else {
        Err(ImportError::NoParameter)
    }
}

fn column(name: &str, parameters: &[String]) -> Result<Column, ImportError> {
    Ok(match name {
        "time" => Column::Time,
        "verdict" => Column::Verdict,
        "serial" => Column::Serial,
        "bin" => Column::Bin,
        "reasons" => Column::Reasons,
        key if parameters.iter().any(|known| known == key) => Column::Parameter,
        name if is_ignored(name) => Column::Ignored,
        other => {
            let (found, known) = (other.to_owned(), parameters.join(", "));
            return Err(ImportError::UnknownColumn { found, known });
        }
    })
}

fn take(row: &mut ImportRow, column: &Column, name: &str, cell: &str) -> Result<(), &'static str> {
    match column {
        Column::Time => {
            let time: Moment = Moment::exact(cell).map_err(|_| "an RFC 3339 time")?;
            row.part.judged_at_us = time.0;
            row.timed = true;
        }
        Column::Verdict => {
            row.part.verdict = verdict(cell).ok_or("pass, fail, void or unjudged")?
        }
        Column::Serial => row.part.serial = Some(csv::unescape_formula(cell).to_owned()),
        Column::Bin => row.part.bin = csv::unescape_formula(cell).to_owned(),
        Column::Reasons => {
            let typed = csv::unescape_formula(cell).split("; ");
            row.part.reasons = typed.map(Reason::from_text).collect();
        }
        Column::Parameter => row.part.measurements.push(measurement(name, cell)?),
        Column::Ignored => {}
    }
    Ok(())
}

fn verdict(cell: &str) -> Option<String> {
    let lower = cell.to_ascii_lowercase();
    VERDICTS.contains(&lower.as_str()).then_some(lower)
}

fn measurement(key: &str, cell: &str) -> Result<MeasurementRecord, &'static str> {
    let value: f64 = cell
        .parse()
        .ok()
        .filter(|it: &f64| it.is_finite())
        .ok_or("a finite number")?;
    let verdict = "unjudged".to_owned();
    let value = Some(value);
    Ok(MeasurementRecord {
        key: key.to_owned(),
        value,
        verdict,
        attempt: 1,
        ..Default::default()
    })
}
