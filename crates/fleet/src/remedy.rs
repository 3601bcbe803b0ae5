//! What a person does about a database that did not answer.

use crate::error::FleetError;
use std::error::Error;
use tokio_postgres::error::SqlState;

/// What a person does about an error, by the cause of the error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Remedy {
    /// The connection could not be made or broke.
    Network,
    /// The two sides did not agree on password or encryption.
    Password,
    /// The server does not let this user in.
    Access,
    /// The server has no database of this name.
    Database,
    /// The user lacks a right in the database.
    Role,
    /// The server is full.
    Room,
    /// The server has too many connections.
    Connections,
    /// The server ended the statement because it took too long.
    Slow,
    /// Any other error of the server.
    Log,
    /// The schema is missing, foreign or too old.
    Schema,
    /// A setting of this program is wrong.
    Settings,
}

impl Remedy {
    /// All remedies.
    pub const ALL: [Self; 11] = [
        Self::Network,
        Self::Password,
        Self::Access,
        Self::Database,
        Self::Role,
        Self::Room,
        Self::Connections,
        Self::Slow,
        Self::Log,
        Self::Schema,
        Self::Settings,
    ];

    /// Returns the remedy for an error of the client library.
    pub(crate) fn of(error: &tokio_postgres::Error) -> Self {
        let Some(code) = error.code() else {
            return match is_broken(error) {
                true => Self::Network,
                false => Self::Password,
            };
        };
        if code.code().starts_with("28") {
            Self::Access
        } else if *code == SqlState::INVALID_CATALOG_NAME {
            Self::Database
        } else if *code == SqlState::INSUFFICIENT_PRIVILEGE {
            Self::Role
        } else if *code == SqlState::DISK_FULL {
            Self::Room
        } else if *code == SqlState::TOO_MANY_CONNECTIONS {
            Self::Connections
        } else if *code == SqlState::QUERY_CANCELED {
            Self::Slow
        } else {
            Self::Log
        }
    }

    /// Returns the name, in family `rigs_remedy` of the texts.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Network => "network",
            Self::Password => "password",
            Self::Access => "access",
            Self::Database => "database",
            Self::Role => "role",
            Self::Room => "room",
            Self::Connections => "connections",
            Self::Slow => "slow",
            Self::Log => "log",
            Self::Schema => "schema",
            Self::Settings => "settings",
        }
    }

    /// Returns the sentence for messages.
    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::Network => "Check address, network and server",
            Self::Password => {
                "Check the password (PGPASSWORD, or the file of PGPASSFILE) and `tls` and `ca` of fleet.toml"
            }
            Self::Access => {
                "Check user and password (PGPASSWORD, or the file of PGPASSFILE) and pg_hba.conf of the server"
            }
            Self::Database => "Create the database, or correct its name",
            Self::Role => {
                "Grant the role relayrig_writer (for questions relayrig_reader) to this user; `fleet init` needs the owner"
            }
            Self::Room => "The server is full: make room there",
            Self::Connections => "Raise max_connections of the server",
            Self::Slow => "Choose a shorter time span or fewer rigs, or see the load of the server",
            Self::Log => "Try again, and see the log of the server",
            Self::Schema => "Run `relayrig fleet init` as the owner of the database",
            Self::Settings => "Correct fleet.toml",
        }
    }
}

impl FleetError {
    /// Returns what a person does about this error.
    #[must_use]
    pub const fn remedy(&self) -> Remedy {
        match self {
            Self::Database { remedy, .. } => *remedy,
            Self::TimeOut { .. } => Remedy::Network,
            Self::NoSchema { .. } | Self::Foreign { .. } | Self::SchemaOlder { .. } => {
                Remedy::Schema
            }
            Self::Url { .. }
            | Self::PasswordFile { .. }
            | Self::Ca { .. }
            | Self::NoTls { .. }
            | Self::NoRig { .. }
            | Self::Shifts { .. } => Remedy::Settings,
            Self::RealRigs { .. }
            | Self::Runtime { .. }
            | Self::Fault { .. }
            | Self::Refused { .. }
            | Self::History(_) => Remedy::Log,
        }
    }
}

/// Returns true when the connection could not be made or broke; false when the sides did not agree on password or
/// encryption.
fn is_broken(error: &tokio_postgres::Error) -> bool {
    let mut cause: Option<&dyn Error> = Some(error);
    while let Some(it) = cause {
        if it.is::<std::io::Error>() {
            return true;
        }
        cause = it.source();
    }
    error.is_closed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_remedy_has_a_text_in_both_languages() {
        for remedy in Remedy::ALL {
            let id = format!("rigs_remedy-{}", remedy.code());
            assert!(texts::plain().any(|it| it.id == id), "{id}");
        }
    }
}
