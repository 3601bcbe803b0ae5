//! Reads the keys of one module's table: an absent key is `None`, an unfit value is an error.

use toml::Value;

use crate::dcon;
use crate::error::SimError;
use crate::terminal::ModuleSpec;

/// Reads a text.
pub fn text<'a>(spec: &'a ModuleSpec, key: &str) -> Result<Option<&'a str>, SimError> {
    read(spec, key, "text", Value::as_str)
}

/// Reads true or false.
pub fn flag(spec: &ModuleSpec, key: &str) -> Result<Option<bool>, SimError> {
    read(spec, key, "true or false", Value::as_bool)
}

/// Reads an integer or a floating-point number.
pub fn number(spec: &ModuleSpec, key: &str) -> Result<Option<f64>, SimError> {
    read(spec, key, "a number", as_number)
}

/// Reads a number per channel; a single number applies to channel 0, true and false count as 1 and 0.
pub fn numbers(spec: &ModuleSpec, key: &str) -> Result<Vec<f64>, SimError> {
    let list = read(spec, key, "a list of numbers", |value| match value {
        Value::Array(items) => items.iter().map(as_number).collect(),
        single => as_number(single).map(|number| vec![number]),
    })?;
    Ok(list.unwrap_or_default())
}

/// Reads a bit mask: hexadecimal text, an integer, or a list of 0 and 1 from channel 0 upwards.
pub fn bits(spec: &ModuleSpec, key: &str) -> Result<Option<u32>, SimError> {
    read(
        spec,
        key,
        "hexadecimal text, an integer or a list of 0 and 1",
        |value| match value {
            Value::String(digits) => dcon::hex(digits.as_bytes()),
            Value::Integer(mask) => u32::try_from(*mask).ok(),
            Value::Array(items) => mask_of(items),
            _ => None,
        },
    )
}

/// Reads a type code or slew code: hexadecimal text.
pub fn code(spec: &ModuleSpec, key: &str) -> Result<Option<u8>, SimError> {
    read(spec, key, "hexadecimal text up to FF", |value| {
        let code = dcon::hex(value.as_str()?.as_bytes())?;
        u8::try_from(code).ok()
    })
}

/// Builds the error for a value of the right type but the wrong range.
pub fn wrong(spec: &ModuleSpec, key: &str, expected: &'static str) -> SimError {
    SimError::Setting {
        module: spec.id.clone(),
        key: key.into(),
        found: spec
            .settings
            .get(key)
            .map_or_else(|| "nothing".into(), ToString::to_string),
        expected,
    }
}

fn read<'a, T>(
    spec: &'a ModuleSpec,
    key: &str,
    expected: &'static str,
    convert: impl Fn(&'a Value) -> Option<T>,
) -> Result<Option<T>, SimError> {
    let Some(value) = spec.settings.get(key) else {
        return Ok(None);
    };
    convert(value)
        .map(Some)
        .ok_or_else(|| wrong(spec, key, expected))
}

fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(whole) => Some(*whole as f64),
        Value::Float(number) => Some(*number),
        Value::Boolean(level) => Some(f64::from(u8::from(*level))),
        Value::String(_) | Value::Datetime(_) | Value::Array(_) | Value::Table(_) => None,
    }
}

fn mask_of(items: &[Value]) -> Option<u32> {
    items
        .iter()
        .take(32)
        .enumerate()
        .try_fold(0u32, |mask, (bit, item)| {
            Some(mask | u32::from(as_number(item)? != 0.0) << bit)
        })
}
