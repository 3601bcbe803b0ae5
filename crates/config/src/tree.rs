//! A TOML text as a tree whose values know their line numbers.
//!
//! Tables keep the order of the file. A path leads from the root to a value: `module.rtd.type`, or `golden.1.serial`,
//! where the number is the place in a list, from 0.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value with its line number.
#[derive(Debug, Clone)]
pub struct Node {
    /// Line of the value, or of the header if the value is a table; from 1.
    pub line: usize,
    /// The value.
    pub value: Value,
}

/// A TOML value.
#[derive(Debug, Clone)]
pub enum Value {
    /// A string.
    Text(String),
    /// A whole number.
    Whole(i64),
    /// A number with a decimal point or an exponent; may be NaN or infinite.
    Number(f64),
    /// `true` or `false`.
    Flag(bool),
    /// A date or time, as written.
    Date(String),
    /// An array, or an array of tables.
    List(Vec<Node>),
    /// A table: its keys and values, in the order of the file.
    Table(Vec<(String, Node)>),
}

/// Error: a text is not TOML.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotToml {
    /// Line of the fault, from 1.
    pub line: usize,
    /// Message of the parser, in one line.
    pub problem: String,
}

impl Node {
    /// Parses a text; returns the root of the tree.
    pub fn parse(text: &str) -> Result<Node, NotToml> {
        let table = DeTable::parse(text).map_err(|error| not_toml(text, &error))?;
        let lines = LineTable::new(text);
        Ok(Node {
            line: 1,
            value: lines.table(table.get_ref()),
        })
    }

    /// Returns the value of a key in a table, or the item at a place in a list.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(entries) => entries
                .iter()
                .find(|(name, _)| name == key)
                .map(|(_, node)| node),
            Value::List(items) => items.get(key.parse::<usize>().ok()?),
            Value::Text(_)
            | Value::Whole(_)
            | Value::Number(_)
            | Value::Flag(_)
            | Value::Date(_) => None,
        }
    }

    /// Follows a dotted path as far as it exists. Returns the last node reached, and true when the whole path exists.
    pub fn find(&self, path: &str) -> (&Node, bool) {
        let mut node = self;
        for key in path.split('.').filter(|key| !key.is_empty()) {
            match node.get(key) {
                Some(next) => node = next,
                None => return (node, false),
            }
        }
        (node, true)
    }

    /// Returns the path of the last value that begins in `line` or before it; empty for the root.
    pub fn path_at(&self, line: usize) -> String {
        let found = match &self.value {
            Value::Table(entries) => {
                let mut named = entries.iter().map(|(name, node)| (name.clone(), node));
                named.rfind(|(_, node)| node.line <= line)
            }
            Value::List(items) => {
                let mut numbered = items.iter().enumerate();
                let found = numbered.rfind(|(_, node)| node.line <= line);
                found.map(|(at, node)| (at.to_string(), node))
            }
            Value::Text(_)
            | Value::Whole(_)
            | Value::Number(_)
            | Value::Flag(_)
            | Value::Date(_) => None,
        };
        let Some((name, node)) = found else {
            return String::new();
        };
        match node.path_at(line).as_str() {
            "" => name,
            deeper => format!("{name}.{deeper}"),
        }
    }

    /// Returns true for a table.
    pub fn is_table(&self) -> bool {
        matches!(self.value, Value::Table(_))
    }

    /// Returns the value in words, as messages show it.
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("\"{text}\""),
            Value::Whole(number) => number.to_string(),
            Value::Number(number) => format!("{number:?}"),
            Value::Flag(flag) => flag.to_string(),
            Value::Date(date) => format!("the date {date}"),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }
}

/// Converts an error of the TOML parser of `text`: its message, with the line number.
pub fn not_toml(text: &str, error: &toml::de::Error) -> NotToml {
    let at = error.span().map_or(0, |span| span.start);
    let problem = error.message().lines().collect::<Vec<_>>().join(", ");
    NotToml {
        line: LineTable::new(text).line(at),
        problem,
    }
}

/// Byte offset at which each line begins.
struct LineTable(Vec<usize>);

impl LineTable {
    fn new(text: &str) -> Self {
        let starts = text
            .bytes()
            .enumerate()
            .filter(|(_, byte)| *byte == b'\n')
            .map(|(at, _)| at + 1);
        Self(std::iter::once(0).chain(starts).collect())
    }

    fn line(&self, offset: usize) -> usize {
        self.0.partition_point(|start| *start <= offset)
    }

    fn table(&self, table: &DeTable<'_>) -> Value {
        let mut entries: Vec<_> = table
            .iter()
            .map(|(key, value)| {
                let line = self.line(key.span().start);
                (
                    key.span().start,
                    key.get_ref().to_string(),
                    Node {
                        line,
                        value: self.value(value),
                    },
                )
            })
            .collect();
        entries.sort_by_key(|(start, _, _)| *start);
        Value::Table(
            entries
                .into_iter()
                .map(|(_, key, node)| (key, node))
                .collect(),
        )
    }

    fn value(&self, value: &Spanned<DeValue<'_>>) -> Value {
        match value.get_ref() {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(number) => parse_whole(number.as_str(), number.radix()),
            DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(flag) => Value::Flag(*flag),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(items) => Value::List(
                items
                    .iter()
                    .map(|item| Node {
                        line: self.line(item.span().start),
                        value: self.value(item),
                    })
                    .collect(),
            ),
            DeValue::Table(table) => self.table(table),
        }
    }
}

/// Reads a whole number; one that needs more than 64 bits becomes infinite, so that a range check refuses it.
fn parse_whole(digits: &str, radix: u32) -> Value {
    match i64::from_str_radix(digits, radix) {
        Ok(number) => Value::Whole(number),
        Err(_) => Value::Number(f64::INFINITY),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const TEXT: &str =
        "a = 1\n\n[module.rtd]\ntype = \"20\"\n[[golden]]\nu = 1\n[[golden]]\nu = 2.5\n";

    #[test]
    fn every_value_knows_its_line() {
        let root = Node::parse(TEXT).unwrap();
        let (node, whole) = root.find("module.rtd.type");
        assert!(whole);
        assert_eq!((node.line, node.describe()), (4, "\"20\"".to_owned()));
        assert_eq!(root.find("golden.1.u").0.line, 8);
        assert_eq!(root.find("module.rtd.format").0.line, 3);
    }

    #[test]
    fn a_key_given_twice_is_refused_with_its_line() {
        let fault = Node::parse("a = 1\nb = 2\na = 3\n").unwrap_err();
        assert_eq!(fault.line, 3);
        assert!(fault.problem.contains("duplicate key"), "{}", fault.problem);
    }
}
