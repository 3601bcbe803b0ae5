//! Tables of TOML files, read key by key. An error gives file, line and key, the value found and the form expected.
//!
//! A [`Table`] remembers the keys that its caller asks for, so that [`Table::finish`] can refuse every other key and
//! list the known ones. Only [`Read`] is generic, with a few lines per type: derived parsers of all tables would take
//! half the compile time of this crate.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use toml::de::{DeString, DeTable, DeValue};
use toml::{Spanned, Value};

use crate::config::ConfigError;

/// Where a value is: file, line from 1, and key as a dotted path.
#[derive(Debug, Clone)]
struct Place {
    file: Arc<Path>,
    line: usize,
    key: String,
}

/// A value with its place and its text in the file.
#[derive(Debug, Clone)]
pub struct Entry {
    place: Place,
    written: String,
    /// Value of a text, a number or a flag; `None` for any other kind of value.
    leaf: Option<Value>,
    list: Option<Vec<Entry>>,
    table: Option<Table>,
}

/// One table, with its entries by key.
#[derive(Debug, Clone)]
pub struct Table {
    place: Place,
    entries: BTreeMap<String, Entry>,
    /// Keys that the caller has asked for.
    asked: RefCell<BTreeSet<&'static str>>,
}

/// A type that a file can hold.
pub trait Read: Sized {
    /// Form of the value, for messages.
    const FORM: &'static str;

    /// Reads the value of an entry.
    fn read(entry: &Entry) -> Result<Self, ConfigError>;

    /// Returns the value of a missing key; `None` when the key is required.
    fn missing() -> Option<Self> {
        None
    }
}

impl Place {
    fn error(&self, found: &str, expected: &str) -> ConfigError {
        ConfigError::Value {
            path: self.file.to_path_buf(),
            line: self.line,
            key: self.key.clone(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    fn below(&self, key: &str) -> Self {
        let key = match self.key.is_empty() {
            true => key.into(),
            false => format!("{}.{key}", self.key),
        };
        Self {
            key,
            ..self.clone()
        }
    }
}

impl Entry {
    /// Builds the error for an unfit value.
    pub fn wrong(&self, expected: &str) -> ConfigError {
        self.place.error(&self.written, expected)
    }

    /// Returns the value as a table; fails when it is not a table.
    pub fn table(&self) -> Result<&Table, ConfigError> {
        self.table.as_ref().ok_or_else(|| self.wrong("a table"))
    }

    /// Returns the entries of a list; `None` for another value.
    pub fn list(&self) -> Option<&[Self]> {
        self.list.as_deref()
    }

    /// Returns the text; `None` for another value.
    pub fn text(&self) -> Option<&str> {
        self.leaf.as_ref()?.as_str()
    }

    /// Returns an integer or a floating-point number; `None` for another value.
    pub fn number(&self) -> Option<f64> {
        let leaf = self.leaf.as_ref()?;
        leaf.as_float()
            .or_else(|| leaf.as_integer().map(|whole| whole as f64))
    }

    /// Returns an integer that fits `T`; `None` for another value.
    pub fn whole<T: TryFrom<i64>>(&self) -> Option<T> {
        T::try_from(self.leaf.as_ref()?.as_integer()?).ok()
    }

    /// Returns true or false; `None` for another value.
    pub fn flag(&self) -> Option<bool> {
        self.leaf.as_ref()?.as_bool()
    }
}

impl Table {
    /// Reads and parses a file.
    pub fn of_file(path: &Path) -> Result<Self, ConfigError> {
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(path, &text),
            Err(source) => Err(ConfigError::Read {
                path: path.into(),
                source,
            }),
        }
    }

    /// Parses the text of a file; `path` is its name in messages.
    pub fn parse(path: &Path, text: &str) -> Result<Self, ConfigError> {
        let source = Source {
            text,
            ends: text.match_indices('\n').map(|(at, _)| at).collect(),
        };
        let place = |line| Place {
            file: path.into(),
            line,
            key: String::new(),
        };
        match DeTable::parse(text) {
            Ok(keys) => Ok(source.table(&place(1), keys.get_ref())),
            Err(error) => Err(ConfigError::Syntax {
                path: path.into(),
                line: source.line(error.span().map_or(0, |span| span.start)),
                message: error.message().lines().collect::<Vec<_>>().join(" "),
            }),
        }
    }

    /// Returns the table as the value of an entry.
    pub fn into_entry(self) -> Entry {
        Entry {
            place: self.place.clone(),
            written: String::new(),
            leaf: None,
            list: None,
            table: Some(self),
        }
    }

    /// Returns the entry of a key, if present; from then on, [`Self::finish`] accepts this key.
    pub fn find(&self, key: &'static str) -> Option<&Entry> {
        self.asked.borrow_mut().insert(key);
        self.entries.get(key)
    }

    /// Reads the value of a key; fails when it does not fit `T`, or is missing and `T` has no value for that.
    pub fn get<T: Read>(&self, key: &'static str) -> Result<T, ConfigError> {
        match self.find(key) {
            Some(entry) => T::read(entry),
            None => T::missing().ok_or_else(|| self.wrong(key, T::FORM)),
        }
    }

    /// Reads the value of a key; returns `absent` when the table lacks the key.
    pub fn get_or<T: Read>(&self, key: &'static str, absent: T) -> Result<T, ConfigError> {
        Ok(self.get::<Option<T>>(key)?.unwrap_or(absent))
    }

    /// Converts the value of a key, if present; fails when the conversion returns `None`. `form` describes the
    /// permitted values in the message.
    pub fn fit<'a, T>(
        &'a self,
        key: &'static str,
        form: &str,
        convert: impl FnOnce(&'a Entry) -> Option<T>,
    ) -> Result<Option<T>, ConfigError> {
        match self.find(key) {
            None => Ok(None),
            Some(entry) => convert(entry).map(Some).ok_or_else(|| entry.wrong(form)),
        }
    }

    /// Builds the error for an unfit or missing value of a key.
    pub fn wrong(&self, key: &'static str, expected: &str) -> ConfigError {
        match self.find(key) {
            Some(entry) => entry.wrong(expected),
            None => self.place.below(key).error("nothing", expected),
        }
    }

    /// Builds the error for an unfit name of this table.
    pub fn wrong_name(&self, expected: &str) -> ConfigError {
        self.place.error(&self.place.key, expected)
    }

    /// Fails at the first key that the caller has not asked for.
    pub fn finish(&self) -> Result<(), ConfigError> {
        let asked = self.asked.borrow();
        let unknown = |(key, _): &(&String, &Entry)| !asked.contains(key.as_str());
        match self.entries.iter().find(unknown) {
            None => Ok(()),
            Some((_, entry)) => {
                let known: Vec<&str> = asked.iter().copied().collect();
                let expected = format!("one of {}", known.join(", "));
                Err(entry.place.error("an unknown key", &expected))
            }
        }
    }

    /// Replaces values by those of `over`, key by key; keys that `over` lacks keep their values.
    pub fn overlay(&mut self, over: Self) {
        for (key, mut entry) in over.entries {
            let own = self.entries.get_mut(&key).map(|own| &mut own.table);
            match (own, entry.table.take()) {
                (Some(Some(own)), Some(over)) => own.overlay(over),
                (_, table) => {
                    self.entries.insert(key, Entry { table, ..entry });
                }
            }
        }
    }
}

/// Text of a file, with the places of its line ends.
struct Source<'a> {
    text: &'a str,
    ends: Vec<usize>,
}

impl Source<'_> {
    fn line(&self, at: usize) -> usize {
        self.ends.partition_point(|end| *end < at) + 1
    }

    fn table(&self, place: &Place, keys: &DeTable<'_>) -> Table {
        let entry = |(key, value): (&Spanned<DeString<'_>>, &_)| {
            let key: &str = key.get_ref();
            (key.to_owned(), self.entry(place.below(key), value))
        };
        Table {
            place: place.clone(),
            entries: keys.iter().map(entry).collect(),
            asked: RefCell::default(),
        }
    }

    fn entry(&self, place: Place, value: &Spanned<DeValue<'_>>) -> Entry {
        let line = self.line(value.span().start);
        let place = Place { line, ..place };
        let value_text = self.text.get(value.span()).unwrap_or_default();
        let value = value.get_ref();
        Entry {
            leaf: leaf(value),
            list: value.as_array().map(|items| {
                let item = |(n, item)| {
                    let key = format!("{}[{n}]", place.key);
                    let place = Place {
                        key,
                        ..place.clone()
                    };
                    self.entry(place, item)
                };
                items.iter().enumerate().map(item).collect()
            }),
            table: value.as_table().map(|keys| self.table(&place, keys)),
            written: match value.is_table() {
                true => "a table".into(),
                false => value_text.split_whitespace().collect::<Vec<_>>().join(" "),
            },
            place,
        }
    }
}

/// Returns text, number or flag; `None` for a list, a table, a date or an integer beyond 64 bits.
fn leaf(value: &DeValue<'_>) -> Option<Value> {
    match value {
        DeValue::String(text) => Some(Value::String(text.clone().into_owned())),
        DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix())
            .ok()
            .map(Value::Integer),
        DeValue::Float(number) => number.as_str().parse().ok().map(Value::Float),
        DeValue::Boolean(flag) => Some(Value::Boolean(*flag)),
        DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => None,
    }
}

/// Implements [`Read`] for types of one value.
macro_rules! values {
    ($($type:ty: $form:literal, $get:expr;)*) => { $(
        impl Read for $type {
            const FORM: &'static str = $form;

            fn read(entry: &Entry) -> Result<Self, ConfigError> {
                let get: fn(&Entry) -> Option<Self> = $get;
                get(entry).ok_or_else(|| entry.wrong(Self::FORM))
            }
        }
    )* };
}

values! {
    f64: "a number", Entry::number;
    bool: "true or false", Entry::flag;
    u8: "a whole number from 0 to 255", Entry::whole;
    u64: "a whole number, 0 or more", Entry::whole;
    String: "text", |entry| entry.text().map(str::to_owned);
    Table: "a table", |entry| entry.table().ok().cloned();
}

impl<T: Read> Read for Option<T> {
    const FORM: &'static str = T::FORM;

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        T::read(entry).map(Some)
    }

    fn missing() -> Option<Self> {
        Some(None)
    }
}

impl<T: Read> Read for Vec<T> {
    const FORM: &'static str = "a list";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let items = entry.list().ok_or_else(|| entry.wrong(Self::FORM))?;
        items.iter().map(T::read).collect()
    }
}

impl<T: Read, const N: usize> Read for [T; N] {
    const FORM: &'static str = "a list";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let all = Vec::read(entry)?.try_into();
        all.map_err(|_| entry.wrong(&format!("a list of {N} values")))
    }
}

impl<T: Read> Read for BTreeMap<String, T> {
    const FORM: &'static str = "a table";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let each = entry.table()?.entries.iter();
        each.map(|(name, entry)| Ok((name.clone(), T::read(entry)?)))
            .collect()
    }
}

/// Implements [`Read`] for a struct whose fields are keys. A field may have a default for a missing key; `finish`
/// refuses unknown keys.
macro_rules! read_fields {
    ($name:ident { $($field:ident $(= $absent:expr)?),* $(,)? } $(, $finish:ident)?) => {
        impl $crate::table::Read for $name {
            const FORM: &'static str = "a table";

            fn read(entry: &$crate::table::Entry) -> Result<Self, $crate::config::ConfigError> {
                let keys = entry.table()?;
                let read = Self { $($field: $crate::table::read_fields!(@ keys $field $($absent)?)),* };
                $(keys.$finish()?;)?
                Ok(read)
            }
        }
    };
    (@ $keys:ident $field:ident) => { $keys.get(stringify!($field))? };
    (@ $keys:ident $field:ident $absent:expr) => { $keys.get_or(stringify!($field), $absent)? };
}
pub(crate) use read_fields;

/// Implements [`Read`] for a choice of words, each with its value.
macro_rules! read_words {
    ($type:ty { $first:literal => $one:expr $(, $word:literal => $value:expr)* $(,)? }) => {
        impl $crate::table::Read for $type {
            const FORM: &'static str = concat!("one of ", $first $(, ", ", $word)*);

            fn read(entry: &$crate::table::Entry) -> Result<Self, $crate::config::ConfigError> {
                match entry.text() {
                    Some($first) => Ok($one),
                    $(Some($word) => Ok($value),)*
                    Some(_) | None => Err(entry.wrong(Self::FORM)),
                }
            }
        }
    };
}
pub(crate) use read_words;

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn table(text: &str) -> Table {
        Table::parse(Path::new("x.toml"), text).unwrap()
    }

    #[test]
    fn an_error_names_file_line_key_and_value() {
        let keys = table("a = 1\n[b]\nc = [\n  1.0,\n  'x',\n]\n");
        let lists = keys.get::<BTreeMap<String, Vec<f64>>>("b");
        let error = lists.unwrap_err().to_string();
        assert_eq!(error, "x.toml:5: b.c[1]: found 'x', expected a number");
        let error = keys.get::<[f64; 2]>("d").unwrap_err().to_string();
        assert_eq!(error, "x.toml:1: d: found nothing, expected a list");
        let error = Table::parse(Path::new("x.toml"), "a = 1\nb = ").unwrap_err();
        assert!(error.to_string().starts_with("x.toml:2: "), "{error}");
    }

    #[test]
    fn a_key_that_the_caller_never_reads_is_refused() {
        let keys = table("a = 1\n[[b]]\nz = 2\n[[b]]\ny = 3\n");
        assert_eq!(keys.get::<u8>("a").unwrap(), 1);
        let lists: Vec<Table> = keys.get("b").unwrap();
        assert_eq!(keys.get::<Option<String>>("c").unwrap(), None);
        keys.finish().unwrap();
        assert_eq!(lists[1].get::<Option<f64>>("x").unwrap(), None);
        let error = lists[1].finish().unwrap_err().to_string();
        let expected = "x.toml:5: b[1].y: found an unknown key, expected one of x";
        assert_eq!(error, expected);
    }

    #[test]
    fn an_overlay_replaces_single_keys() {
        let mut keys = table("[a]\nb = 1\nc = 2\n[d]\ne = 3\n");
        keys.overlay(Table::parse(Path::new("y.toml"), "[a]\nc = 'four'\n").unwrap());
        let a: Table = keys.get("a").unwrap();
        assert_eq!(a.get::<f64>("b").unwrap(), 1.0);
        let error = a.get::<f64>("c").unwrap_err().to_string();
        assert_eq!(error, "y.toml:2: a.c: found 'four', expected a number");
    }
}
