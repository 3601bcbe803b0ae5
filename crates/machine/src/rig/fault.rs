//! A setting that contradicts the other settings or the machine.

use serde::Serialize;
use thiserror::Error;

/// Requirement on a value, in a form that every language can put into words; `expected` says the same in English.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "code", content = "value", rename_all = "snake_case")]
pub enum Requirement {
    /// Type and range of the key.
    Form,
    /// At most the upper limit of the same characteristic, which has this value.
    AtMostHigh(String),
    /// Below this value with its unit.
    Below(String),
    /// A requirement that only `expected` states.
    Other,
}

/// A rejected setting; the reader of the file adds file name and line.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{key}: found {found}, expected {expected}")]
pub struct Fault {
    /// Path of the setting, for example `analog_in.coil_voltage.channel`; items of a list have numbers from 0.
    pub key: String,
    /// The value, in words.
    pub found: String,
    /// Values that would be accepted.
    pub expected: String,
    /// The requirement behind `expected`.
    pub requirement: Box<Requirement>,
    /// Path of the conflicting setting, if any.
    pub other: Option<String>,
    /// The known names, when the name is unknown; else empty.
    pub known: Box<[String]>,
}

impl Fault {
    /// Makes the fault of a setting that is wrong by itself.
    pub fn new(key: impl Into<String>, found: impl ToString, expected: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            found: found.to_string(),
            expected: expected.into(),
            requirement: Box::new(Requirement::Other),
            other: None,
            known: Box::default(),
        }
    }

    /// Makes the fault of an unknown name.
    pub fn unknown(key: impl Into<String>, known: Vec<String>) -> Self {
        let expected = format!("one of {}", known.join(", "));
        Self {
            known: known.into(),
            ..Self::new(key, "an unknown key", expected)
        }
    }

    /// Adds the requirement behind `expected`.
    pub fn requires(self, requirement: Requirement) -> Self {
        Self {
            requirement: Box::new(requirement),
            ..self
        }
    }

    /// Adds the path of the conflicting setting.
    pub fn against(self, other: impl Into<String>) -> Self {
        Self {
            other: Some(other.into()),
            ..self
        }
    }
}
