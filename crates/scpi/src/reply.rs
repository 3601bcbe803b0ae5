//! Replies of IEEE 488.2: numbers, strings, blocks, and the reasons why a reply is not accepted.

use thiserror::Error;

/// Greatest length of a line, bytes without its end.
pub const LINE_LIMIT: usize = 65_536;
/// Greatest length of a block, bytes; a form may set a lower limit.
pub const BLOCK_LIMIT: usize = 16_777_216;
/// Value that an instrument sends for a result over its range, with either sign.
const OVER_RANGE: f64 = 9.9e37;
/// Value that an instrument sends for "not a number".
const NOT_A_NUMBER: f64 = 9.91e37;

/// Form that the reply to a query must have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// One line of text.
    Line,
    /// A number: NR1, NR2 or NR3.
    Number,
    /// Numbers, separated by commas.
    Numbers,
    /// A string in quotation marks; a doubled mark inside stands for a single one.
    Text,
    /// A definite block of at most this many bytes.
    Block(usize),
    /// A block if the reply begins with `#` and a digit, otherwise a line; for tools that do not know the query.
    Any,
}

/// A reply, parsed by its form.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// One line of text, without its end.
    Line(String),
    /// A finite number that is neither 9.9E37 nor 9.91E37.
    Number(f64),
    /// Numbers, at least one.
    Numbers(Vec<f64>),
    /// Content of a string.
    Text(String),
    /// Bytes of a block, without header and end.
    Block(Vec<u8>),
}

/// Reason why a reply is not accepted.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ReplyError {
    /// The reply has no characters, or the block no bytes.
    #[error("empty reply")]
    Empty,
    /// A byte of a line is not printable ASCII.
    #[error("byte {byte:#04x} at position {at} is not a printable ASCII character")]
    NotText {
        /// Position in the line, from 0.
        at: usize,
        /// Value of the byte.
        byte: u8,
    },
    /// The text is not a number in decimal form.
    #[error("found {found:?}, expected a number")]
    NotNumber {
        /// Text found, at most its first 40 characters.
        found: String,
    },
    /// The text is not a string between quotation marks.
    #[error("found {found:?}, expected a string between quotation marks")]
    NotString {
        /// Text found, at most its first 40 characters.
        found: String,
    },
    /// The text is not an entry of the error queue.
    #[error("found {found:?}, expected a number, a comma and a text")]
    NotEntry {
        /// Text found, at most its first 40 characters.
        found: String,
    },
    /// The reply ended before it was complete, or the rest did not come in time.
    #[error("{received} bytes received, then nothing")]
    Incomplete {
        /// Number of bytes received.
        received: usize,
    },
    /// Line or block is longer than allowed.
    #[error("{length} bytes or more, at most {most} allowed")]
    TooLong {
        /// Length announced or received.
        length: usize,
        /// Greatest permitted length, bytes.
        most: usize,
    },
    /// The header of a block is not `#`, a digit from 1 to 9, and as many digits.
    #[error("no header of a definite block")]
    BlockHeader,
    /// A byte other than the end of the message follows the block.
    #[error("byte {byte:#04x} follows the block, expected its end")]
    BlockEnd {
        /// Value of the byte.
        byte: u8,
    },
    /// The reply is a block where a line must come.
    #[error("a block, expected a line")]
    Block,
    /// More bytes followed the reply.
    #[error("more bytes follow the reply")]
    More,
    /// The instrument reports a result over its range (9.9E37 or infinity).
    #[error("over range")]
    OverRange,
    /// The instrument reports that it has no number (9.91E37 or NAN).
    #[error("not a number")]
    NotANumber,
}

impl Form {
    /// Parses a complete reply, as [`Reader`](crate::Reader) returns it.
    ///
    /// # Errors
    /// Fails when the reply does not have this form, or is a number that stands for no value (over range, not a
    /// number).
    pub fn read(self, raw: &Raw) -> Result<Reply, ReplyError> {
        match (self, raw) {
            (Self::Block(_) | Self::Any, Raw::Block(bytes)) => Ok(Reply::Block(bytes.clone())),
            (Self::Block(_), Raw::Line(_)) => Err(ReplyError::BlockHeader),
            (Self::Line | Self::Any, raw) => Ok(Reply::Line(raw.text()?.to_owned())),
            (Self::Number, raw) => number(raw.text()?).map(Reply::Number),
            (Self::Numbers, raw) => {
                let fields = raw.text()?.split(',').map(number);
                fields.collect::<Result<_, _>>().map(Reply::Numbers)
            }
            (Self::Text, raw) => string(raw.text()?).map(Reply::Text),
        }
    }
}

/// A complete reply that is not parsed yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Raw {
    /// Bytes of a line, without its end.
    Line(Vec<u8>),
    /// Bytes of a block, without header and end.
    Block(Vec<u8>),
}

impl Raw {
    /// Returns the line as text.
    ///
    /// # Errors
    /// Fails for a block, an empty line, and characters that are not printable.
    pub fn text(&self) -> Result<&str, ReplyError> {
        match self {
            Self::Line(line) => text(line),
            Self::Block(_) => Err(ReplyError::Block),
        }
    }
}

fn text(line: &[u8]) -> Result<&str, ReplyError> {
    let strange = line
        .iter()
        .position(|it| !matches!(it, b'\t' | 0x20..=0x7E));
    if let Some((at, byte)) = strange.and_then(|at| Some((at, *line.get(at)?))) {
        return Err(ReplyError::NotText { at, byte });
    }
    let text = std::str::from_utf8(line).unwrap_or_default().trim();
    if text.is_empty() {
        return Err(ReplyError::Empty);
    }
    Ok(text)
}

/// Returns the beginning of a text for a message.
pub(crate) fn beginning(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Reads a decimal number: NR1 (`-5`), NR2 (`1.5`) or NR3 (`+1.5E+00`).
///
/// # Errors
/// Fails for any other text, and with [`ReplyError::OverRange`] or [`ReplyError::NotANumber`] for 9.9E37, 9.91E37, INF
/// and NAN, which are never values.
pub fn number(text: &str) -> Result<f64, ReplyError> {
    let text = text.trim();
    match text
        .trim_start_matches(['+', '-'])
        .to_ascii_uppercase()
        .as_str()
    {
        "NAN" => return Err(ReplyError::NotANumber),
        "INF" | "INFINITY" | "NINF" => return Err(ReplyError::OverRange),
        _ => {}
    }
    let digit = |it: &char| it.is_ascii_digit();
    let allowed = |it: char| it.is_ascii_digit() || matches!(it, '+' | '-' | '.' | 'e' | 'E');
    let mantissa = text.split(['e', 'E']).next().unwrap_or_default();
    let plain = text.chars().all(allowed) && mantissa.chars().any(|it| digit(&it));
    let value = plain.then(|| text.parse::<f64>().ok()).flatten();
    let not_number = || ReplyError::NotNumber {
        found: beginning(text),
    };
    let value = value.ok_or_else(not_number)?;
    if (value / NOT_A_NUMBER - 1.0).abs() < 1e-6 {
        return Err(ReplyError::NotANumber);
    }
    if value.abs() >= OVER_RANGE * (1.0 - 1e-6) {
        return Err(ReplyError::OverRange);
    }
    Ok(value)
}

/// Reads a string between `"` or `'`.
///
/// # Errors
/// Fails when the marks are missing or differ, or when a mark inside is not doubled.
pub fn string(text: &str) -> Result<String, ReplyError> {
    let not_string = || ReplyError::NotString {
        found: beginning(text),
    };
    let mark = text.chars().next().filter(|it| matches!(it, '"' | '\''));
    let mark = mark.ok_or_else(not_string)?;
    let inside = text.strip_prefix(mark).and_then(|it| it.strip_suffix(mark));
    let inside = inside.ok_or_else(not_string)?;
    let doubled = format!("{mark}{mark}");
    if inside.replace(&doubled, "").contains(mark) {
        return Err(not_string());
    }
    Ok(inside.replace(&doubled, &mark.to_string()))
}
