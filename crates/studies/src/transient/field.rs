//! A field of a JSON file with the path under which a message names it.

use anyhow::{anyhow, bail};
use serde_json::{Map, Value};

/// A value and where it stands.
#[derive(Clone)]
pub struct Field<'a> {
    path: String,
    value: &'a Value,
}

impl<'a> Field<'a> {
    /// The whole file.
    pub fn root(value: &'a Value) -> Self {
        Self {
            path: String::new(),
            value,
        }
    }

    /// What was found and what was expected, as an error.
    pub fn wrong(&self, expected: &str) -> anyhow::Error {
        let path = if self.path.is_empty() {
            "the file"
        } else {
            &self.path
        };
        let mut found = self.value.to_string();
        if found.len() > 60 {
            let end = (0..=57)
                .rev()
                .find(|&i| found.is_char_boundary(i))
                .unwrap_or(0);
            found.truncate(end);
            found.push_str("...");
        }
        anyhow!("{path}: found {found}, expected {expected}")
    }

    /// A member that may be absent or null.
    ///
    /// # Errors
    /// This is no object.
    pub fn member(&self, key: &str) -> anyhow::Result<Option<Field<'a>>> {
        let dot = if self.path.is_empty() { "" } else { "." };
        Ok(self
            .object()?
            .get(key)
            .filter(|value| !value.is_null())
            .map(|value| Field {
                path: format!("{}{dot}{key}", self.path),
                value,
            }))
    }

    /// A member that must be there.
    ///
    /// # Errors
    /// It is absent or null, or this is no object.
    pub fn must(&self, key: &str, expected: &str) -> anyhow::Result<Field<'a>> {
        let dot = if self.path.is_empty() { "" } else { "." };
        self.member(key)?
            .ok_or_else(|| anyhow!("{}{dot}{key}: missing, expected {expected}", self.path))
    }

    /// Members, none of which may have another name than those known.
    ///
    /// # Errors
    /// A name is unknown, or this is no object.
    pub fn members(&self, known: &[&str]) -> anyhow::Result<Vec<(&'a str, Field<'a>)>> {
        let dot = if self.path.is_empty() { "" } else { "." };
        let mut all = Vec::new();
        for (key, value) in self.object()? {
            let path = format!("{}{dot}{key}", self.path);
            if !known.contains(&key.as_str()) {
                bail!("{path}: unknown, expected one of {}", known.join(", "));
            }
            all.push((key.as_str(), Field { path, value }));
        }
        Ok(all)
    }

    fn object(&self) -> anyhow::Result<&'a Map<String, Value>> {
        self.value
            .as_object()
            .ok_or_else(|| self.wrong("an object"))
    }

    /// Elements of a list.
    ///
    /// # Errors
    /// This is no list.
    pub fn list(&self, expected: &str) -> anyhow::Result<Vec<Field<'a>>> {
        let list = self.value.as_array().ok_or_else(|| self.wrong(expected))?;
        let one = |(at, value)| Field {
            path: format!("{}[{at}]", self.path),
            value,
        };
        Ok(list.iter().enumerate().map(one).collect())
    }

    /// So many finite numbers.
    ///
    /// # Errors
    /// This is something else.
    pub fn numbers<const N: usize>(&self, expected: &str) -> anyhow::Result<[f64; N]> {
        let list = self.list(expected)?;
        if list.len() != N {
            return Err(self.wrong(expected));
        }
        let mut numbers = [0.0; N];
        for (number, field) in numbers.iter_mut().zip(list) {
            *number = field.number()?;
        }
        Ok(numbers)
    }

    /// A finite number.
    ///
    /// # Errors
    /// This is something else.
    pub fn number(&self) -> anyhow::Result<f64> {
        let number = self.value.as_f64().filter(|number| number.is_finite());
        number.ok_or_else(|| self.wrong("a finite number"))
    }

    /// A text.
    ///
    /// # Errors
    /// This is something else.
    pub fn text(&self) -> anyhow::Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.wrong("a text"))
    }
}
