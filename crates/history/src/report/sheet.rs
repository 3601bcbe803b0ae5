//! Spreadsheet of an export: a summary with native charts, then one row per part.
//!
//! Memory does not grow with the number of parts: the library writes rows to a temporary file, and only a [`Tally`] per
//! parameter stays in memory. After [`ROWS`] rows a new sheet begins. Texts are written as texts, never as formulas.

use super::Paper;
use super::words::parameter;
use crate::columns::{self, Cell};
use crate::{Moment, Part};
use jiff::tz::TimeZone;
use jiff::{Timestamp, Unit};
use quality::ordered::Histogram;
use quality::tally::Tally;
use rust_xlsxwriter::{Chart, ChartType, Color, Format, Workbook, Worksheet, XlsxError};
use std::collections::BTreeMap;

/// Largest number of parts on one sheet; a spreadsheet can hold 1,048,576 rows.
const ROWS: u32 = 1_000_000;
/// 1 January 1970 in days, as spreadsheets count them.
pub const EPOCH_DAYS: f64 = 25_569.0;
/// Height of a chart, in rows of the summary.
const CHART_ROWS: u32 = 16;

/// Column of the charts in the summary.
const CHART_COLUMN: u16 = 7;

/// A spreadsheet under construction.
pub struct Sheet {
    workbook: Workbook,
    paper: Paper,
    time: Format,
    keys: Vec<String>,
    tallies: Vec<Tally>,
    bins: BTreeMap<String, u64>,
    sheets: usize,
    row: u32,
}

impl Sheet {
    /// Makes a spreadsheet with columns for these parameters, headed SIMULATION for simulated parts.
    pub fn new(paper: &Paper, parameters: &[String]) -> Result<Self, XlsxError> {
        let mut workbook = Workbook::new();
        let summary = workbook.add_worksheet();
        summary.set_name(paper.language.text("paper-summary"))?;
        if paper.simulated {
            let simulation = paper.language.text("simulation");
            let large = Format::new().set_bold().set_font_color(Color::Red);
            summary.write_string_with_format(0, CHART_COLUMN, simulation, &large)?;
        }
        head(summary, paper);
        let mut sheet = Self {
            workbook,
            paper: paper.clone(),
            time: Format::new().set_num_format("yyyy-mm-dd hh:mm:ss"),
            keys: parameters.to_vec(),
            tallies: vec![Tally::default(); parameters.len()],
            bins: BTreeMap::new(),
            sheets: 0,
            row: 0,
        };
        sheet.next_sheet()?;
        Ok(sheet)
    }

    /// Adds a part.
    pub fn part(&mut self, part: &Part) -> Result<(), XlsxError> {
        if self.row > ROWS {
            self.next_sheet()?;
        }
        let to = self.workbook.worksheet_from_index(self.sheets)?;
        for (column, cell) in (0..).zip(columns::row(part, &self.keys)) {
            written(
                to,
                (self.row, column),
                &cell,
                (&self.paper.zone, &self.time),
            )?;
        }
        for (key, tally) in self.keys.iter().zip(&mut self.tallies) {
            let value = part.values.get(key).and_then(serde_json::Value::as_f64);
            value.into_iter().for_each(|value| tally.add(value));
        }
        let bin = part.bin.as_deref().unwrap_or_default();
        *self.bins.entry(bin.to_owned()).or_default() += 1;
        self.row += 1;
        Ok(())
    }

    /// Writes the summary and returns the workbook.
    pub fn finish(mut self) -> Result<Workbook, XlsxError> {
        let language = self.paper.language;
        let name = language.text("paper-summary").to_owned();
        let bold = Format::new().set_bold();
        let to = self.workbook.worksheet_from_index(0)?;
        let header = [
            language.text("paper-sheet_parameter"),
            "n",
            language.text("paper-sheet_mean"),
            language.text("paper-sheet_sd"),
            language.text("paper-sheet_min"),
            language.text("paper-sheet_max"),
        ];
        for (column, text) in (0..).zip(header) {
            to.write_string_with_format(0, column, text, &bold)?;
        }
        to.set_column_width(0, 28)?;
        let mut row = 1;
        let mut histograms = Vec::new();
        for (key, tally) in self.keys.iter().zip(self.tallies) {
            let (spread, histogram) = tally.finish();
            to.write_string(row, 0, parameter(language, key))?;
            to.write_number(row, 1, spread.n() as f64)?;
            let figures = [spread.mean(), spread.sd(), spread.min(), spread.max()];
            for (column, value) in (2..).zip(figures) {
                number(to, row, column, value)?;
            }
            row += 1;
            histograms.extend(histogram.map(|it| (parameter(language, key), it)));
        }
        row += 1;
        let bins: Vec<(String, u64)> = self
            .bins
            .into_iter()
            .map(|(bin, n)| (language.name("bin", &bin).to_owned(), n))
            .collect();
        let title = language.text("paper-parts_bin");
        let mut next = counted(to, &name, row, title, &bins)?;
        for (title, histogram) in histograms {
            next = counted(to, &name, next, &title, &classes(&histogram))?;
        }
        Ok(self.workbook)
    }

    fn next_sheet(&mut self) -> Result<(), XlsxError> {
        self.sheets += 1;
        let name = self.paper.language.text("paper-sheet_parts");
        let name = match self.sheets {
            1 => name.to_owned(),
            more => format!("{name} {more}"),
        };
        let bold = Format::new().set_bold();
        let to = self.workbook.add_worksheet_with_constant_memory()?;
        to.set_name(name)?;
        head(to, &self.paper);
        to.set_freeze_panes(1, 0)?;
        to.set_column_width(0, 19)?;
        for (column, name) in (0..).zip(columns::header(&self.keys)) {
            to.write_string_with_format(0, column, name, &bold)?;
        }
        self.row = 1;
        Ok(())
    }
}

/// Puts SIMULATION at the head of the printed sheet of simulated parts.
fn head(sheet: &mut Worksheet, paper: &Paper) {
    if paper.simulated {
        let simulation = paper.language.text("simulation");
        sheet.set_header(format!("&C&\"Arial,Bold\"&24{simulation}"));
    }
}

/// Writes a table of counts with a column chart beside it. Returns the first row below both.
fn counted(
    to: &mut Worksheet,
    sheet: &str,
    row: u32,
    title: &str,
    counts: &[(String, u64)],
) -> Result<u32, XlsxError> {
    to.write_string_with_format(row, 0, title, &Format::new().set_bold())?;
    let first = row + 1;
    for (row, (name, n)) in (first..).zip(counts) {
        to.write_string(row, 0, name)?;
        to.write_number(row, 1, *n as f64)?;
    }
    let Some(last) = (counts.len() as u32).checked_sub(1).map(|it| first + it) else {
        return Ok(first + 1);
    };
    let mut chart = Chart::new(ChartType::Column);
    chart
        .add_series()
        .set_categories((sheet, first, 0, last, 0))
        .set_values((sheet, first, 1, last, 1))
        .set_gap(8);
    chart.title().set_name(title);
    chart.legend().set_hidden();
    chart.set_width(560).set_height(300);
    to.insert_chart(row, CHART_COLUMN, &chart)?;
    Ok((last + 2).max(row + CHART_ROWS))
}

/// Returns the count of each class; the name of a class is its lower edge.
fn classes(it: &Histogram) -> Vec<(String, u64)> {
    let edge = |at: usize| super::plot::ticked(it.from + at as f64 * it.width, it.width);
    it.counts
        .iter()
        .enumerate()
        .map(|(at, n)| (edge(at), *n))
        .collect()
}

/// Writes a cell; leaves it empty for an instant beyond the range of the calendar.
fn written(
    to: &mut Worksheet,
    (row, column): (u32, u16),
    cell: &Cell<'_>,
    (zone, time): (&TimeZone, &Format),
) -> Result<(), XlsxError> {
    match cell {
        Cell::Empty => {}
        Cell::Text(text) if text.is_empty() => {}
        Cell::Text(text) => {
            to.write_string(row, column, text.as_ref())?;
        }
        Cell::Count(count) => {
            to.write_number(row, column, *count as f64)?;
        }
        Cell::Number(number) => {
            to.write_number(row, column, *number)?;
        }
        Cell::Time(at) => {
            if let Some(at) = serial(*at, zone) {
                to.write_number_with_format(row, column, at, time)?;
            }
        }
    }
    Ok(())
}

fn number(to: &mut Worksheet, row: u32, column: u16, value: Option<f64>) -> Result<(), XlsxError> {
    if let Some(value) = value.filter(|it| it.is_finite()) {
        to.write_number(row, column, value)?;
    }
    Ok(())
}

/// Converts an instant to the serial date of a spreadsheet: local time in days, to the second; `None` beyond the range
/// of the calendar.
fn serial(at: Moment, zone: &TimeZone) -> Option<f64> {
    let stamp = Timestamp::from_microsecond(at.0).ok()?;
    let stamp = stamp.round(Unit::Second).ok()?;
    let local = stamp.as_second() + i64::from(zone.to_offset(stamp).seconds());
    Some(local as f64 / 86_400.0 + EPOCH_DAYS)
}
