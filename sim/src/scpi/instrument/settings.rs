//! A table of settings with their SCPI headers: commands set them, queries return them.

use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

/// Kind of a setting, with its value after `*RST`.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// A number: minimum, maximum and reset value.
    Number(f64, f64, f64),
    /// A switch.
    Switch(bool),
    /// A choice of words; the first is the reset value.
    Choice(&'static [&'static str]),
    /// A command that the instrument accepts and ignores.
    Ignored,
}

/// One setting: its key in the code, pattern of its header, kind, number of copies (channels).
pub(super) struct Setting(pub &'static str, pub &'static str, pub Kind, pub usize);

/// Values of a table of settings.
pub(super) struct Settings {
    table: &'static [Setting],
    values: Vec<Vec<f64>>,
}

/// A setting after its change by a command.
#[derive(Debug, Clone, Copy)]
pub struct Changed {
    pub(super) key: &'static str,
    /// Channel from 0.
    pub(super) channel: usize,
    /// Value before the change; for a choice, its index.
    pub(super) before: f64,
}

/// Result of a message unit whose header names a setting.
pub(super) enum Handled {
    /// Reply to a query.
    Query(String),
    Change(Changed),
}

impl Settings {
    pub(super) fn new(table: &'static [Setting]) -> Self {
        let mut settings = Self {
            table,
            values: Vec::new(),
        };
        settings.reset();
        settings
    }

    pub(super) fn reset(&mut self) {
        let value = |Setting(.., kind, copies): &Setting| match kind {
            Kind::Number(.., reset) => vec![*reset; *copies],
            Kind::Switch(on) => vec![f64::from(u8::from(*on)); *copies],
            Kind::Choice(_) | Kind::Ignored => vec![0.0; *copies],
        };
        self.values = self.table.iter().map(value).collect();
    }

    fn index(&self, key: &str) -> usize {
        let place = self
            .table
            .iter()
            .position(|Setting(known, ..)| *known == key);
        place.unwrap_or_else(|| unreachable!("setting `{key}` is not in the table"))
    }

    pub(super) fn of(&self, key: &str, channel: usize) -> f64 {
        self.values[self.index(key)][channel]
    }

    pub(super) fn number(&self, key: &str) -> f64 {
        self.of(key, 0)
    }

    pub(super) fn on(&self, key: &str) -> bool {
        self.of(key, 0) != 0.0
    }

    pub(super) fn choice(&self, key: &str) -> &'static str {
        let index = self.index(key);
        match self.table[index].2 {
            Kind::Choice(choices) => choices[self.values[index][0] as usize],
            Kind::Number(..) | Kind::Switch(_) | Kind::Ignored => "",
        }
    }

    pub(super) fn set(&mut self, key: &str, value: f64) {
        let index = self.index(key);
        self.values[index][0] = value;
    }

    pub(super) fn set_of(&mut self, key: &str, channel: usize, value: f64) {
        let index = self.index(key);
        self.values[index][channel] = value;
    }

    /// Executes a message unit; `None` when its header names no setting.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    pub(super) fn execute(&mut self, unit: &Unit) -> Result<Option<Handled>, Failure> {
        let each = self.table.iter().zip(&mut self.values);
        let mut named = each.filter_map(|(setting, values)| {
            let suffixes = unit.matches(setting.1)?;
            Some((setting, values, suffixes.first().copied().unwrap_or(1)))
        });
        let Some((Setting(key, _, kind, _), values, suffix)) = named.next() else {
            return Ok(None);
        };
        let channel = (suffix as usize).saturating_sub(1);
        let value = values
            .get_mut(channel)
            .ok_or(Failure::SUFFIX_OUT_OF_RANGE)?;
        if unit.query {
            return shown(unit, *kind, *value).map(|text| Some(Handled::Query(text)));
        }
        if unit.parameters.len() > 1 && !matches!(kind, Kind::Ignored) {
            return Err(Failure::PARAMETER_NOT_ALLOWED);
        }
        let before = std::mem::replace(value, taken(unit, *kind)?);
        Ok(Some(Handled::Change(Changed {
            key,
            channel,
            before,
        })))
    }
}

fn taken(unit: &Unit, kind: Kind) -> Result<f64, Failure> {
    match kind {
        Kind::Number(least, most, reset) => unit.number(0, least, most, reset),
        Kind::Switch(_) => Ok(f64::from(u8::from(unit.boolean()?))),
        Kind::Choice(choices) => Ok(unit.choice(choices)? as f64),
        Kind::Ignored => Ok(0.0),
    }
}

/// Returns the short form of a choice: its capital letters and digits.
fn short(choice: &str) -> String {
    choice.chars().filter(|c| !c.is_ascii_lowercase()).collect()
}

fn shown(unit: &Unit, kind: Kind, value: f64) -> Result<String, Failure> {
    Ok(match kind {
        Kind::Number(least, most, reset) if !unit.parameters.is_empty() => {
            nr3(unit.number(0, least, most, reset)?)
        }
        Kind::Number(..) => nr3(value),
        Kind::Switch(_) => u8::from(value != 0.0).to_string(),
        Kind::Choice(choices) => short(choices[value as usize]),
        Kind::Ignored => "0".into(),
    })
}
