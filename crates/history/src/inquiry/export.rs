//! All parts that a filter leaves, as CSV or as a spreadsheet; memory does not grow with their number.

use super::Result;
use crate::columns::{self, Cell};
use crate::report::Lang;
use crate::report::sheet::Sheet;
use crate::{Archive, Filter, csv};
use jiff::tz::TimeZone;
use rust_xlsxwriter::Workbook;
use std::io::Write;

/// One line per part under the header. Reads back with `history import`. A text never becomes a formula.
pub fn csv_lines(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    out: &mut impl Write,
) -> Result<()> {
    let header = columns::header(parameters);
    csv::write(out, &header)?;
    archive.each(filter, |part| {
        let cells = columns::row(&part, parameters).map(|cell| match cell {
            Cell::Text(text) => csv::escape_formula(&text).into_owned(),
            figure => figure.to_string(),
        });
        csv::write(out, cells)
    })??;
    Ok(())
}

/// A spreadsheet with a summary and native charts; `each` hears of every part that was written.
pub fn spreadsheet(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    language: Lang,
    mut each: impl FnMut(),
) -> Result<Workbook> {
    let mut sheet = Sheet::new(language, TimeZone::system(), parameters)?;
    archive.each(filter, |part| {
        each();
        sheet.part(&part)
    })??;
    Ok(sheet.finish()?)
}
