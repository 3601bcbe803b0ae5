//! Answers on stdout or in a file: lists as text table or CSV from the same columns, or as JSON with every field.

use anyhow::Context;
use bus::Histogram;
use clap::{Args, ValueEnum};
use history::csv;
use history::report::significant;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;
use unicode_width::UnicodeWidthStr;

/// Form of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// Aligned columns
    Table,
    /// Comma-separated values
    Csv,
    /// One JSON object per line
    Json,
}

/// `--format` and `--json`.
#[derive(Debug, Args)]
pub(super) struct FormatArgs {
    /// Form of the answer
    #[arg(long, value_enum, default_value = "table")]
    format: Format,
    /// Same as --format json
    #[arg(long, conflicts_with = "format")]
    json: bool,
}

impl FormatArgs {
    pub fn format(&self) -> Format {
        if self.json { Format::Json } else { self.format }
    }
}

/// A column of a list of `T`: heading, and the function that returns a cell.
pub(super) type Column<'a, T> = (&'a str, fn(&T) -> String);

/// A column of fixed width: heading, width in characters (negative: aligned to the left), and the function that returns
/// a cell.
pub(super) type Fixed<T> = (&'static str, isize, fn(&T) -> String);

/// Returns the headings as one line of text.
pub(super) fn headings<T>(columns: &[Fixed<T>]) -> String {
    padded(columns.iter().map(|it| (it.1, it.0.to_owned())))
}

/// Returns the cells of a row as one line of text.
pub(super) fn cells<T>(row: &T, columns: &[Fixed<T>]) -> String {
    padded(columns.iter().map(|it| (it.1, (it.2)(row))))
}

fn padded(cells: impl Iterator<Item = (isize, String)>) -> String {
    let pad = |(width, cell): (isize, String)| match (width < 0, width.unsigned_abs()) {
        (true, width) => format!("{cell:<width$}"),
        (false, width) => format!("{cell:>width$}"),
    };
    cells.map(pad).collect::<Vec<_>>().join(" ")
}

/// Returns rows as text: headings and a table row each, or the text that `object` returns for each. An empty table is
/// the text `none`.
pub(super) fn listing<T>(
    rows: &[T],
    columns: &[Fixed<T>],
    none: &str,
    object: Option<fn(&T) -> String>,
) -> String {
    let head = match (rows.is_empty(), object) {
        (_, Some(_)) => None,
        (true, None) => Some(none.to_owned()),
        (false, None) => Some(headings(columns)),
    };
    let row = |it| object.map_or_else(|| cells(it, columns), |object| object(it));
    let rows = rows.iter().map(row);
    head.into_iter().chain(rows).map(|row| row + "\n").collect()
}

/// Returns the latency, milliseconds, that the given share (0 to 1) of the replies did not exceed; `None` without
/// replies.
pub(super) fn latency_ms(latencies: &Histogram, share: f64) -> Option<f64> {
    Some(latencies.percentile(share)?.as_seconds() * 1e3)
}

/// Writes `text`, which consists of whole lines, to stdout and flushes.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .context("writing to stdout")
}

/// Opens a file to read, or stdin for `-`.
pub(super) fn input(file: &Path) -> io::Result<Box<dyn Read>> {
    Ok(match file.as_os_str() == "-" {
        true => Box::new(io::stdin()),
        false => Box::new(File::open(file)?),
    })
}

/// Buffered output, line by line.
pub(super) struct Output(BufWriter<Box<dyn Write>>);

impl Output {
    pub fn stdout() -> Self {
        Self::to(io::stdout())
    }
    pub fn to(sink: impl Write + 'static) -> Self {
        Self(BufWriter::with_capacity(1 << 16, Box::new(sink)))
    }
    /// Writes one line and flushes.
    pub fn line(&mut self, text: &str) -> io::Result<()> {
        writeln!(self.0, "{text}")?;
        self.0.flush()
    }
    /// Writes one object and a line end; does not flush.
    pub fn json(&mut self, object: &impl Serialize) -> anyhow::Result<()> {
        serde_json::to_writer(&mut self.0, object).map_err(io::Error::from)?;
        Ok(self.0.write_all(b"\n")?)
    }

    /// Writes the rows in the form `format`; JSON shows every field of a row, not only the columns.
    pub fn list<T: Serialize>(
        &mut self,
        format: Format,
        rows: &[T],
        columns: &[Column<T>],
    ) -> anyhow::Result<()> {
        match format {
            Format::Json => rows.iter().try_for_each(|row| self.json(row))?,
            Format::Csv => {
                csv::write(self, columns.iter().map(|(heading, _)| heading))?;
                for row in rows {
                    let cells = columns.iter().map(|(_, cell)| cell(row));
                    csv::write(self, cells.map(|it| csv::escape_formula(&it).into_owned()))?;
                }
            }
            Format::Table => self.table(rows, columns)?,
        }
        Ok(self.flush()?)
    }

    /// Writes the rows as a text table.
    pub fn table<T>(&mut self, rows: &[T], columns: &[Column<T>]) -> io::Result<()> {
        let headings: Vec<&str> = columns.iter().map(|(heading, _)| *heading).collect();
        let mut table = Table::new(&headings);
        for row in rows {
            table.row(self, columns.iter().map(|(_, cell)| cell(row)).collect())?;
        }
        table.finish(self)
    }

    /// Writes a line per row, JSON or text.
    pub fn lines<T>(
        &mut self,
        as_json: bool,
        rows: &[T],
        object: impl Fn(&T) -> Value,
        text: impl Fn(&T) -> String,
    ) -> io::Result<()> {
        for row in rows {
            match as_json {
                true => writeln!(self, "{}", object(row))?,
                false => writeln!(self, "{}", text(row))?,
            }
        }
        self.flush()
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// A text table with aligned columns. Column widths grow page by page, so that a long answer needs little memory.
pub(super) struct Table {
    widths: Vec<usize>,
    page: Vec<Vec<String>>,
}

/// Number of rows that share their column widths.
const PAGE: usize = 500;

impl Table {
    pub fn new(headings: &[&str]) -> Self {
        Self {
            widths: vec![0; headings.len()],
            page: vec![headings.iter().map(ToString::to_string).collect()],
        }
    }

    /// Adds a row; writes a page when it is full.
    pub fn row(&mut self, out: &mut impl Write, cells: Vec<String>) -> io::Result<()> {
        self.page.push(cells);
        match self.page.len() < PAGE {
            true => Ok(()),
            false => self.finish(out),
        }
    }

    /// Writes the rows that have not filled a page.
    pub fn finish(&mut self, out: &mut impl Write) -> io::Result<()> {
        for row in &self.page {
            for (widest, cell) in self.widths.iter_mut().zip(row) {
                *widest = (*widest).max(cell.width());
            }
        }
        for row in self.page.drain(..) {
            let mut line = String::new();
            for (cell, widest) in row.iter().zip(&self.widths) {
                line.push_str(cell);
                line.extend(std::iter::repeat_n(' ', widest - cell.width() + 2));
            }
            writeln!(out, "{}", line.trim_end())?;
        }
        out.flush()
    }
}

/// Returns a value as a JSON object with the member `type`.
pub(super) fn typed(kind: &str, value: &impl Serialize) -> Value {
    let mut object = json!(value);
    object["type"] = kind.into();
    object
}

/// Returns every bin with its count, as text.
pub(super) fn bins(counts: &BTreeMap<impl Display, u64>) -> String {
    let bins = counts.iter().map(|(bin, n)| format!("{bin} {n}"));
    bins.collect::<Vec<_>>().join(", ")
}

/// Returns a text, empty for `None`.
pub(super) fn text(value: Option<impl ToString>) -> String {
    value.map(|it| it.to_string()).unwrap_or_default()
}

/// Returns six significant digits without trailing zeros; empty for `None`.
pub(super) fn figure(value: Option<f64>) -> String {
    let Some(value) = value else {
        return String::new();
    };
    let is_plain = value == 0.0 || (-5.0..9.0).contains(&value.abs().log10().floor());
    match is_plain {
        true => significant(value, 6),
        false => format!("{value:.5e}"),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn figures_have_six_digits() {
        let shown = [
            7.88,
            400.123_456,
            0.000_012_345_67,
            1_234_567.0,
            0.0,
            -1.5e-9,
        ]
        .map(|it| figure(Some(it)));
        assert_eq!(
            shown,
            [
                "7.88",
                "400.123",
                "0.0000123457",
                "1234567",
                "0",
                "-1.50000e-9"
            ]
        );
    }

    #[test]
    fn columns_align_with_chinese_text() {
        let mut table = Table::new(&["lot", "n"]);
        let mut out = Vec::new();
        table
            .row(&mut out, vec!["批次".into(), "1".into()])
            .unwrap();
        table.row(&mut out, vec!["A".into(), "2".into()]).unwrap();
        table.finish(&mut out).unwrap();
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "lot   n\n批次  1\nA     2\n"
        );
    }
}
