//! Tests the import of spreadsheets from an older system.
#![allow(clippy::unwrap_used)]

use super::sheet::{is_spreadsheet, records};
use jiff::tz::TimeZone;
use rust_xlsxwriter::{ExcelDateTime, Format, Workbook};
use std::path::Path;

#[test]
fn a_sheet_becomes_records_with_its_row_numbers() {
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
fn the_extension_names_a_spreadsheet() {
    assert!(is_spreadsheet(Path::new("老数据.XLSX")) && is_spreadsheet(Path::new("a.ods")));
    assert!(!is_spreadsheet(Path::new("a.csv")) && !is_spreadsheet(Path::new("-")));
}
