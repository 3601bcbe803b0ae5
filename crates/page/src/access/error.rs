//! Errors of the file that holds people and sessions.

use std::path::PathBuf;

/// Failure to look up, add, change or remove a person; `source()` gives the cause.
#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    /// The file belongs to another program or to a later version of this one.
    #[error(
        "{path} is not a list of people that this program knows ({found}); it was left untouched"
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Application id and schema number in the header of the file.
        found: String,
    },
    /// SQLite failed.
    #[error("{doing}")]
    Database {
        /// The step that failed.
        doing: &'static str,
        /// Error of SQLite.
        source: rusqlite::Error,
    },
    /// A person with this name exists.
    #[error("there is a user {name:?} already")]
    Taken {
        /// The name as given.
        name: String,
    },
    /// No person has this name.
    #[error("there is no user {name:?}")]
    Unknown {
        /// The name as given.
        name: String,
    },
    /// The name has a wrong length or characters other than letters, digits, `.`, `-`, `_`.
    #[error("user name {found:?}: expected 1 to 40 letters, digits, `.`, `-` or `_`")]
    Name {
        /// The name as given.
        found: String,
    },
    /// The password is shorter or longer than allowed.
    #[error("a password has {found} characters: expected {least} to {most}")]
    Password {
        /// Length of the password, characters.
        found: usize,
        /// Least length, characters.
        least: usize,
        /// Greatest length, characters.
        most: usize,
    },
    /// The person is the only engineer, and only an engineer changes recipes and people.
    #[error("{name:?} is the only engineer; make another one first")]
    LastEngineer {
        /// The name as given.
        name: String,
    },
    /// A stored hash is malformed, hashing failed, or the random source of the system failed.
    #[error("{doing}: {reason}")]
    Crypto {
        /// The step that failed.
        doing: &'static str,
        /// Message of the library.
        reason: String,
    },
}

/// Result whose error is an [`AccessError`].
pub(super) type Result<T> = std::result::Result<T, AccessError>;

/// Turns an error of SQLite into an [`AccessError`] that names the failed step.
pub(super) trait Doing<T> {
    fn doing(self, doing: &'static str) -> Result<T>;
}

impl<T> Doing<T> for rusqlite::Result<T> {
    fn doing(self, doing: &'static str) -> Result<T> {
        self.map_err(|source| AccessError::Database { doing, source })
    }
}
