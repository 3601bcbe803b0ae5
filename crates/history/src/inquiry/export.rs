//! Exports the selected parts as CSV or spreadsheet; the memory needed does not grow with their number.

use super::Result;
use crate::columns::{self, Cell};
use crate::report::Paper;
use crate::report::sheet::Sheet;
use crate::{Archive, Filter, csv};
use rust_xlsxwriter::Workbook;
use std::io::Write;

/// Writes the header and one line per part. `history import` can read the file back; no text acts as a formula.
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

/// Returns a spreadsheet with a summary and native charts; calls `each` for every part.
pub fn spreadsheet(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    paper: &Paper,
    mut each: impl FnMut(),
) -> Result<Workbook> {
    let mut sheet = Sheet::new(paper, parameters)?;
    archive.each(filter, |part| {
        each();
        sheet.part(&part)
    })??;
    Ok(sheet.finish()?)
}
