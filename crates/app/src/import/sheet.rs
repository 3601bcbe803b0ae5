//! Reads the first sheet of a spreadsheet, or a named one, as records: xlsx, xlsm, xlsb, xls, ods.
//!
//! A number becomes the shortest text that reads back as the same number. A date becomes RFC 3339 in the time zone of
//! this computer, because a spreadsheet has no time zone. Empty rows are skipped; the others keep their row numbers.

use anyhow::Context;
use calamine::{Data, Reader, open_workbook_auto};
use history::csv::Record;
use history::report::sheet::EPOCH_DAYS;
use jiff::Timestamp;
use jiff::tz::TimeZone;
use std::path::Path;

/// File name extensions of spreadsheets.
const ENDINGS: [&str; 5] = ["xlsx", "xlsm", "xlsb", "xls", "ods"];

/// Returns true when the file has an extension of a spreadsheet.
pub(super) fn is_spreadsheet(file: &Path) -> bool {
    let ending = file.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    ending.is_some_and(|it| ENDINGS.iter().any(|known| it == *known))
}

/// Returns the header and the rows that are not empty.
pub(super) fn records(
    file: &Path,
    sheet: Option<&str>,
    zone: &TimeZone,
) -> anyhow::Result<Vec<Record>> {
    let mut book = open_workbook_auto(file).context("expected a spreadsheet")?;
    let names = book.sheet_names();
    let name = match sheet {
        None => names.first().context("the spreadsheet has no sheet")?,
        Some(asked) => names.iter().find(|name| *name == asked).with_context(|| {
            format!(
                "--sheet: found {asked:?}, expected one of {}",
                names.join(", ")
            )
        })?,
    };
    let cells = book
        .worksheet_range(name)
        .with_context(|| format!("sheet {name}"))?;
    let first = cells.start().map_or(0, |(row, _)| row as usize) + 1;
    let records = cells.rows().enumerate().map(|(at, row)| Record {
        line: first + at,
        fields: row.iter().map(|cell| text(cell, zone)).collect(),
    });
    Ok(records
        .filter(|it| it.fields.iter().any(|field| !field.is_empty()))
        .collect())
}

fn text(cell: &Data, zone: &TimeZone) -> String {
    match cell {
        Data::Empty => String::new(),
        Data::DateTime(at) if at.is_datetime() => {
            instant(at.as_f64(), zone).unwrap_or_else(|| cell.to_string())
        }
        other => other.to_string(),
    }
}

/// Converts a spreadsheet's date, in days, to RFC 3339; `None` beyond the range of the calendar.
fn instant(days: f64, zone: &TimeZone) -> Option<String> {
    let microseconds = ((days - EPOCH_DAYS) * 86_400e6).round() as i64;
    let civil = Timestamp::from_microsecond(microseconds)
        .ok()?
        .to_zoned(TimeZone::UTC)
        .datetime();
    let zoned = civil.to_zoned(zone.clone()).ok()?;
    Some(zoned.timestamp().to_string())
}
