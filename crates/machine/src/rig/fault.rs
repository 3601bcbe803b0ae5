//! What is wrong with a setting in the light of the others.

use thiserror::Error;

/// A setting that cannot be accepted; whoever read the file adds its name and line.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{key}: found {found}, expected {expected}")]
pub struct Fault {
    /// Path of the setting: `analog_in.coil_voltage.channel`; list items by number from 0.
    pub key: String,
    /// The value, in words.
    pub found: String,
    /// What would have been accepted.
    pub expected: String,
    /// Path of the setting it clashes with, when there is one.
    pub other: Option<String>,
    /// Of a name that nothing has: those that would have been known.
    pub known: Vec<String>,
}

impl Fault {
    /// A setting that is wrong whatever the others say.
    pub fn new(key: impl Into<String>, found: impl ToString, expected: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            found: found.to_string(),
            expected: expected.into(),
            other: None,
            known: Vec::new(),
        }
    }

    /// A name that nothing has.
    pub fn unknown(key: impl Into<String>, known: Vec<String>) -> Self {
        let expected = format!("one of {}", known.join(", "));
        Self {
            known,
            ..Self::new(key, "an unknown key", expected)
        }
    }

    /// The same, naming the setting it clashes with.
    pub fn against(self, other: impl Into<String>) -> Self {
        Self {
            other: Some(other.into()),
            ..self
        }
    }
}
