//! A recipe as a form to fill in: every key with unit, range and value.

use super::check::File;
use super::error::ConfigError;
use super::keys;
use super::recipes::kind_of;
use super::tree::{Node, Value};
use machine::form::{Form, Key, Range};
use serde::Serialize;
use serde_json::json;
use utoipa::ToSchema;

/// One key of a recipe, with its value.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Field {
    /// Path of the key, for example `limits.operate_voltage_v.high`; in a list with the place of the item, from 0, as
    /// in `prompt.0.text_en`.
    pub path: String,
    /// Values that the key accepts.
    #[serde(flatten)]
    pub entry: Entry,
    /// True when the key may be left out, or the optional table whose only key it is.
    pub optional: bool,
    /// Path to remove when the key is left out: its own, or that of an optional table whose only key it is.
    #[serde(skip)]
    pub(super) removed: String,
    /// Value in the file; null when the key is left out.
    pub value: serde_json::Value,
}

/// Values that a key accepts.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(tag = "form", rename_all = "snake_case")]
pub enum Entry {
    /// A text that is not empty.
    Text,
    /// One of these words.
    Choice {
        /// The accepted words.
        words: &'static [&'static str],
    },
    /// A number.
    Number(Bounds),
    /// A list of numbers.
    Numbers {
        /// Number of items in the list.
        count: usize,
        /// Range of each number.
        #[serde(flatten)]
        bounds: Bounds,
    },
    /// A whole number.
    Whole(Bounds),
    /// `true` or `false`.
    Flag,
}

impl Entry {
    /// Returns the unit of the value; empty without one.
    pub(super) fn unit(&self) -> &'static str {
        match self {
            Self::Number(bounds) | Self::Whole(bounds) | Self::Numbers { bounds, .. } => {
                bounds.unit
            }
            Self::Text | Self::Choice { .. } | Self::Flag => "",
        }
    }
}

/// Range of a number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
pub struct Bounds {
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Lower end of the range.
    pub low: f64,
    /// True when the lower end itself is allowed; the upper end always is.
    pub low_allowed: bool,
    /// Upper end of the range.
    pub high: f64,
}

impl From<&Range> for Bounds {
    fn from(range: &Range) -> Self {
        Self {
            unit: range.unit,
            low: range.low,
            low_allowed: range.low_allowed,
            high: range.high,
        }
    }
}

/// Returns every key that a recipe of this kind may have, in the order of `config/README.md`, with its value in the
/// file. For a list of tables, returns the keys of each item that the file has.
///
/// # Errors
/// Fails when the kind is missing or unknown.
pub fn fields(file: &File) -> Result<Vec<Field>, ConfigError> {
    let mut found = Vec::new();
    let keys = keys::recipe::of(kind_of(file)?);
    gather("", &keys, &file.root, &mut found);
    Ok(found)
}

fn gather(path: &str, keys: &[Key], root: &Node, found: &mut Vec<Field>) {
    for key in keys {
        let path = format!("{path}{}", key.name);
        if let Form::Table(inner) = &key.form {
            let from = found.len();
            gather(&format!("{path}."), inner, root, found);
            if let ([_only], true, [field]) = (*inner, key.optional, &mut found[from..]) {
                (field.optional, field.removed) = (true, path);
            }
        } else if let Form::List(Form::Table(inner)) = &key.form {
            let items = match root.find(&path) {
                (
                    Node {
                        value: Value::List(items),
                        ..
                    },
                    true,
                ) => items.len(),
                (_, _) => 0,
            };
            for place in 0..items {
                gather(&format!("{path}.{place}."), inner, root, found);
            }
        } else if let Some(entry) = entry(&key.form) {
            let value = match root.find(&path) {
                (node, true) => as_json(node),
                (_, false) => serde_json::Value::Null,
            };
            found.push(Field {
                removed: path.clone(),
                path,
                entry,
                optional: key.optional,
                value,
            });
        }
    }
}

/// Converts the form of a key; `None` for forms that no key of a recipe has.
fn entry(form: &Form) -> Option<Entry> {
    match form {
        Form::Text => Some(Entry::Text),
        Form::Choice(words) => Some(Entry::Choice { words }),
        Form::Number(range) => Some(Entry::Number(range.into())),
        Form::Numbers(count, range) => Some(Entry::Numbers {
            count: *count,
            bounds: range.into(),
        }),
        Form::Whole { unit, low, high } => Some(Entry::Whole(Bounds {
            unit,
            low: *low as f64,
            low_allowed: true,
            high: *high as f64,
        })),
        Form::Flag => Some(Entry::Flag),
        Form::Hex(_)
        | Form::Listed(_)
        | Form::Table(_)
        | Form::Named(_)
        | Form::NamedWith(..)
        | Form::Each(..)
        | Form::Points(_)
        | Form::List(_) => None,
    }
}

fn as_json(node: &Node) -> serde_json::Value {
    match &node.value {
        Value::Text(text) | Value::Date(text) => json!(text),
        Value::Whole(number) => json!(number),
        Value::Number(number) => json!(number),
        Value::Flag(flag) => json!(flag),
        Value::List(items) => items.iter().map(as_json).collect(),
        Value::Table(_) => serde_json::Value::Null,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use machine::dut::Kind;

    /// Returns the paths of all keys that are not tables, computed without the code under test.
    fn leaves(path: &str, keys: &[Key]) -> Vec<String> {
        let of = |key: &Key| match &key.form {
            Form::Table(inner) => leaves(&format!("{path}{}.", key.name), inner),
            Form::List(_) => Vec::new(),
            _ => vec![format!("{path}{}", key.name)],
        };
        keys.iter().flat_map(of).collect()
    }

    #[test]
    fn every_recipe_key_is_a_field_with_its_value() {
        let text = include_str!("../../../config/recipes/jzc-22f-012.toml");
        let file = File::parse("r.toml".into(), text.to_owned()).unwrap();
        let fields = fields(&file).unwrap();
        let paths: Vec<&str> = fields.iter().map(|it| it.path.as_str()).collect();
        assert_eq!(paths, leaves("", &keys::recipe::of(Kind::EmRelay)));
        let value = |path: &str| {
            fields
                .iter()
                .find(|it| it.path == path)
                .unwrap()
                .value
                .clone()
        };
        assert_eq!(value("part.body_mm"), json!([22.5, 16.5, 16.5]));
        assert_eq!(value("limits.operate_voltage_v.high"), json!(9.0));
        assert_eq!(value("limits.operate_voltage_v.low"), json!(null));
        assert_eq!(value("decision.slow_repeats"), json!(3));
        assert_eq!(value("test.clamp"), json!("zener"));
    }

    #[test]
    fn every_key_of_a_prompt_is_a_field() {
        let text = include_str!("../../../config/recipes/jzc-22f-012.toml").to_owned()
            + "[[prompt]]\nname = \"nest\"\nwhen = \"lot_end\"\nchoices = [{ name = \"a\" }, { name = \"b\" }]\n";
        let file = File::parse("r.toml".into(), text).unwrap();
        let fields = fields(&file).unwrap();
        let of = |path: &str| fields.iter().find(|it| it.path == path).map(|it| &it.value);
        assert_eq!(of("prompt.0.when"), Some(&json!("lot_end")));
        assert_eq!(of("prompt.0.picture"), Some(&json!(null)));
        assert_eq!(of("prompt.0.choices.1.name"), Some(&json!("b")));
        assert_eq!(of("prompt.0.choices.2.name"), None);
        let last = &fields.last().unwrap().path;
        assert_eq!(last, "prompt.0.choices.1.stops");
    }
}
