//! Checks a file against its [`Form`]: every key is known and present, every value has its type and range.
//!
//! Rules between values (an address used twice, low above high) belong to the module that owns the settings; that
//! module reports a broken rule as a [`Fault`].

use super::error::ConfigError;
use super::nearest::{nearest, suggestion};
use super::tree::{Node, Value};
use machine::form::{Form, Key, Points, Range};
use machine::rig::fault::{Fault, Requirement};
use std::path::PathBuf;

/// Faults in the order of the file; within a table, missing keys come last.
pub type Faults = Vec<ConfigError>;

/// A parsed file.
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
        self.faults(keys).into_iter().next().map_or(Ok(()), Err)
    }

    /// Returns a fault for every key that is missing or that `keys` does not allow.
    pub fn faults(&self, keys: &[Key]) -> Faults {
        let mut faults = Faults::new();
        self.table("", &self.root, keys, &mut faults);
        faults
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
        let key = self.label(&fault.key);
        self.error_at(
            &fault.key,
            key,
            fault.found.clone(),
            expected,
            fault.requirement.clone(),
        )
    }

    fn value_error(&self, path: &str, found: String, expected: String) -> ConfigError {
        self.error_at(
            path,
            self.label(path),
            found,
            expected,
            Box::new(Requirement::Form),
        )
    }

    fn error_at(
        &self,
        path: &str,
        key: String,
        found: String,
        expected: String,
        requirement: Box<Requirement>,
    ) -> ConfigError {
        ConfigError::Value {
            file: self.path.clone(),
            line: self.root.find(path).0.line,
            key,
            found,
            expected,
            requirement,
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
        for (index, name) in names.iter().enumerate().skip(header) {
            let parent = self.root.find(&names[..index].join(".")).0;
            if name.parse::<usize>().is_ok() && !parent.is_table() {
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

    fn form(&self, path: &str, node: &Node, form: &Form, faults: &mut Faults) {
        match form {
            Form::Table(keys) => self.table(path, node, keys, faults),
            Form::Named(entry) => self.named(path, node, (&[], true), entry, faults),
            Form::NamedWith(names, entry) => self.named(path, node, (names, true), entry, faults),
            Form::Each(names, entry) => self.named(path, node, (names, false), entry, faults),
            Form::Points(points) => self.points(path, node, points, faults),
            Form::List(entry) => self.list(path, node, entry, faults),
            Form::Numbers(count, range) => self.numbers(path, node, *count, range, faults),
            Form::Text
            | Form::Choice(_)
            | Form::Hex(_)
            | Form::Number(_)
            | Form::Whole { .. }
            | Form::Listed(_)
            | Form::Flag => {
                if !plain_value_fits(&node.value, form) {
                    faults.push(self.value_error(path, node.describe(), form.expected()));
                }
            }
        }
    }

    fn table(&self, path: &str, node: &Node, keys: &[Key], faults: &mut Faults) {
        let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
        let entries = self.entries(path, node, faults);
        for (name, entry) in entries {
            match keys.iter().find(|key| key.name == name) {
                Some(key) => self.form(&join(path, name), entry, &key.form, faults),
                None => faults.push(self.unknown(path, name, &names)),
            }
        }
        let needed = keys.iter().filter(|key| !key.optional);
        let needed = needed.map(|key| (key.name, &key.form));
        self.needed(path, entries, &names, needed, faults);
    }

    /// Checks entries that all have one form: names in `needed` must exist; other names are allowed when `free`.
    fn named(
        &self,
        path: &str,
        node: &Node,
        (needed, free): (&[&str], bool),
        form: &Form,
        faults: &mut Faults,
    ) {
        let entries = self.entries(path, node, faults);
        for (name, entry) in entries {
            let own = join(path, name);
            if !free && !needed.contains(&name.as_str()) {
                faults.push(self.unknown(path, name, needed));
            } else if free && !is_plain_name(name) {
                let expected = "a name of lower-case letters, digits and underscores".to_owned();
                faults.push(self.value_error(&own, format!("the name \"{name}\""), expected));
            } else {
                self.form(&own, entry, form, faults);
            }
        }
        let all = needed.iter().map(|name| (*name, form));
        self.needed(path, entries, needed, all, faults);
    }

    fn points(&self, path: &str, node: &Node, points: &Points, faults: &mut Faults) {
        let names = points.names();
        let entries = self.entries(path, node, faults);
        for (name, entry) in entries {
            if points.free || names.contains(&name.as_str()) {
                self.form(&join(path, name), entry, points.entry, faults);
            } else {
                faults.push(self.unknown(path, name, &names));
            }
        }
        for missing in points.must.iter().filter(|name| node.get(name).is_none()) {
            // A free name that resembles a missing one is a misspelling.
            faults.extend(match (points.free, slip(entries, &names, missing)) {
                (true, Some(name)) => Some(self.unknown(path, name, &names)),
                (false, Some(_)) => None,
                (true | false, None) => Some(self.missing(path, missing, points.entry)),
            });
        }
    }

    /// Reports each missing name of `needed`, except a name that some unknown entry resembles: the check of that entry
    /// has already reported the misspelling.
    fn needed<'a>(
        &self,
        path: &str,
        entries: &[(String, Node)],
        names: &[&str],
        needed: impl Iterator<Item = (&'a str, &'a Form)>,
        faults: &mut Faults,
    ) {
        let missing = needed
            .filter(|(name, _)| !entries.iter().any(|(entry, _)| entry == name))
            .filter(|(name, _)| slip(entries, names, name).is_none());
        faults.extend(missing.map(|(name, form)| self.missing(path, name, form)));
    }

    fn list(&self, path: &str, node: &Node, form: &Form, faults: &mut Faults) {
        let Value::List(items) = &node.value else {
            return faults.push(self.value_error(path, node.describe(), "a list".to_owned()));
        };
        for (index, item) in items.iter().enumerate() {
            self.form(&join(path, &index.to_string()), item, form, faults);
        }
    }

    fn numbers(&self, path: &str, node: &Node, count: usize, range: &Range, faults: &mut Faults) {
        if matches!(&node.value, Value::List(items) if items.len() == count) {
            return self.list(path, node, &Form::Number(*range), faults);
        }
        let expected = Form::Numbers(count, *range).expected();
        faults.push(self.value_error(path, node.describe(), expected));
    }

    /// Returns the entries of a table. For any other value, reports a fault and returns no entries.
    fn entries<'a>(&self, path: &str, node: &'a Node, faults: &mut Faults) -> &'a [(String, Node)] {
        let Value::Table(entries) = &node.value else {
            faults.push(self.value_error(path, node.describe(), "a table".to_owned()));
            return &[];
        };
        entries
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
        self.error_at(
            path,
            key,
            "nothing".to_owned(),
            form.expected(),
            Box::new(Requirement::Form),
        )
    }
}

/// Returns the unknown name among `entries` that looks like a misspelling of `missing`; `None` when there is none.
fn slip<'a>(entries: &'a [(String, Node)], names: &[&str], missing: &str) -> Option<&'a str> {
    let mut others = entries.iter().map(|(name, _)| name.as_str());
    others.find(|name| !names.contains(name) && nearest(name, &[missing]).is_some())
}

/// Returns how many leading names belong to the header of a table: two in `[module.rtd]`, one in `[bus]`.
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
