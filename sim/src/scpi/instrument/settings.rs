//! Settings that a command sets and a query returns, as a table.

use std::ops::ControlFlow;

use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

/// Kind of a setting, with its value after `*RST`.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// Least, most and reset value.
    Number(f64, f64, f64),
    /// A switch.
    Switch(bool),
    /// Choices, of which the first is the reset value.
    Choice(&'static [&'static str]),
    /// Accepted, and without effect.
    Ignored,
}

/// One setting: its key in the code, pattern of its header, kind, number of copies (channels).
pub(super) struct Setting(pub &'static str, pub &'static str, pub Kind, pub usize);

/// Values of a table of settings.
pub(super) struct Settings {
    table: &'static [Setting],
    values: Vec<Vec<f64>>,
}

/// A setting that a command has changed: its key and channel from 0.
pub(super) type Changed = (&'static str, usize);

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

    /// Executes a unit that names a setting: breaks with the reply to a query or the changed setting, continues when
    /// no setting has this header.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    pub(super) fn execute(
        &mut self,
        unit: &Unit,
    ) -> Result<ControlFlow<Result<String, Changed>>, Failure> {
        for (index, Setting(key, pattern, kind, copies)) in self.table.iter().enumerate() {
            let Some(suffixes) = unit.matches(pattern) else {
                continue;
            };
            let channel = suffixes
                .first()
                .map_or(0, |it| *it as usize)
                .saturating_sub(1);
            if channel >= *copies {
                return Err(Failure::SUFFIX_OUT_OF_RANGE);
            }
            let value = &mut self.values[index][channel];
            if unit.query {
                return shown(unit, *kind, *value).map(|text| ControlFlow::Break(Ok(text)));
            }
            *value = match kind {
                Kind::Number(least, most, reset) => unit.number(0, *least, *most, *reset)?,
                Kind::Switch(_) => f64::from(u8::from(unit.boolean()?)),
                Kind::Choice(choices) => {
                    let chosen = unit.choice(choices)?;
                    choices
                        .iter()
                        .position(|it| *it == chosen)
                        .unwrap_or_default() as f64
                }
                Kind::Ignored => 0.0,
            };
            if unit.parameters.len() > 1 && !matches!(kind, Kind::Ignored) {
                return Err(Failure::PARAMETER_NOT_ALLOWED);
            }
            return Ok(ControlFlow::Break(Err((key, channel))));
        }
        Ok(ControlFlow::Continue(()))
    }
}

/// Returns the short form of a choice: capitals and digits.
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
