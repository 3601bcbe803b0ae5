//! Reads results from the records of a CSV file: one result a line, columns by name.

use super::enter::{NewResult, ResultRefusal, Sample};
use crate::csv::{CsvError, Record, unescape_formula};
use machine::dut::External;
use machine::form::one_of;
use std::collections::BTreeMap;

/// Columns that a file may have; `key` and `value` are required.
const COLUMNS: [&str; 8] = ["serial", "run", "seq", "key", "value", "unit", "u", "at"];

/// Expected in column `at`.
const TIME: &str = "a time as 2026-11-22T08:00 (local) or 2026-11-22T08:00:00+08:00";

/// Expected in columns `value` and `u`.
const NUMBER: &str = "a finite number";

/// One line of the file.
struct Line<'a> {
    number: usize,
    /// Cells that are not empty, by column.
    cells: BTreeMap<&'a str, &'a str>,
}

/// Reads records, of which the first is the header. Each result keeps its line.
///
/// # Errors
/// Fails with the first unknown, missing or repeated column, or with the first cell that is no value of its column.
pub fn parse_results(records: &[Record]) -> Result<Vec<NewResult>, ResultRefusal> {
    let (header, records) = records.split_first().ok_or(CsvError::Empty)?;
    let names: Vec<&str> = header.fields.iter().map(|it| it.trim()).collect();
    check(&names)?;
    let result = |record: &Record| {
        let cells = record.fields.iter().map(|it| it.trim());
        let cells = names.iter().copied().zip(cells);
        let cells = cells.filter(|(_, cell)| !cell.is_empty()).collect();
        let number = record.line;
        Line { number, cells }.result()
    };
    let all: Vec<NewResult> = records.iter().map(result).collect::<Result<_, _>>()?;
    match all.is_empty() {
        true => Err(ResultRefusal::wrong(
            None,
            "value",
            "",
            "at least one line with a result",
        )),
        false => Ok(all),
    }
}

fn check(names: &[&str]) -> Result<(), ResultRefusal> {
    let line = Some(1);
    for (n, name) in names.iter().enumerate() {
        if !COLUMNS.contains(name) {
            return Err(ResultRefusal::wrong(line, "header", name, one_of(&COLUMNS)));
        }
        if names[..n].contains(name) {
            return Err(ResultRefusal::wrong(
                line,
                "header",
                name,
                "each column once",
            ));
        }
    }
    let lacks = ["key", "value"].into_iter().find(|it| !names.contains(it));
    lacks.map_or(Ok(()), |it| {
        Err(ResultRefusal::wrong(line, it, "", "this column"))
    })
}

impl Line<'_> {
    fn result(&self) -> Result<NewResult, ResultRefusal> {
        let keys = External::ALL.map(External::key);
        let key = self.cell("key").and_then(External::from_key);
        let key = key.ok_or_else(|| self.wrong("key", &one_of(&keys)))?;
        let (symbol, sign) = (key.unit().symbol(), key.unit().sign());
        if self
            .cell("unit")
            .is_some_and(|it| it != symbol && it != sign)
        {
            return Err(self.wrong("unit", &one_of(&[symbol])));
        }
        let value = self.number("value")?;
        let at = |text: &str| text.parse().map_err(|_| self.wrong("at", TIME));
        Ok(NewResult {
            line: Some(self.number),
            sample: self.sample()?,
            key,
            value: value.ok_or_else(|| self.wrong("value", NUMBER))?,
            u: self.number("u")?,
            measured_at: self.cell("at").map(at).transpose()?,
        })
    }

    fn sample(&self) -> Result<Sample, ResultRefusal> {
        let (seq, run) = (self.whole("seq")?, self.whole("run")?);
        match (self.cell("serial"), seq) {
            (Some(_), Some(_)) => Err(self.wrong("seq", "nothing beside a serial number")),
            (_, None) if run.is_some() => Err(self.wrong("run", "nothing without seq")),
            (Some(serial), None) => Ok(Sample::Serial(unescape_formula(serial).to_owned())),
            (None, Some(seq)) => Ok(Sample::Part {
                run,
                seq: seq.into(),
            }),
            (None, None) => Ok(Sample::Lot),
        }
    }

    fn cell(&self, column: &str) -> Option<&str> {
        self.cells.get(column).copied()
    }

    fn number(&self, column: &'static str) -> Result<Option<f64>, ResultRefusal> {
        let parse = |text: &str| text.parse::<f64>().ok().filter(|it| it.is_finite());
        let read = |text| parse(text).ok_or_else(|| self.wrong(column, NUMBER));
        self.cell(column).map(read).transpose()
    }

    fn whole(&self, column: &'static str) -> Result<Option<u32>, ResultRefusal> {
        let read = |text: &str| {
            text.parse()
                .map_err(|_| self.wrong(column, "a whole number"))
        };
        self.cell(column).map(read).transpose()
    }

    fn wrong(&self, column: &'static str, expected: &str) -> ResultRefusal {
        let found = self.cell(column).unwrap_or_default();
        ResultRefusal::wrong(Some(self.number), column, found, expected)
    }
}
