//! Comma-separated values (RFC 4180): reads them strictly, writes them for spreadsheets.
//!
//! A file to read is UTF-8 with or without byte order mark; quotes inside a quoted field are doubled; lines end with LF
//! or CRLF. Every record keeps the number of its first line. A record with more or fewer fields than the header is an
//! error.

use ::csv::{ReaderBuilder, StringRecord, Terminator, WriterBuilder};
use std::borrow::Cow;
use std::io::{self, Write};

/// Prefix by which spreadsheets recognise a file as UTF-8.
pub const BYTE_ORDER_MARK: &str = "\u{feff}";

/// Characters that end a line.
const LINE_END: [char; 2] = ['\r', '\n'];

/// A record with its line number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Record {
    /// Number of the record's first line in the file, from 1.
    pub line: usize,
    /// Fields without their quotes.
    pub fields: Vec<String>,
}

/// Reason why a text is not CSV.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CsvError {
    /// The text is empty.
    #[error("line 1: expected a header, found an empty file")]
    Empty,
    /// A record has more or fewer fields than the header.
    #[error("line {line}: found {found} fields, expected {expected} as in the header")]
    Ragged {
        /// Number of the record's first line in the file, from 1.
        line: usize,
        /// Number of fields found.
        found: usize,
        /// Number of fields in the header.
        expected: usize,
    },
    /// A quoted field has no closing quote, or has text after it.
    #[error("line {line}: a quoted field must end with a quote before the next comma")]
    Quote {
        /// Number of the record's first line in the file, from 1.
        line: usize,
    },
}

/// Reads a text as records, the header first; skips empty lines.
///
/// # Errors
/// Fails on a wrong number of fields or a misplaced quote; the error names the line.
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

/// Makes a record; fails when it has another number of fields than the header.
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

/// Returns true when every field that begins with a quote also ends with one; the CSV library does not check that.
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

/// Characters by which, at the beginning of a text, a spreadsheet recognises a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Returns true when a spreadsheet may take the text for a formula; apostrophes at its beginning are ignored.
fn looks_like_formula(text: &str) -> bool {
    text.trim_start_matches('\'').starts_with(FORMULA)
}

/// Puts an apostrophe before a text that a spreadsheet would take for a formula.
pub fn escape_formula(text: &str) -> Cow<'_, str> {
    if looks_like_formula(text) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// Removes the apostrophe that [`escape_formula`] adds.
pub fn unescape_formula(text: &str) -> &str {
    let inner = text.strip_prefix('\'').filter(|it| looks_like_formula(it));
    inner.unwrap_or(text)
}

/// Writes one record and ends it with CRLF.
///
/// # Errors
/// Fails when `out` cannot be written.
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
    fn a_formula_is_escaped_and_comes_back_as_typed() {
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
            let shown = escape_formula(text);
            assert!(shown.starts_with('\''), "{shown}");
            assert_eq!(unescape_formula(&shown), text);
        }
        for text in ["批次 7", "7-A", "", "'", "'quoted'", "A=1"] {
            assert_eq!(
                (escape_formula(text).as_ref(), unescape_formula(text)),
                (text, text)
            );
        }
    }

    #[test]
    fn unix_lines_and_an_open_end_are_accepted() {
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
