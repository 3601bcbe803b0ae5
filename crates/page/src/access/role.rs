//! What a person is trusted with. A role may do all that the ones before it may.

use serde::Serialize;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// The three roles, weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Runs lots: every command of the state model, acknowledging alarms.
    Operator,
    /// Also moves single actuators, changes the mode, shelves alarms.
    Maintainer,
    /// Also changes recipes and people.
    Engineer,
}

impl Role {
    /// All of them, weakest first.
    pub const ALL: [Self; 3] = [Self::Operator, Self::Maintainer, Self::Engineer];

    /// The word in the file, on the command line and over HTTP.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Operator => "operator",
            Self::Maintainer => "maintainer",
            Self::Engineer => "engineer",
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(self.word())
    }
}

/// A word that is no role.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0:?}: expected operator, maintainer or engineer")]
pub struct NoRole(String);

impl FromStr for Role {
    type Err = NoRole;

    fn from_str(text: &str) -> Result<Self, NoRole> {
        let found = Self::ALL.into_iter().find(|role| role.word() == text);
        found.ok_or_else(|| NoRole(text.to_owned()))
    }
}
