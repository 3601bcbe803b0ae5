//! A report: a table for people, JSON lines and CSV for programs.

use super::chart::Chart;
use super::figure::{Bar, Figure, shown};
use history::csv;
use serde_json::json;
use std::fmt::Write;

/// The figures of a study, in groups that share their columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Name of the study.
    pub study: &'static str,
    /// Description of the lots, for the head of the report.
    pub about: String,
    /// Figures in groups; the text shows a table per group.
    pub groups: Vec<Vec<Figure>>,
    /// Lines below the tables: parts worth a look, each with the seed that reproduces it.
    pub notes: Vec<String>,
    /// Plot of the main figures.
    pub chart: Chart,
}

impl Report {
    /// Creates a report without notes.
    pub fn new(
        study: &'static str,
        about: impl Into<String>,
        groups: Vec<Vec<Figure>>,
        chart: Chart,
    ) -> Self {
        Self {
            study,
            about: about.into(),
            groups,
            notes: Vec::new(),
            chart,
        }
    }

    /// Returns the report with these notes.
    pub fn noted(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }

    /// Returns true when no figure misses its bar.
    pub fn all_met(&self) -> bool {
        self.figures().all(|figure| figure.met() != Some(false))
    }

    pub(crate) fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.groups.iter().flatten()
    }

    fn missed(&self) -> Vec<&str> {
        let missed = self.figures().filter(|figure| figure.met() == Some(false));
        missed.map(|figure| figure.name.as_str()).collect()
    }

    /// Returns the report as text: aligned tables, the notes, and a last line that names the missed bars.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.study, self.about);
        for group in self.groups.iter().filter(|group| !group.is_empty()) {
            text.push('\n');
            aligned(&mut text, &cells(group, shown));
        }
        if !self.notes.is_empty() {
            let _ = writeln!(text, "\n{}", self.notes.join("\n"));
        }
        let missed = self.missed();
        let bars = self.figures().filter(|figure| figure.bar.is_some()).count();
        let _ = match missed.as_slice() {
            [] => writeln!(text, "\nall {bars} bars met"),
            some => writeln!(
                text,
                "\n{} of {bars} bars missed: {}",
                some.len(),
                some.join(", ")
            ),
        };
        text
    }

    /// Returns JSON lines: one object per figure, then a summary.
    pub fn json(&self) -> String {
        let mut text = String::new();
        for figure in self.figures() {
            let _ = writeln!(text, "{}", figure.json(self.study));
        }
        let summary = json!({
            "type": "summary", "study": self.study, "about": self.about,
            "figures": self.figures().count(), "met": self.all_met(), "missed": self.missed(), "notes": self.notes,
        });
        let _ = writeln!(text, "{summary}");
        text
    }

    /// Returns all figures as CSV under one header, with all digits.
    pub fn csv(&self) -> String {
        let all: Vec<Figure> = self.figures().cloned().collect();
        let mut bytes = Vec::new();
        for row in cells(&all, |value| value.to_string()) {
            csv::write(&mut bytes, row).expect("memory takes every record");
        }
        String::from_utf8(bytes).expect("fields are text")
    }
}

/// Returns the cells of header and rows; further columns appear in the order of their first use.
fn cells(figures: &[Figure], number: impl Fn(f64) -> String) -> Vec<Vec<String>> {
    let mut keys: Vec<&str> = Vec::new();
    for (key, _) in figures.iter().flat_map(|figure| &figure.more) {
        if !keys.contains(key) {
            keys.push(key);
        }
    }
    let mut header: Vec<String> = ["figure", "n", "value", "unit"].map(String::from).to_vec();
    header.extend(keys.iter().map(ToString::to_string));
    header.extend(["bar", "met"].map(String::from));
    let mut table = vec![header];
    for figure in figures {
        let further = |key: &&str| {
            figure
                .more
                .iter()
                .find(|(known, _)| known == key)
                .and_then(|(_, value)| *value)
        };
        let mut row = vec![
            figure.name.clone(),
            figure.n.to_string(),
            figure.value.map_or_else(String::new, &number),
            figure.unit.to_string(),
        ];
        row.extend(
            keys.iter()
                .map(|key| further(key).map_or_else(String::new, &number)),
        );
        row.push(figure.bar.map_or_else(String::new, Bar::text));
        row.push(
            figure
                .met()
                .map_or("", |met| if met { "yes" } else { "NO" })
                .to_string(),
        );
        table.push(row);
    }
    table
}

/// Appends the table to `text`; aligns the first column, units, bars and results to the left, numbers to the right.
fn aligned(text: &mut String, table: &[Vec<String>]) {
    let columns = table.first().map_or(0, Vec::len);
    let width = |column: usize| {
        table
            .iter()
            .filter_map(|row| row.get(column))
            .map(|it| it.chars().count())
            .max()
    };
    let widths: Vec<usize> = (0..columns)
        .map(|column| width(column).unwrap_or(0))
        .collect();
    for row in table {
        let mut line = String::new();
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            let left = column == 0 || column == 3 || column + 2 >= columns;
            let _ = if left {
                write!(line, "{cell:<width$}  ")
            } else {
                write!(line, "{cell:>width$}  ")
            };
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
}
