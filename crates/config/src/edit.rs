//! Changes values of a TOML text in place; comments and order stay.

use super::check::File;
use super::error::ConfigError;
use super::nearest::{nearest, suggestion};
use super::sheet::{Entry, Field, fields};
use machine::rig::fault::Fault;
use serde_json::Value as NewValue;
use std::collections::BTreeMap;
use toml_edit::{Array, DocumentMut, Item, Value};

/// Returns the text of a recipe with new `values`, given by path; null removes a key. The caller checks the new text.
///
/// # Errors
/// Fails when the kind is unknown, when the kind has no such path, or when TOML cannot express the value.
pub(super) fn edited(
    file: &File,
    values: &BTreeMap<String, NewValue>,
) -> Result<String, ConfigError> {
    let fields = fields(file)?;
    let parsed = file.text.parse::<DocumentMut>();
    let mut document = parsed.map_err(|error| ConfigError::Rule {
        file: file.path.clone(),
        line: 1,
        problem: error.message().to_owned(),
    })?;
    for (path, wanted) in values {
        let field = known(file, &fields, path)?;
        if equal_values(&field.value, wanted) {
            continue;
        }
        match as_toml(wanted, &field.entry) {
            Some(value) => set(document.as_item_mut(), path, value),
            None if wanted.is_null() => remove_key(document.as_item_mut(), &field.removed),
            None => {
                let fault = Fault::new(
                    path,
                    wanted,
                    "a text, a number, yes or no, or a list of numbers",
                );
                return Err(file.locate(&fault));
            }
        }
    }
    Ok(document.to_string())
}

fn known<'a>(file: &File, fields: &'a [Field], path: &str) -> Result<&'a Field, ConfigError> {
    let found = fields.iter().find(|it| it.path == path);
    found.ok_or_else(|| {
        let paths: Vec<&str> = fields.iter().map(|it| it.path.as_str()).collect();
        let expected = nearest(path, &paths).map_or("a key of a recipe".to_owned(), suggestion);
        let path: String = path.chars().take(100).collect();
        file.locate(&Fault::new(path, "an unknown key", expected))
    })
}

/// Returns true when both values are equal; 9 equals 9.0.
fn equal_values(old: &NewValue, wanted: &NewValue) -> bool {
    match (old, wanted) {
        (NewValue::Number(old), NewValue::Number(wanted)) => old.as_f64() == wanted.as_f64(),
        (NewValue::Array(old), NewValue::Array(wanted)) => {
            let pairs = || old.iter().zip(wanted);
            old.len() == wanted.len() && pairs().all(|(old, wanted)| equal_values(old, wanted))
        }
        (old, wanted) => old == wanted,
    }
}

/// Converts a value to TOML; numbers become floats unless the key takes whole numbers. Returns `None` for null and
/// objects.
fn as_toml(wanted: &NewValue, entry: &Entry) -> Option<Value> {
    match wanted {
        NewValue::String(text) => Some(text.as_str().into()),
        NewValue::Bool(flag) => Some((*flag).into()),
        NewValue::Number(number) => match (entry, number.as_i64()) {
            (Entry::Number(_) | Entry::Numbers { .. }, _) | (_, None) => {
                Some(number.as_f64()?.into())
            }
            (Entry::Text | Entry::Choice { .. } | Entry::Whole(_) | Entry::Flag, Some(whole)) => {
                Some(whole.into())
            }
        },
        NewValue::Array(items) => {
            let items = items.iter().map(|item| as_toml(item, entry));
            Some(Value::Array(items.collect::<Option<Array>>()?))
        }
        NewValue::Null | NewValue::Object(_) => None,
    }
}

/// Sets a value; keeps the comment that follows the old value.
fn set(root: &mut Item, path: &str, mut value: Value) {
    let (tables, key) = split_path(path);
    let table = tables.fold(root, |item, key| match key.parse::<usize>() {
        Ok(place) => &mut item[place],
        Err(_) => &mut item[key],
    });
    let slot = &mut table[key];
    let old = slot.as_value().map(|old| old.decor().clone());
    match old {
        Some(decor) => {
            *value.decor_mut() = decor;
            *slot = Item::Value(value);
        }
        None => {
            *slot = Item::Value(value);
            restore_spacing(table);
        }
    }
}

fn remove_key(root: &mut Item, path: &str) {
    let (mut tables, key) = split_path(path);
    let inner = |item, key: &str| match key.parse::<usize>() {
        Ok(place) => Item::get_mut(item, place),
        Err(_) => Item::get_mut(item, key),
    };
    let Some(table) = tables.try_fold(root, inner) else {
        return;
    };
    if let Some(keys) = table.as_table_like_mut() {
        keys.remove(key);
        restore_spacing(table);
    }
}

/// Splits a path into the names and list indexes that lead to the innermost table, and the key in that table.
fn split_path(path: &str) -> (impl Iterator<Item = &str>, &str) {
    let (tables, key) = path.rsplit_once('.').unwrap_or(("", path));
    (tables.split('.').filter(|it| !it.is_empty()), key)
}

/// Formats an inline table again after a key was added or removed.
fn restore_spacing(table: &mut Item) {
    if let Some(inline) = table.as_inline_table_mut() {
        inline.fmt();
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use serde_json::json;

    const TEXT: &str = include_str!("../../../config/recipes/jzc-22f-012.toml");

    fn changed(values: NewValue) -> Result<String, ConfigError> {
        let file = File::parse("r.toml".into(), TEXT.to_owned()).unwrap();
        edited(&file, &serde_json::from_value(values).unwrap())
    }

    /// Returns the lines that the change adds to the text.
    fn new_lines(values: NewValue) -> Vec<String> {
        let text = changed(values).unwrap();
        let new = text
            .lines()
            .filter(|line| !TEXT.lines().any(|old| old == *line));
        new.map(str::to_owned).collect()
    }

    #[test]
    fn one_line_changes_and_its_remark_stays() {
        let value = json!({"decision.slow_repeats": 5});
        assert_eq!(
            new_lines(value),
            [
                "slow_repeats = 5               # confirmation measurements of a result inside the guard band"
            ]
        );
        let value = json!({"limits.operate_voltage_v.high": 9});
        assert_eq!(changed(value).unwrap(), TEXT, "9 is 9.0");
        let value = json!({"limits.operate_voltage_v.high": 8, "part.body_mm": [22.5, 16.5, 17]});
        assert_eq!(
            new_lines(value),
            [
                "body_mm = [22.5, 16.5, 17.0]   # along x, y, z as it lies in the nest",
                "operate_voltage_v = { high = 8.0 }"
            ]
        );
    }

    #[test]
    fn a_key_comes_and_goes() {
        let value = json!({"limits.operate_voltage_v.low": 4.5, "limits.coil_resistance_ohm.high": null,
            "test.strategy.coil.scans": 2});
        assert_eq!(
            new_lines(value),
            [
                "coil_resistance_ohm = { low = 360.0 }",
                "operate_voltage_v = { high = 9.0, low = 4.5 }",
                "coil = { scans = 2 }"
            ]
        );
    }

    #[test]
    fn a_prompt_changes_in_its_place() {
        let prompts = "[[prompt]]\nname = \"nest\" # as in orders\ntext_en = \"Change\"\npicture = \"a.png\"\nchoices = [\n  \
                       { name = \"yes\", text_en = \"Yes\" },\n  { name = \"no\", stops = true },\n]\n";
        let file = File::parse("r.toml".into(), format!("{TEXT}{prompts}")).unwrap();
        let values = json!({"prompt.0.name": "fixture", "prompt.0.picture": null,
            "prompt.0.choices.0.text_en": "Changed", "prompt.0.choices.1.stops": null});
        let text = edited(&file, &serde_json::from_value(values).unwrap()).unwrap();
        let expected = "[[prompt]]\nname = \"fixture\" # as in orders\ntext_en = \"Change\"\nchoices = [\n  \
                        { name = \"yes\", text_en = \"Changed\" },\n  { name = \"no\" },\n]\n";
        assert_eq!(text.strip_prefix(TEXT), Some(expected));
    }

    #[test]
    fn an_unknown_path_is_refused_by_name() {
        for (path, expected) in [
            (
                "limits.operate_voltage_v.hihg",
                "\"limits.operate_voltage_v.high\"?",
            ),
            ("name.x", "\"name\"?"),
            ("", "a key of a recipe"),
            ("limits", "a key of a recipe"),
            ("..", "a key of a recipe"),
        ] {
            let refused = changed(json!({path: 1})).unwrap_err().to_string();
            assert!(
                refused.contains("an unknown key") && refused.ends_with(expected),
                "{refused}"
            );
        }
        let refused = changed(json!({"title_en": {"a": 1}})).unwrap_err();
        assert_eq!(refused.key().unwrap(), "title_en");
    }
}
