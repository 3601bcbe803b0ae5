//! Roles of people; a stronger role may do everything that a weaker one may.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;
use utoipa::ToSchema;

/// The three roles, weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Runs lots, gives every PackML command, acknowledges alarms.
    Operator,
    /// Also jogs and steps actuators, changes the mode, shelves alarms, releases held lots, resets wear counters, and
    /// carries out plans for tooling.
    Maintainer,
    /// Also changes and approves recipes, changes people, and reopens complete lots.
    Engineer,
}

impl Role {
    /// All roles, weakest first.
    pub const ALL: [Self; 3] = [Self::Operator, Self::Maintainer, Self::Engineer];

    /// Returns the name of the role in the file of people, on the command line and over HTTP.
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

/// Error: the word names no role.
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
