//! Reads the keys of a module whose values are more than one plain number: values per channel, bit masks, codes.

use std::ops::RangeInclusive;

use super::base::BAUDS;
use crate::config::ConfigError;
use crate::dcon;
use crate::table::{Entry, Table};

/// Reads a number within `range`.
pub fn number(
    keys: &Table,
    key: &'static str,
    range: RangeInclusive<f64>,
) -> Result<Option<f64>, ConfigError> {
    let form = format!("a number from {} to {}", range.start(), range.end());
    keys.fit(key, &form, |entry| {
        entry.number().filter(|it| range.contains(it))
    })
}

/// Reads key `baud`, one of the rates that modules support.
pub fn baud(keys: &Table) -> Result<Option<u32>, ConfigError> {
    let all = BAUDS.map(|baud| baud.to_string());
    keys.fit("baud", &format!("one of {}", all.join(", ")), |entry| {
        entry.whole().filter(|baud| BAUDS.contains(baud))
    })
}

/// Reads a list of at most `most` values, one per channel; a single value applies to channel 0, true and false count as
/// 1 and 0. `form` describes the permitted values in messages.
pub fn values(
    keys: &Table,
    key: &'static str,
    most: usize,
    form: &str,
    fits: impl Fn(f64) -> bool,
) -> Result<Vec<f64>, ConfigError> {
    let fitting = |item: &Entry| level_or_number(item).filter(|value| fits(*value));
    let values = keys.fit(key, &format!("at most {most} {form}"), |entry| {
        let items = entry.list().unwrap_or(std::slice::from_ref(entry));
        let values: Option<Vec<f64>> = items.iter().map(fitting).collect();
        values.filter(|values| values.len() <= most)
    })?;
    Ok(values.unwrap_or_default())
}

/// Reads a list of at most `most` whole numbers within `range`, one per channel.
pub fn counts(
    keys: &Table,
    key: &'static str,
    most: usize,
    range: RangeInclusive<u32>,
) -> Result<Vec<u32>, ConfigError> {
    let form = format!("whole numbers from {} to {}", range.start(), range.end());
    let ends = f64::from(*range.start())..=f64::from(*range.end());
    let whole = |value: f64| value.fract() == 0.0 && ends.contains(&value);
    let values = values(keys, key, most, &form, whole)?;
    Ok(values.into_iter().map(|value| value as u32).collect())
}

/// Reads a mask without bits outside `all`: hexadecimal text, an integer, or a list of 0 and 1 from channel 0 upwards.
pub fn bits(keys: &Table, key: &'static str, all: u16) -> Result<Option<u16>, ConfigError> {
    let form = format!("hexadecimal text, an integer or a list of 0 and 1 within \"{all:X}\"");
    keys.fit(key, &form, |entry| {
        let mask = match (entry.list(), entry.text()) {
            (Some(items), _) => mask_of(items)?,
            (None, Some(digits)) => dcon::hex(digits.as_bytes())?,
            (None, None) => entry.whole()?,
        };
        u16::try_from(mask).ok().filter(|mask| mask & !all == 0)
    })
}

/// Reads a code up to `most`, written as hexadecimal text.
pub fn code(keys: &Table, key: &'static str, most: u8) -> Result<Option<u8>, ConfigError> {
    let form = format!("hexadecimal text up to \"{most:X}\"");
    keys.fit(key, &form, |entry| {
        let code = dcon::hex(entry.text()?.as_bytes())?;
        u8::try_from(code).ok().filter(|code| *code <= most)
    })
}

/// Reads one of `words`; returns its index.
pub fn word(keys: &Table, key: &'static str, words: &[&str]) -> Result<Option<u8>, ConfigError> {
    keys.fit(key, &format!("one of {}", words.join(", ")), |entry| {
        let index = words.iter().position(|word| Some(*word) == entry.text());
        u8::try_from(index?).ok()
    })
}

/// Returns the one of two synonymous keys that the file has, `one` when it has neither; fails when it has both.
pub fn either(
    keys: &Table,
    one: &'static str,
    other: &'static str,
) -> Result<&'static str, ConfigError> {
    match (keys.find(one), keys.find(other)) {
        (Some(_), Some(entry)) => {
            Err(entry.wrong(&format!("nothing beside `{one}`, which means the same")))
        }
        (None, Some(_)) => Ok(other),
        (_, None) => Ok(one),
    }
}

fn level_or_number(entry: &Entry) -> Option<f64> {
    let level = || entry.flag().map(|level| f64::from(u8::from(level)));
    entry.number().or_else(level)
}

fn mask_of(items: &[Entry]) -> Option<u32> {
    (0..)
        .zip(items)
        .try_fold(0, |mask, (bit, item)| match level_or_number(item)? {
            0.0 => Some(mask),
            1.0 => Some(mask | 1u32.checked_shl(bit)?),
            _ => None,
        })
}
