//! Why a person could not be looked up, added or changed.

use std::path::PathBuf;

/// Each variant says what was being done; the cause stays in `source()`.
#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    /// The file is that of another program, or of a later version of this one.
    #[error(
        "{path} is not a list of people that this program knows ({found}); it was left untouched"
    )]
    Foreign {
        /// The file found.
        path: PathBuf,
        /// What it is instead.
        found: String,
    },
    /// Any answer of the database but the wanted one.
    #[error("{doing}")]
    Database {
        /// What was being done.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// A name that is taken.
    #[error("there is a user {name:?} already")]
    Taken {
        /// The name.
        name: String,
    },
    /// A name nobody has.
    #[error("there is no user {name:?}")]
    Unknown {
        /// The name.
        name: String,
    },
    /// A name that a screen could not show or a person not type.
    #[error("user name {found:?}: expected 1 to 40 letters, digits, `.`, `-` or `_`")]
    Name {
        /// The name.
        found: String,
    },
    /// Too short to withstand guessing, or too long to be hashed in good time.
    #[error("a password has {found} characters: expected {least} to {most}")]
    Password {
        /// Characters found.
        found: usize,
        /// Fewest.
        least: usize,
        /// Most.
        most: usize,
    },
    /// The last engineer can neither leave nor become something else: nobody could add another.
    #[error("{name:?} is the only engineer; make another one first")]
    LastEngineer {
        /// The name.
        name: String,
    },
    /// A hash that does not read, or a random source that gives nothing.
    #[error("{doing}: {reason}")]
    Crypto {
        /// What was being done.
        doing: &'static str,
        /// Its own words.
        reason: String,
    },
}

/// Shorthand of this module.
pub(super) type Result<T> = std::result::Result<T, AccessError>;

/// Gives a database answer the sentence of what was being done.
pub(super) trait Doing<T> {
    fn doing(self, doing: &'static str) -> Result<T>;
}

impl<T> Doing<T> for rusqlite::Result<T> {
    fn doing(self, doing: &'static str) -> Result<T> {
        self.map_err(|source| AccessError::Database { doing, source })
    }
}
