//! The first (or a named) sheet of a spreadsheet as records: xlsx, xlsm, xlsb, xls, ods.
//!
//! Numbers come as the shortest text that reads back the same, dates as RFC 3339 in the zone of this
//! computer (a spreadsheet has no zone). A row without any content is passed over; the others keep the
//! number that the spreadsheet shows beside them.

use anyhow::Context;
use calamine::{Data, Reader, open_workbook_auto};
use history::csv::Record;
use jiff::Timestamp;
use jiff::tz::TimeZone;
use std::path::Path;

/// Ends of the names that are taken for spreadsheets.
const ENDINGS: [&str; 5] = ["xlsx", "xlsm", "xlsb", "xls", "ods"];
/// Days from the epoch of spreadsheets to 1970.
const EPOCH_DAYS: f64 = 25_569.0;

/// Whether the file is named as a spreadsheet.
pub(super) fn is_named_so(file: &Path) -> bool {
    let ending = file.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    ending.is_some_and(|it| ENDINGS.iter().any(|known| it == *known))
}

/// Header first, then the rows.
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

/// Days of a spreadsheet as RFC 3339; none beyond the calendar.
fn instant(days: f64, zone: &TimeZone) -> Option<String> {
    let microseconds = ((days - EPOCH_DAYS) * 86_400e6).round() as i64;
    let civil = Timestamp::from_microsecond(microseconds)
        .ok()?
        .to_zoned(TimeZone::UTC)
        .datetime();
    let zoned = civil.to_zoned(zone.clone()).ok()?;
    Some(zoned.timestamp().to_string())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use rust_xlsxwriter::{ExcelDateTime, Format, Workbook};

    #[test]
    fn a_sheet_becomes_records_with_the_numbers_of_its_rows() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("old.xlsx");
        let mut book = Workbook::new();
        book.add_worksheet().set_name("封面").unwrap();
        let sheet = book.add_worksheet();
        sheet.set_name("数据").unwrap();
        sheet.write_row(0, 0, ["time", "Uop", "serial"]).unwrap();
        let at = ExcelDateTime::parse_from_str("2019-07-01 08:30:00").unwrap();
        let format = Format::new().set_num_format("yyyy-mm-dd hh:mm:ss");
        sheet.write_datetime_with_format(2, 0, at, &format).unwrap();
        sheet.write_number(2, 1, 7.1).unwrap();
        sheet.write_string(2, 2, "甲-1").unwrap();
        book.save(&file).unwrap();
        let zone = TimeZone::fixed(jiff::tz::offset(8));
        let found = records(&file, Some("数据"), &zone).unwrap();
        assert_eq!(found[0].fields, ["time", "Uop", "serial"]);
        assert_eq!(found[1].fields, ["2019-07-01T00:30:00Z", "7.1", "甲-1"]);
        assert_eq!(found.iter().map(|it| it.line).collect::<Vec<_>>(), [1, 3]);
        let refusal = records(&file, Some("x"), &zone).unwrap_err().to_string();
        assert!(refusal.contains("expected one of 封面, 数据"), "{refusal}");
    }

    #[test]
    fn a_file_is_taken_for_what_its_name_says() {
        assert!(is_named_so(Path::new("老数据.XLSX")) && is_named_so(Path::new("a.ods")));
        assert!(!is_named_so(Path::new("a.csv")) && !is_named_so(Path::new("-")));
    }
}
