//! A field of a JSON file with its path, which error messages name.

use anyhow::{anyhow, bail};
use serde_json::{Map, Value};

/// A JSON value and its path in the file.
#[derive(Clone)]
pub struct Field<'a> {
    path: String,
    value: &'a Value,
}

impl<'a> Field<'a> {
    /// Returns the field of the whole file.
    pub fn root(value: &'a Value) -> Self {
        Self {
            path: String::new(),
            value,
        }
    }

    /// Returns an error that names the path, the found value and the expected one.
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

    /// Returns the path of the member `key`.
    fn below(&self, key: &str) -> String {
        let dot = if self.path.is_empty() { "" } else { "." };
        format!("{}{dot}{key}", self.path)
    }

    /// Returns a member; `None` when it is absent or null.
    ///
    /// # Errors
    /// Fails when the field is not an object.
    pub fn member(&self, key: &str) -> anyhow::Result<Option<Field<'a>>> {
        let value = self.object()?.get(key).filter(|value| !value.is_null());
        let path = self.below(key);
        Ok(value.map(|value| Field { path, value }))
    }

    /// Returns a required member.
    ///
    /// # Errors
    /// Fails when the member is absent or null, or when the field is not an object.
    pub fn must(&self, key: &str, expected: &str) -> anyhow::Result<Field<'a>> {
        let missing = || anyhow!("{}: missing, expected {expected}", self.below(key));
        self.member(key)?.ok_or_else(missing)
    }

    /// Returns all members.
    ///
    /// # Errors
    /// Fails when a member has a name that is not in `known`, or when the field is not an object.
    pub fn members(&self, known: &[&str]) -> anyhow::Result<Vec<(&'a str, Field<'a>)>> {
        let mut all = Vec::new();
        for (key, value) in self.object()? {
            let path = self.below(key);
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

    /// Returns the elements of a list.
    ///
    /// # Errors
    /// Fails when the field is not a list.
    pub fn list(&self, expected: &str) -> anyhow::Result<Vec<Field<'a>>> {
        let list = self.value.as_array().ok_or_else(|| self.wrong(expected))?;
        let one = |(at, value)| Field {
            path: format!("{}[{at}]", self.path),
            value,
        };
        Ok(list.iter().enumerate().map(one).collect())
    }

    /// Returns `N` finite numbers.
    ///
    /// # Errors
    /// Fails when the field is not a list of `N` finite numbers.
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

    /// Returns a finite number.
    ///
    /// # Errors
    /// Fails when the field is not a finite number.
    pub fn number(&self) -> anyhow::Result<f64> {
        let number = self.value.as_f64().filter(|number| number.is_finite());
        number.ok_or_else(|| self.wrong("a finite number"))
    }

    /// Returns a text.
    ///
    /// # Errors
    /// Fails when the field is not a text.
    pub fn text(&self) -> anyhow::Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.wrong("a text"))
    }
}
