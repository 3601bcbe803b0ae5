//! Checks a file against its [`Form`]: every key is known and present, every value has its type and range.
//!
//! Rules between values (an address used twice, low above high) belong to the module that owns the settings; that
//! module reports a broken rule as a [`Fault`].

use super::error::ConfigError;
use super::nearest::{nearest, suggestion};
use super::tree::{Node, Value};
use machine::form::{Form, Key, Points, Range};
use machine::rig::fault::Fault;
use std::path::PathBuf;

/// A configuration file, parsed.
#[derive(Debug)]
pub struct File {
    /// Path that messages name.
    pub path: PathBuf,
    /// Content of the file.
    pub text: String,
    /// Tree of the parsed content.
    pub root: Node,
}

impl File {
    /// Checks every key; fails on the first key that is missing or that `keys` does not allow.
    pub fn check(&self, keys: &[Key]) -> Result<(), ConfigError> {
        self.table("", &self.root, keys)
    }

    /// Turns a fault that another module found into an error with file and line.
    pub fn locate(&self, fault: &Fault) -> ConfigError {
        if let Some((path, name)) = fault
            .key
            .rsplit_once('.')
            .filter(|_| !fault.known.is_empty())
        {
            let known: Vec<&str> = fault.known.iter().map(String::as_str).collect();
            return self.unknown(path, name, &known);
        }
        let expected = match &fault.other {
            Some(other) => {
                let line = self.root.find(other).0.line;
                let label = self.label(other);
                format!("{} (line {line}: {label})", fault.expected)
            }
            None => fault.expected.clone(),
        };
        self.value_error(&fault.key, fault.found.clone(), expected)
    }

    fn value_error(&self, path: &str, found: String, expected: String) -> ConfigError {
        self.error_at(path, self.label(path), found, expected)
    }

    fn error_at(&self, path: &str, key: String, found: String, expected: String) -> ConfigError {
        ConfigError::Value {
            file: self.path.clone(),
            line: self.root.find(path).0.line,
            key,
            found,
            expected,
        }
    }

    /// Returns a path as the file would write it: `[module.rtd].type`, `golden[1].serial`, `[part].body_mm[2]`.
    pub(super) fn label(&self, path: &str) -> String {
        let names: Vec<&str> = path.split('.').collect();
        let header = header_length(&self.root, &names);
        let mut label = if header > 0 {
            format!("[{}]", names[..header].join("."))
        } else {
            String::new()
        };
        for name in &names[header..] {
            if name.parse::<usize>().is_ok() {
                label.push_str(&format!("[{name}]"));
            } else {
                if !label.is_empty() {
                    label.push('.');
                }
                label.push_str(name);
            }
        }
        label
    }

    fn form(&self, path: &str, node: &Node, form: &Form) -> Result<(), ConfigError> {
        match form {
            Form::Table(keys) => self.table(path, node, keys),
            Form::Named(entry) => self.named(path, node, (&[], true), entry),
            Form::NamedWith(names, entry) => self.named(path, node, (names, true), entry),
            Form::Each(names, entry) => self.named(path, node, (names, false), entry),
            Form::Points(points) => self.points(path, node, points),
            Form::List(entry) => self.list(path, node, entry),
            Form::Numbers(count, range) => self.numbers(path, node, *count, range),
            Form::Text
            | Form::Choice(_)
            | Form::Hex(_)
            | Form::Number(_)
            | Form::Whole { .. }
            | Form::Listed(_)
            | Form::Flag => {
                if plain_value_fits(&node.value, form) {
                    Ok(())
                } else {
                    Err(self.value_error(path, node.describe(), form.expected()))
                }
            }
        }
    }

    fn table(&self, path: &str, node: &Node, keys: &[Key]) -> Result<(), ConfigError> {
        let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
        for (name, entry) in self.entries(path, node)? {
            match keys.iter().find(|key| key.name == name) {
                Some(key) => self.form(&join(path, name), entry, &key.form)?,
                None => return Err(self.unknown(path, name, &names)),
            }
        }
        match keys
            .iter()
            .find(|key| !key.optional && node.get(key.name).is_none())
        {
            Some(missing) => Err(self.missing(path, missing.name, &missing.form)),
            None => Ok(()),
        }
    }

    /// Checks entries that all have one form: those in `needed` must exist; others may exist when names are `free`.
    fn named(
        &self,
        path: &str,
        node: &Node,
        (needed, free): (&[&str], bool),
        form: &Form,
    ) -> Result<(), ConfigError> {
        for (name, entry) in self.entries(path, node)? {
            let own = join(path, name);
            if !free && !needed.contains(&name.as_str()) {
                return Err(self.unknown(path, name, needed));
            }
            if free && !is_plain_name(name) {
                let expected = "a name of lower-case letters, digits and underscores".to_owned();
                return Err(self.value_error(&own, format!("the name \"{name}\""), expected));
            }
            self.form(&own, entry, form)?;
        }
        match needed.iter().find(|name| node.get(name).is_none()) {
            Some(missing) => Err(self.missing(path, missing, form)),
            None => Ok(()),
        }
    }

    fn points(&self, path: &str, node: &Node, points: &Points) -> Result<(), ConfigError> {
        let names = points.names();
        for (name, entry) in self.entries(path, node)? {
            if !points.free && !names.contains(&name.as_str()) {
                return Err(self.unknown(path, name, &names));
            }
            self.form(&join(path, name), entry, points.entry)?;
        }
        let mut must = points.must.iter();
        let Some(missing) = must.find(|name| node.get(name).is_none()) else {
            return Ok(());
        };
        // Where names are free, a name that resembles a missing one is a typing error.
        let mut others = self.entries(path, node)?.iter().map(|(name, _)| name);
        let slip = others
            .find(|name| !names.contains(&name.as_str()) && nearest(name, &[missing]).is_some());
        Err(match slip {
            Some(name) => self.unknown(path, name, &names),
            None => self.missing(path, missing, points.entry),
        })
    }

    fn list(&self, path: &str, node: &Node, form: &Form) -> Result<(), ConfigError> {
        let Value::List(items) = &node.value else {
            return Err(self.value_error(path, node.describe(), "a list".to_owned()));
        };
        for (index, item) in items.iter().enumerate() {
            self.form(&join(path, &index.to_string()), item, form)?;
        }
        Ok(())
    }

    fn numbers(
        &self,
        path: &str,
        node: &Node,
        count: usize,
        range: &Range,
    ) -> Result<(), ConfigError> {
        if !matches!(&node.value, Value::List(items) if items.len() == count) {
            let expected = Form::Numbers(count, *range).expected();
            return Err(self.value_error(path, node.describe(), expected));
        }
        self.list(path, node, &Form::Number(*range))
    }

    fn entries<'a>(&self, path: &str, node: &'a Node) -> Result<&'a [(String, Node)], ConfigError> {
        let Value::Table(entries) = &node.value else {
            return Err(self.value_error(path, node.describe(), "a table".to_owned()));
        };
        Ok(entries)
    }

    fn unknown(&self, path: &str, name: &str, known: &[&str]) -> ConfigError {
        let expected =
            nearest(name, known).map_or_else(|| format!("one of {}", known.join(", ")), suggestion);
        self.value_error(&join(path, name), "an unknown key".to_owned(), expected)
    }

    fn missing(&self, path: &str, name: &str, form: &Form) -> ConfigError {
        let own = join(path, name);
        let key = if path.is_empty() && form.is_table() {
            format!("[{name}]")
        } else {
            self.label(&own)
        };
        self.error_at(path, key, "nothing".to_owned(), form.expected())
    }
}

/// Returns how many of the first names form the header of a table: two in `[module.rtd]`, one in `[bus]`.
fn header_length(root: &Node, names: &[&str]) -> usize {
    let depth = if matches!(names.first(), Some(&"line" | &"module")) {
        2
    } else {
        1
    };
    let known_table = names
        .first()
        .and_then(|name| root.get(name))
        .is_some_and(Node::is_table);
    if known_table {
        depth.min(names.len())
    } else {
        0
    }
}

fn plain_value_fits(value: &Value, form: &Form) -> bool {
    match (form, value) {
        (Form::Text, Value::Text(text)) => !text.trim().is_empty(),
        (Form::Choice(words), Value::Text(text)) => words.contains(&text.as_str()),
        (Form::Hex(digits), Value::Text(text)) => {
            text.len() == *digits && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'A'..=b'F'))
        }
        (Form::Number(range), Value::Number(number)) => range.holds(*number),
        (Form::Number(range), Value::Whole(number)) => range.holds(*number as f64),
        (Form::Whole { low, high, .. }, Value::Whole(number)) => (low..=high).contains(&number),
        (Form::Listed(values), Value::Whole(number)) => values.contains(number),
        (Form::Flag, Value::Flag(_)) => true,
        (_, _) => false,
    }
}

fn is_plain_name(name: &str) -> bool {
    !name.is_empty()
        && name
            .bytes()
            .all(|c| matches!(c, b'a'..=b'z' | b'0'..=b'9' | b'_'))
}

fn join(path: &str, name: &str) -> String {
    if path.is_empty() {
        name.to_owned()
    } else {
        format!("{path}.{name}")
    }
}
