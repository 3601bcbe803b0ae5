//! Errors of the file that holds people and sessions.

use history::HistoryError;
use std::path::PathBuf;
use texts::{Lang, Message};

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
    /// The integrity check found damage.
    #[error("the list of people is damaged: {found}")]
    Damaged {
        /// First finding of the check.
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
    #[error("{}", person(.name, "person_taken").say(Lang::En))]
    Taken {
        /// The name as given.
        name: String,
    },
    /// No person has this name.
    #[error("{}", person(.name, "no_such_person").say(Lang::En))]
    Unknown {
        /// The name as given.
        name: String,
    },
    /// The name has a wrong length or characters other than letters, digits, `.`, `-`, `_`.
    #[error("{}", person(.found, "person_name").say(Lang::En))]
    Name {
        /// The name as given.
        found: String,
    },
    /// The password is shorter or longer than allowed.
    #[error("{}", password_length(*.found, *.least, *.most).say(Lang::En))]
    Password {
        /// Length of the password, characters.
        found: usize,
        /// Least length, characters.
        least: usize,
        /// Greatest length, characters.
        most: usize,
    },
    /// The person is the only engineer, and only an engineer changes recipes and people.
    #[error("{}", person(.name, "last_engineer").say(Lang::En))]
    LastEngineer {
        /// The name as given.
        name: String,
    },
    /// The audit of orders does not open, so the program made no change.
    #[error("nothing was changed, because the audit of orders cannot be written: {0}")]
    NoAudit(#[source] HistoryError),
    /// The program made the change, but could not write it into the audit of orders.
    #[error("the change was made, but not noted in the audit of orders: {0}")]
    NotAudited(#[source] HistoryError),
    /// A stored hash is malformed, hashing failed, or the random source of the system failed.
    #[error("{doing}: {reason}")]
    Crypto {
        /// The step that failed.
        doing: &'static str,
        /// Message of the library.
        reason: String,
    },
}

impl AccessError {
    /// Returns the refusal in both languages; a failure of the program itself has the same English description in both.
    #[must_use]
    pub fn message(&self) -> Message {
        match self {
            Self::Taken { name } => person(name, "person_taken"),
            Self::Unknown { name } => person(name, "no_such_person"),
            Self::Name { found } => person(found, "person_name"),
            Self::LastEngineer { name } => person(name, "last_engineer"),
            Self::Password { found, least, most } => password_length(*found, *least, *most),
            Self::Foreign { .. }
            | Self::Damaged { .. }
            | Self::Database { .. }
            | Self::Crypto { .. } => self.said("program_trouble"),
            Self::NoAudit(history) => self.said(history.refusal()),
            Self::NotAudited(_) => self.said("not_audited"),
        }
    }

    fn said(&self, code: &'static str) -> Message {
        Message::new("refusal", code).with("said", self)
    }
}

fn person(name: &str, code: &'static str) -> Message {
    Message::new("refusal", code).with("person", name)
}

fn password_length(found: usize, least: usize, most: usize) -> Message {
    let length = Message::new("refusal", "password_length").with("found", found);
    length.with("least", least).with("most", most)
}

/// Result whose error is an [`AccessError`].
pub(super) type Result<T, E = AccessError> = std::result::Result<T, E>;

/// Turns an error of SQLite into an [`AccessError`] that names the failed step.
pub(super) trait Doing<T> {
    fn doing(self, doing: &'static str) -> Result<T>;
}

impl<T> Doing<T> for rusqlite::Result<T> {
    fn doing(self, doing: &'static str) -> Result<T> {
        self.map_err(|source| AccessError::Database { doing, source })
    }
}
