//! One tree for TOML and JSON: values that are not interpreted yet, with keys in the order of the file.

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// First character of the text that replaces a JSON number that is not finite.
const NOT_FINITE: char = '\u{1}';
/// Greatest number of characters of a value that a message shows.
const LONGEST_QUOTE: usize = 120;

/// A value of a scene or move file.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Null,
    Flag(bool),
    Number(f64),
    Text(String),
    List(Vec<Node>),
    Table(Vec<(String, Node)>),
}

impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Node::Null => f.write_str("null"),
            Node::Flag(flag) => write!(f, "{flag}"),
            Node::Number(number) => f.write_str(&shown(*number)),
            Node::Text(text) => match text.strip_prefix(NOT_FINITE) {
                Some(token) => f.write_str(&shortened(token)),
                None => write!(f, "\"{}\"", shortened(text)),
            },
            Node::List(members) => write!(f, "a list of {}", members.len()),
            Node::Table(_) => f.write_str("a table"),
        }
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Node, D::Error> {
        deserializer.deserialize_any(Reader)
    }
}

struct Reader;

impl<'de> Visitor<'de> for Reader {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, text, list or table")
    }
    fn visit_unit<E: Error>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }
    fn visit_bool<E: Error>(self, flag: bool) -> Result<Node, E> {
        Ok(Node::Flag(flag))
    }
    fn visit_i64<E: Error>(self, number: i64) -> Result<Node, E> {
        Ok(Node::Number(number as f64))
    }
    fn visit_u64<E: Error>(self, number: u64) -> Result<Node, E> {
        Ok(Node::Number(number as f64))
    }
    fn visit_f64<E: Error>(self, number: f64) -> Result<Node, E> {
        Ok(Node::Number(number))
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Node, E> {
        Ok(Node::Text(text.to_owned()))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Node, A::Error> {
        let mut members = Vec::new();
        while let Some(member) = seq.next_element()? {
            members.push(member);
        }
        Ok(Node::List(members))
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Node, A::Error> {
        let mut members: Vec<(String, Node)> = Vec::new();
        while let Some((key, value)) = map.next_entry::<String, Node>()? {
            if members.iter().any(|(known, _)| *known == key) {
                return Err(A::Error::custom(format!(
                    "key \"{}\" is given twice",
                    shortened(&key)
                )));
            }
            members.push((key, value));
        }
        Ok(Node::Table(members))
    }
}

/// Returns a number as text, without a long row of zeros.
pub(super) fn shown(number: f64) -> String {
    let is_plain = number == 0.0 || (1e-5..=1e15).contains(&number.abs());
    if is_plain || !number.is_finite() {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// Returns the text, or its beginning when it is too long for a message.
fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST_QUOTE) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Reason, in one line, why a text is not valid TOML or JSON.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{problem}{at}")]
pub struct Unreadable {
    /// Message of the parser.
    pub problem: String,
    /// Place of the error in the text.
    pub at: At,
}

/// Place in a text; lines and columns count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum At {
    /// The parser gives no place.
    Unknown,
    /// Column, in a text of one line.
    Column(usize),
    /// Line and column, in a text of several lines.
    Line(usize, usize),
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => Ok(()),
            Self::Column(column) => write!(f, " at column {column}"),
            Self::Line(line, column) => write!(f, " at line {line} column {column}"),
        }
    }
}

/// Reads TOML.
pub(super) fn from_toml(text: &str) -> Result<Node, Unreadable> {
    toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let before = text.get(..at).unwrap_or(text);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        let problem = error.message().lines().collect::<Vec<_>>().join(", ");
        Unreadable {
            problem: shortened(&problem),
            at: At::Line(line, column),
        }
    })
}

/// Reads JSON. Many programs write `NaN`, `Infinity` and numbers beyond f64, although JSON has none of them. The reader
/// turns them into texts, which no field accepts as a number, so that the error names the path of the field.
pub(super) fn from_json(text: &str) -> Result<Node, Unreadable> {
    serde_json::from_str(&marked(text)).map_err(|error| {
        let at = match error.line() {
            0 => At::Unknown,
            line => At::Line(line, error.column()),
        };
        let said = error.to_string();
        let problem = said.strip_suffix(&at.to_string()).unwrap_or(&said);
        Unreadable {
            problem: problem.to_owned(),
            at,
        }
    })
}

/// Reads one line of JSON; the caller adds the line number.
pub(super) fn from_json_line(line: &str) -> Result<Node, Unreadable> {
    from_json(line).map_err(|error| {
        let at = match error.at {
            At::Line(_, column) => At::Column(column),
            At::Column(_) | At::Unknown => error.at,
        };
        Unreadable { at, ..error }
    })
}

fn marked(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = match first {
            '"' => quoted_length(rest),
            '-' | '+' | '.' | '0'..='9' | 'a'..='z' | 'A'..='Z' => rest
                .find(|c: char| !(c.is_ascii_alphanumeric() || "+-._".contains(c)))
                .unwrap_or(rest.len()),
            other => other.len_utf8(),
        };
        let (token, after) = rest.split_at(length);
        if first != '"' && token.parse::<f64>().is_ok_and(|number| !number.is_finite()) {
            out.push_str("\"\\u0001");
            out.push_str(token);
            out.push('"');
        } else {
            out.push_str(token);
        }
        rest = after;
    }
    out
}

/// Returns the length in bytes of the quoted string at the beginning of `text`, quotes included.
fn quoted_length(text: &str) -> usize {
    let mut escaped = false;
    for (index, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return index + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}
