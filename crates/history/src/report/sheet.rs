//! Spreadsheet of an export: a summary with native charts, then one row per part.
//!
//! Headings and texts are in the language of the paper (in CSV they are keys and codes); numbers show as many digits as
//! on paper. Memory does not grow with the number of parts: the library writes rows to a temporary file, and only a
//! [`Tally`] per parameter stays in memory. After [`ROWS`] rows a new sheet begins. Texts are written as texts, never
//! as formulas.

use super::Paper;
use super::sheet_cells::{Formats, written};
use super::words::{doubt_decimals, parameter};
use crate::Part;
use crate::columns;
use machine::dut::External;
use quality::capability::D2_PAIR;
use quality::ordered::Histogram;
use quality::tally::Tally;
use quality::{Capability, Limits};
use rust_xlsxwriter::{Chart, ChartType, Color, Format, Workbook, Worksheet, XlsxError};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::iter::repeat;
use texts::Lang;

/// Largest number of parts on one sheet; a spreadsheet can hold 1,048,576 rows.
const ROWS: u32 = 1_000_000;
/// 1 January 1970 in days, as spreadsheets count them.
pub const EPOCH_DAYS: f64 = 25_569.0;
/// Height of a chart, in rows of the summary.
const CHART_ROWS: u32 = 16;

/// Column of the charts in the summary, right of the figures.
const CHART_COLUMN: u16 = 12;

/// Facts about the parts of a spreadsheet, for its summary.
#[derive(Debug, Clone, Default)]
pub struct SheetFacts {
    /// Facts by name, such as the filter and the recipes.
    pub facts: Vec<(String, String)>,
    /// Limits of each parameter, in the order of the columns.
    pub limits: Vec<Limits>,
}

/// Figures of one parameter over the parts written so far.
#[derive(Debug, Clone, Default)]
struct Figures {
    tally: Tally,
    /// Sum of the absolute differences between successive values.
    ranges: f64,
    last: Option<f64>,
}

impl Figures {
    fn add(&mut self, value: f64) {
        let range = self.last.replace(value).map(|last| (value - last).abs());
        self.ranges += range.unwrap_or(0.0);
        self.tally.add(value);
    }
}

/// A spreadsheet under construction.
pub struct Sheet {
    workbook: Workbook,
    paper: Paper,
    formats: Formats,
    keys: Vec<String>,
    external: Vec<External>,
    figures: Vec<Figures>,
    bins: BTreeMap<String, u64>,
    sheets: usize,
    row: u32,
}

impl Sheet {
    /// Makes a spreadsheet with columns for these parameters and results from outside of the rig, headed SIMULATION for
    /// simulated parts.
    pub fn new(
        paper: &Paper,
        parameters: &[String],
        external: &[External],
    ) -> Result<Self, XlsxError> {
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
            formats: Formats::new(),
            keys: parameters.to_vec(),
            external: external.to_vec(),
            figures: vec![Figures::default(); parameters.len()],
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
        let (row, zone) = (self.row, &self.paper.zone);
        let texts = columns::texts_in(part, self.paper.language);
        for (column, cell) in (0..).zip(texts) {
            written(to, (row, column), &cell, (zone, &self.formats))?;
        }
        let first = columns::COLUMNS.len() as u16;
        let count = self.keys.len() as u16;
        for ((column, key), figures) in (first..).zip(&self.keys).zip(&mut self.figures) {
            let number = |of: &Map<String, Value>| of.get(key).and_then(Value::as_f64);
            let (value, doubt) = (number(&part.values), number(&part.uncertainty));
            let decimals = doubt.filter(|it| *it > 0.0).map(doubt_decimals);
            for (column, value) in [(column, value), (column + count, doubt)] {
                self.formats.number(to, (row, column), value, decimals)?;
            }
            value.into_iter().for_each(|value| figures.add(value));
        }
        let external = columns::external_in(part, &self.external, self.paper.language);
        for (column, cell) in (first + 2 * count..).zip(external) {
            written(to, (row, column), &cell, (zone, &self.formats))?;
        }
        let bin = part.bin.as_deref().unwrap_or_default();
        *self.bins.entry(bin.to_owned()).or_default() += 1;
        self.row += 1;
        Ok(())
    }

    /// Writes the summary and returns the workbook.
    pub fn finish(mut self, about: &SheetFacts) -> Result<Workbook, XlsxError> {
        let language = self.paper.language;
        let name = language.text("paper-summary").to_owned();
        let bold = Format::new().set_bold();
        let to = self.workbook.worksheet_from_index(0)?;
        let header = HEADER.map(|id| language.text(id));
        for (column, text) in (0..).zip(header.into_iter().chain(["Cp", "Cpk", "Ppk"])) {
            to.write_string_with_format(0, column, text, &bold)?;
        }
        to.set_column_width(0, 28)?;
        let mut row = 1;
        let mut histograms = Vec::new();
        let limits = about
            .limits
            .iter()
            .copied()
            .chain(repeat(Limits::default()));
        for ((key, figures), limits) in self.keys.iter().zip(self.figures).zip(limits) {
            let histogram = summary_row(to, row, (language, key), figures, limits, &self.formats)?;
            row += 1;
            histograms.extend(histogram.map(|it| (parameter(language, key), it)));
        }
        row += 1;
        let made = (
            language.text("paper-made").to_owned(),
            self.paper.made.clone(),
        );
        for (name, text) in about.facts.iter().chain([&made]) {
            to.write_string_with_format(row, 0, name, &bold)?;
            to.write_string(row, 1, text)?;
            row += 1;
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
        let language = self.paper.language;
        let external = columns::external_header_in(language, &self.external);
        let names = columns::header_in(language, &self.keys).into_iter();
        for (column, name) in (0..).zip(names.chain(external)) {
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

/// Returns the count of each class, named by its lower edge.
fn classes(it: &Histogram) -> Vec<(String, u64)> {
    let edge = |at: usize| super::plot::ticked(it.from + at as f64 * it.width, it.width);
    it.counts
        .iter()
        .enumerate()
        .map(|(at, n)| (edge(at), *n))
        .collect()
}

/// Ids of the headings of the summary; `Cp`, `Cpk` and `Ppk` follow them.
const HEADER: [&str; 8] = [
    "paper-sheet_parameter",
    "paper-tested",
    "paper-sheet_mean",
    "paper-sheet_sd",
    "paper-sheet_min",
    "paper-sheet_max",
    "paper-low_limit",
    "paper-high_limit",
];

/// Writes the figures of one parameter; returns its histogram.
fn summary_row(
    to: &mut Worksheet,
    row: u32,
    (language, key): (Lang, &str),
    figures: Figures,
    limits: Limits,
    formats: &Formats,
) -> Result<Option<Histogram>, XlsxError> {
    let (spread, histogram) = figures.tally.finish();
    let pairs = spread.n().saturating_sub(1);
    let within = (pairs > 0).then(|| figures.ranges / pairs as f64 / D2_PAIR);
    let able = Capability::of(limits, spread.n(), spread.mean(), within, spread.sd());
    to.write_string(row, 0, parameter(language, key))?;
    to.write_number(row, 1, spread.n() as f64)?;
    let values = [spread.mean(), spread.sd(), spread.min(), spread.max()];
    let values = values.into_iter().chain([limits.low, limits.high]);
    for (column, value) in (2..).zip(values) {
        formats.number(to, (row, column), value, None)?;
    }
    for (column, index) in (8..).zip([able.cp, able.cpk, able.ppk]) {
        formats.number(to, (row, column), index.map(|it| it.value), Some(2))?;
    }
    Ok(histogram)
}
