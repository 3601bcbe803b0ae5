//! A trace as text: the file stored with an alarm. `bus monitor` and tests read it back.
//!
//! ```text
//! # line motion 115200 checksum
//! 1204817 > @11A2\r
//! 1207904 < >0F0034\r
//! 1207990 ~ \x00U
//! ```
//! Each row begins with the rig time in microseconds; `>` marks sent bytes, `<` a reply, `~` discarded bytes. The text
//! shows non-printable bytes as `\r` or `\xNN`, a backslash as `\\`.

use super::trace::{Direction, Entry, Trace};
use std::fmt::Write;
use thiserror::Error;
use units::RigTime;

/// Traffic of a line, with the settings needed to decode it.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// Name of the line, one word.
    pub line: String,
    /// Bits per second.
    pub baud: u32,
    /// True when frames carry checksums.
    pub checksum: bool,
    /// Entries, oldest first.
    pub entries: Vec<Entry>,
}

/// Reason why a text is not a recorded trace.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {row}: found \"{found}\", expected {expected}")]
pub struct RecordedError {
    /// Number of the faulty row, from 1.
    pub row: usize,
    /// Text of this row.
    pub found: String,
    /// Format that the row should have.
    pub expected: &'static str,
}

impl Recorded {
    /// Creates a recording of `trace` with the settings of its line.
    pub fn of(trace: &Trace, line: &str, baud: u32, checksum: bool) -> Self {
        Self {
            line: line.to_owned(),
            baud,
            checksum,
            entries: trace.entries().copied().collect(),
        }
    }

    /// Returns the traffic in the text format of this module.
    pub fn text(&self) -> String {
        let checksum = if self.checksum { "checksum" } else { "plain" };
        let mut out = format!("# line {} {} {checksum}\n", self.line, self.baud);
        for entry in &self.entries {
            let arrow = arrow(entry.direction);
            let _ = writeln!(out, "{} {arrow} {}", entry.at.0, escaped(entry.bytes()));
        }
        out
    }

    /// Parses a text in the format of this module.
    pub fn parse(text: &str) -> Result<Self, RecordedError> {
        let mut rows = text.lines().enumerate();
        let head = rows.next().map_or("", |(_, row)| row);
        let wrong = |row: usize, found: &str, expected| RecordedError {
            row: row + 1,
            found: found.to_owned(),
            expected,
        };
        let mut recorded = header(head)
            .ok_or_else(|| wrong(0, head, "\"# line NAME BAUD checksum\" or \"... plain\""))?;
        for (number, row) in rows.filter(|(_, row)| !row.is_empty()) {
            let entry = entry(row).ok_or_else(|| {
                wrong(
                    number,
                    row,
                    "microseconds, one of > < ~, and at most 64 bytes",
                )
            })?;
            recorded.entries.push(entry);
        }
        Ok(recorded)
    }
}

fn header(row: &str) -> Option<Recorded> {
    let words: Vec<&str> = row.split_whitespace().collect();
    let ["#", "line", line, baud, checksum] = words[..] else {
        return None;
    };
    Some(Recorded {
        line: line.to_owned(),
        baud: baud.parse().ok()?,
        checksum: match checksum {
            "checksum" => true,
            "plain" => false,
            _ => return None,
        },
        entries: Vec::new(),
    })
}

fn entry(row: &str) -> Option<Entry> {
    let (at, rest) = row.split_once(' ')?;
    let (arrow, bytes) = rest.split_once(' ')?;
    let direction = match arrow {
        ">" => Direction::Sent,
        "<" => Direction::Received,
        "~" => Direction::Stray,
        _ => return None,
    };
    Entry::new(RigTime(at.parse().ok()?), direction, &unescaped(bytes)?)
}

/// Returns the character that marks a direction in the text format.
pub fn arrow(direction: Direction) -> char {
    match direction {
        Direction::Sent => '>',
        Direction::Received => '<',
        Direction::Stray => '~',
    }
}

/// Escapes bytes as the text format does.
pub fn escaped(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len() + 2);
    for byte in bytes {
        match byte {
            b'\r' => out.push_str("\\r"),
            b'\\' => out.push_str("\\\\"),
            0x20..=0x7E => out.push(char::from(*byte)),
            _ => {
                let _ = write!(out, "\\x{byte:02X}");
            }
        }
    }
    out
}

/// Reverses [`escaped`]; returns `None` for a malformed escape.
pub fn unescaped(text: &str) -> Option<Vec<u8>> {
    let mut bytes = text.bytes();
    let mut out = Vec::with_capacity(text.len());
    while let Some(byte) = bytes.next() {
        out.push(match byte {
            b'\\' => match bytes.next()? {
                b'r' => b'\r',
                b'\\' => b'\\',
                b'x' => {
                    let digits = [bytes.next()?, bytes.next()?];
                    u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
                }
                _ => return None,
            },
            plain => plain,
        });
    }
    Some(out)
}
