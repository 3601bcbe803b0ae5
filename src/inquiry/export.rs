//! All parts that a filter leaves, as CSV or as a spreadsheet; memory does not grow with their number.

use super::Result;
use crate::history::{Archive, Filter, columns, csv};
use crate::report::Language;
use crate::report::sheet::Sheet;
use jiff::tz::TimeZone;
use rust_xlsxwriter::Workbook;
use std::io::Write;

/// One line per part under the header. Reads back with `history import`.
pub fn csv_lines(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    out: &mut impl Write,
) -> Result<()> {
    let header = columns::header(parameters);
    csv::write(out, header.iter().map(String::as_str))?;
    archive.each(filter, |part| {
        let cells: Vec<String> = columns::row(&part, parameters)
            .map(|cell| cell.to_string())
            .collect();
        csv::write(out, cells.iter().map(String::as_str))
    })??;
    Ok(())
}

/// A spreadsheet with a summary and native charts; `each` hears of every part that was written.
pub fn spreadsheet(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    language: Language,
    mut each: impl FnMut(),
) -> Result<Workbook> {
    let mut sheet = Sheet::new(language, TimeZone::system(), parameters)?;
    archive.each(filter, |part| {
        each();
        sheet.part(&part)
    })??;
    Ok(sheet.finish()?)
}
