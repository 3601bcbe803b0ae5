//! Where data goes: a buffered stdout or file, and plain tables with aligned columns.

use clap::{Args, ValueEnum};
use std::io::{self, BufWriter, Write};

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

/// `--format` and its short cut.
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

/// A buffered sink that ends lines itself.
pub(super) struct Output(BufWriter<Box<dyn Write>>);

impl Output {
    pub fn stdout() -> Self {
        Self::to(io::stdout())
    }
    pub fn to(sink: impl Write + 'static) -> Self {
        Self(BufWriter::with_capacity(1 << 16, Box::new(sink)))
    }
    /// One line, handed on at once.
    pub fn line(&mut self, text: &str) -> io::Result<()> {
        writeln!(self.0, "{text}")?;
        self.0.flush()
    }
    pub fn json(&mut self, object: &impl serde::Serialize) -> anyhow::Result<()> {
        serde_json::to_writer(&mut self.0, object).map_err(io::Error::from)?;
        Ok(self.0.write_all(b"\n")?)
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

/// Rows whose widths are taken page by page, so that a long answer needs little memory.
pub(super) struct Table {
    widths: Vec<usize>,
    page: Vec<Vec<String>>,
}

/// Rows between two looks at the widths.
const PAGE: usize = 500;

impl Table {
    pub fn new(header: &[&str]) -> Self {
        let first = header.iter().map(|&name| name.to_owned()).collect();
        Self {
            widths: vec![0; header.len()],
            page: vec![first],
        }
    }
    pub fn row(&mut self, out: &mut impl Write, cells: Vec<String>) -> io::Result<()> {
        self.page.push(cells);
        if self.page.len() < PAGE {
            Ok(())
        } else {
            self.finish(out)
        }
    }
    pub fn finish(&mut self, out: &mut impl Write) -> io::Result<()> {
        for row in &self.page {
            for (widest, cell) in self.widths.iter_mut().zip(row) {
                *widest = (*widest).max(width(cell));
            }
        }
        for row in self.page.drain(..) {
            let mut line = String::new();
            for (cell, widest) in row.iter().zip(&self.widths) {
                line.push_str(cell);
                line.extend(std::iter::repeat_n(' ', widest - width(cell) + 2));
            }
            writeln!(out, "{}", line.trim_end())?;
        }
        out.flush()
    }
}

/// Columns on a terminal: Chinese characters take two, control characters are not expected.
fn width(text: &str) -> usize {
    let wide = |it: char| {
        matches!(u32::from(it), 0x1100..=0x115f | 0x2e80..=0xa4cf | 0xac00..=0xd7a3
            | 0xf900..=0xfaff | 0xfe30..=0xfe6f | 0xff00..=0xff60 | 0xffe0..=0xffe6
            | 0x20000..=0x3fffd)
    };
    text.chars().map(|it| if wide(it) { 2 } else { 1 }).sum()
}

/// Empty for nothing.
pub(super) fn text(value: Option<impl ToString>) -> String {
    value.map(|it| it.to_string()).unwrap_or_default()
}

/// Six significant digits, without trailing zeros; empty for nothing.
pub(super) fn figure(value: Option<f64>) -> String {
    let Some(value) = value else {
        return String::new();
    };
    if value == 0.0 {
        return "0".to_owned();
    }
    let before = value.abs().log10().floor();
    if !(-5.0..9.0).contains(&before) {
        return format!("{value:.5e}");
    }
    let decimals = (5.0 - before).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
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
    fn columns_stand_under_each_other_in_chinese_too() {
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
