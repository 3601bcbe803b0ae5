//! Comma-separated values after RFC 4180, read strictly and written so that spreadsheets agree.
//!
//! Reading: UTF-8 with or without byte order mark, fields may be quoted, a quote inside is doubled,
//! lines end with LF or CRLF. Every record carries the number of the line it begins on. A record
//! with another number of fields than the header is an error, never padded.

use ::csv::{ReaderBuilder, StringRecord, Terminator, WriterBuilder};
use std::borrow::Cow;
use std::io::{self, Write};

/// What spreadsheets need in front to take a file for UTF-8.
pub const BYTE_ORDER_MARK: &str = "\u{feff}";

/// What ends a line.
const LINE_END: [char; 2] = ['\r', '\n'];

/// A record and the line it begins on, from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Record {
    /// Line number in the file.
    pub line: usize,
    /// Fields without their quotes.
    pub fields: Vec<String>,
}

/// Why a text is no CSV.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CsvError {
    /// Nothing at all.
    #[error("line 1: expected a header, found an empty file")]
    Empty,
    /// Another number of fields than the header has.
    #[error("line {line}: found {found} fields, expected {expected} as in the header")]
    Ragged {
        /// Line number in the file.
        line: usize,
        /// Fields found.
        found: usize,
        /// Fields of the header.
        expected: usize,
    },
    /// A quoted field without its end, or with text after it.
    #[error("line {line}: a quoted field must end with a quote before the next comma")]
    Quote {
        /// Line on which the record begins.
        line: usize,
    },
}

/// Reads header and records; passes over empty lines.
///
/// # Errors
/// Names the line of a record with another number of fields than the header, or with a quote out of place.
pub fn read(text: &str) -> Result<Vec<Record>, CsvError> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut records: Vec<Record> = Vec::new();
    let (mut row, mut line, mut from) = (StringRecord::new(), 1, 0);
    while matches!(reader.read_record(&mut row), Ok(true)) {
        let end = reader.position().byte() as usize;
        let raw = text[from..end].trim_start_matches(LINE_END);
        line += text[from..end - raw.len()].matches('\n').count();
        if !is_strict(raw.trim_end_matches(LINE_END), &row) {
            return Err(CsvError::Quote { line });
        }
        if row.iter().any(|field| !field.is_empty()) || row.len() > 1 {
            records.push(record(&row, line, records.first())?);
        }
        line += raw.matches('\n').count();
        from = end;
    }
    match records.is_empty() {
        true => Err(CsvError::Empty),
        false => Ok(records),
    }
}

/// Checks the number of fields against that of the header.
fn record(row: &StringRecord, line: usize, header: Option<&Record>) -> Result<Record, CsvError> {
    let fields: Vec<String> = row.iter().map(str::to_owned).collect();
    let expected = header.map_or(fields.len(), |header| header.fields.len());
    match fields.len() == expected {
        true => Ok(Record { line, fields }),
        false => Err(CsvError::Ragged {
            line,
            found: fields.len(),
            expected,
        }),
    }
}

/// True when a field that begins with a quote ends with one, which the reader does not demand.
fn is_strict(raw: &str, row: &StringRecord) -> bool {
    let mut rest = raw;
    for (n, field) in row.iter().enumerate() {
        let begin = rest.strip_prefix(',').filter(|_| n > 0).unwrap_or(rest);
        let end = match begin.starts_with('"') {
            true => begin.strip_prefix(&format!("\"{}\"", field.replace('"', "\"\""))),
            false => begin.strip_prefix(field),
        };
        let Some(end) = end else { return false };
        rest = end;
    }
    rest.is_empty()
}

/// What a spreadsheet takes for the begin of a formula. A sign before a figure is none: only texts are asked.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Whether a spreadsheet may take the text for a formula, or for one that was made harmless.
fn is_delicate(text: &str) -> bool {
    text.trim_start_matches('\'').starts_with(FORMULA)
}

/// The text of a person as a spreadsheet shows it and never computes it: an apostrophe in front, where it needs one.
pub fn harmless(text: &str) -> Cow<'_, str> {
    if is_delicate(text) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// The text that [`harmless`] was given.
pub fn as_typed(text: &str) -> &str {
    let inner = text.strip_prefix('\'').filter(|it| is_delicate(it));
    inner.unwrap_or(text)
}

/// Writes one record with CRLF.
///
/// # Errors
/// `out` cannot be written.
pub fn write(
    out: &mut impl Write,
    fields: impl IntoIterator<Item = impl AsRef<str>>,
) -> io::Result<()> {
    let mut writer = WriterBuilder::new()
        .terminator(Terminator::CRLF)
        .from_writer(out);
    for field in fields {
        writer.write_field(field.as_ref())?;
    }
    writer.write_record(None::<&str>)?;
    writer.flush()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn what_was_written_is_read_back() {
        let rows = [
            ["a", "b"],
            ["1,5", "he said \"no\""],
            ["line\nbreak", ""],
            ["继电器", " x "],
        ];
        let mut out = Vec::new();
        rows.iter()
            .for_each(|row| write(&mut out, row.iter().copied()).unwrap());
        let text = format!("{BYTE_ORDER_MARK}{}", String::from_utf8(out).unwrap());
        let back = read(&text).unwrap();
        let fields: Vec<Vec<String>> = back.iter().map(|it| it.fields.clone()).collect();
        assert_eq!(fields, rows.map(|row| row.map(str::to_owned).to_vec()));
        assert_eq!(
            back.iter().map(|it| it.line).collect::<Vec<_>>(),
            [1, 2, 3, 5]
        );
    }

    #[test]
    fn a_text_that_looks_like_a_formula_is_made_harmless_and_comes_back_as_typed() {
        let attacks = [
            "=cmd|' /C calc'!A0",
            "+1",
            "-B2",
            "@SUM(A1)",
            "\t=1",
            "\r=1",
            "'=1",
        ];
        for text in attacks {
            let shown = harmless(text);
            assert!(shown.starts_with('\''), "{shown}");
            assert_eq!(as_typed(&shown), text);
        }
        for text in ["批次 7", "7-A", "", "'", "'quoted'", "A=1"] {
            assert_eq!((harmless(text).as_ref(), as_typed(text)), (text, text));
        }
    }

    #[test]
    fn unix_lines_and_a_missing_last_line_end_are_fine() {
        let back = read("a,b\n1,2\n\n3,4").unwrap();
        assert_eq!(back.len(), 3);
        assert_eq!(
            back[2],
            Record {
                line: 4,
                fields: vec!["3".into(), "4".into()]
            }
        );
    }

    #[test]
    fn a_short_row_is_named_by_its_line() {
        let refusal = read("a,b\n1,2\n3\n").unwrap_err();
        assert_eq!(
            refusal,
            CsvError::Ragged {
                line: 3,
                found: 1,
                expected: 2
            }
        );
        assert_eq!(read("a\n\"open\n"), Err(CsvError::Quote { line: 2 }));
        assert_eq!(read("a\n\"x\"y\n"), Err(CsvError::Quote { line: 2 }));
        assert_eq!(read(""), Err(CsvError::Empty));
    }
}
