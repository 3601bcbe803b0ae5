//! Why a database did not take the rows: each text names the database and what to do.

use crate::remedy::Remedy;
use history::HistoryError;
use std::path::PathBuf;

/// Result of this crate.
pub type Result<T> = std::result::Result<T, FleetError>;

/// Why the database refuses this file, though the database can be reached. Nothing was written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// Another file sends under this name.
    #[error(
        "rig {rig} is in use: the file that began on {host} at {since} sends under this name (epoch {epoch}). Give this rig \
         another name in fleet.toml, or, if it replaces the other, run `relayrig fleet push --take-over`"
    )]
    OtherFile {
        /// Plant and name of the rig.
        rig: String,
        /// Computer of the other file.
        host: String,
        /// Time at which the other file began.
        since: String,
        /// Epoch of the other file.
        epoch: i32,
    },
    /// A later file has taken over.
    #[error(
        "rig {rig}: a later file has taken over (epoch {epoch}, from {host}, since {since}). Stop this program, or, if \
         this is the right file, run `relayrig fleet push --take-over`"
    )]
    Superseded {
        /// Plant and name of the rig.
        rig: String,
        /// Computer of the later file.
        host: String,
        /// Time at which the later file took over.
        since: String,
        /// Epoch of the later file.
        epoch: i32,
    },
    /// The database has more of this file than the file itself.
    #[error(
        "rig {rig}: the database has {there} batches of this file, the file knows of {here}; the last run there is {run} \
         with {parts} parts. The file is an older backup or a copy of one that sends. Use the file that sent last, or \
         continue with this one as a new epoch: `relayrig fleet push --take-over`"
    )]
    FileOlder {
        /// Plant and name of the rig.
        rig: String,
        /// Batches that the database has.
        there: i64,
        /// Batches that the file has confirmed.
        here: i64,
        /// UUID of the last run that the database has.
        run: String,
        /// Number of parts that the database has of this run.
        parts: i64,
    },
    /// The database has fewer batches than it has confirmed.
    #[error(
        "rig {rig}: the database has {there} batches of this file, but had confirmed {here}: it is an older backup or \
         another database. Run `relayrig fleet push --again`, which sends what it lacks"
    )]
    DatabaseOlder {
        /// Plant and name of the rig.
        rig: String,
        /// Batches that the database has.
        there: i64,
        /// Batches that the file has confirmed.
        here: i64,
    },
    /// A run of the file has the number of another run.
    #[error(
        "rig {rig}: {count} runs of this file have numbers under which the database has other runs. The file was changed by \
         hand or merged; continue as a new epoch: `relayrig fleet push --take-over`"
    )]
    RunDiffers {
        /// Plant and name of the rig.
        rig: String,
        /// Number of such runs.
        count: i64,
    },
}

/// Reason why rows were not sent or a database not read.
#[derive(Debug, thiserror::Error)]
pub enum FleetError {
    /// The URL cannot be read.
    #[error(
        "{target}: found a URL that cannot be read ({why}), expected postgres://USER@HOST:PORT/DATABASE"
    )]
    Url {
        /// URL of the database, without password.
        target: String,
        /// What is wrong.
        why: String,
    },
    /// The password file cannot be used.
    #[error(
        "{path}: found {found}, expected a password file that only its owner can read (chmod 600)"
    )]
    PasswordFile {
        /// The file.
        path: PathBuf,
        /// What was found.
        found: String,
    },
    /// The certificate file cannot be used.
    #[error("{path}: found {found}, expected certificates in PEM form (`ca` of fleet.toml)")]
    Ca {
        /// The file.
        path: PathBuf,
        /// What was found.
        found: String,
    },
    /// The program has no TLS.
    #[error(
        "{target}: found tls = \"verify\", but this program was built without TLS; build it with `--features tls`, or set \
         tls = \"off\" in a network of your own"
    )]
    NoTls {
        /// URL of the database, without password.
        target: String,
    },
    /// The database did not answer within the time limit.
    #[error(
        "{target}: no answer in {seconds} s while {doing}. {}{}", Remedy::Network.text(), queue(*.queued)
    )]
    TimeOut {
        /// URL of the database, without password.
        target: String,
        /// What the program was doing.
        doing: &'static str,
        /// How long the program waited, seconds.
        seconds: u64,
        /// True while sending: what was not sent stays in the queue.
        queued: bool,
    },
    /// The database refused a statement, or the connection broke.
    #[error("{target}: {said} (while {doing}). {}{}", .remedy.text(), queue(*.queued))]
    Database {
        /// URL of the database, without password.
        target: String,
        /// What the program was doing.
        doing: &'static str,
        /// Message of the database.
        said: String,
        /// What a person does about this error.
        remedy: Remedy,
        /// True while sending: what was not sent stays in the queue.
        queued: bool,
        /// Error of the client library, of which `said` is the text.
        error: tokio_postgres::Error,
    },
    /// The database for made-up histories has real ones.
    #[error(
        "{target}: found rigs of the plant {site}, expected a database without real rigs for made-up ones"
    )]
    RealRigs {
        /// URL of the database, without password.
        target: String,
        /// A plant with real rigs in the database.
        site: String,
    },
    /// The runtime of the connection could not be started.
    #[error("no runtime for the connection: {error}")]
    Runtime {
        /// Error of the system.
        error: std::io::Error,
    },
    /// No rig has this name.
    #[error("{target}: found no rig {found}, expected one of {expected}")]
    NoRig {
        /// URL of the database, without password.
        target: String,
        /// Plant and rig asked for; `*` for any.
        found: String,
        /// First twenty rigs of the database, each with its plant.
        expected: String,
    },
    /// A fault of this program ended an attempt to send.
    #[error(
        "{target}: a fault of this program ended the sending ({said}). It tries again; the rows stay in the queue. Please \
         report the log"
    )]
    Fault {
        /// URL of the database, without password.
        target: String,
        /// Message of the program.
        said: String,
    },
    /// There is no schema of this program.
    #[error(
        "{target}: found no schema relayrig, expected one; run `relayrig fleet init` as its owner"
    )]
    NoSchema {
        /// URL of the database, without password.
        target: String,
    },
    /// A schema of this name belongs to another program.
    #[error(
        "{target}: the schema relayrig belongs to another program; name another database. It was left untouched"
    )]
    Foreign {
        /// URL of the database, without password.
        target: String,
    },
    /// The schema is older than this program needs.
    #[error(
        "{target}: found schema {found}, expected {expected} or later; run `relayrig fleet init` as its owner"
    )]
    SchemaOlder {
        /// URL of the database, without password.
        target: String,
        /// Number of the schema found.
        found: i32,
        /// Number of the schema that the program needs.
        expected: i32,
    },
    /// The database refuses this file.
    #[error("{target}: {refusal}")]
    Refused {
        /// URL of the database, without password.
        target: String,
        /// Reason of the refusal.
        refusal: Refusal,
    },
    /// The shifts of the plant have no place in the calendar.
    #[error("{target}: the shifts of fleet.toml cannot be laid out: {why}")]
    Shifts {
        /// URL of the database, without password.
        target: String,
        /// What is wrong.
        why: String,
    },
    /// The history cannot be read or written.
    #[error(transparent)]
    History(#[from] HistoryError),
}

impl FleetError {
    /// Names the database and the step in an error of the client library.
    pub(crate) fn of(target: &str, doing: &'static str, error: tokio_postgres::Error) -> Self {
        Self::Database {
            target: target.to_owned(),
            doing,
            said: said(&error),
            remedy: Remedy::of(&error),
            queued: false,
            error,
        }
    }

    /// Adds to an error of a push that the rows stay in the queue.
    pub(crate) fn while_sending(mut self) -> Self {
        if let Self::TimeOut { queued, .. } | Self::Database { queued, .. } = &mut self {
            *queued = true;
        }
        self
    }

    /// Returns true when sending again later may help without a person.
    #[must_use]
    pub const fn passes(&self) -> bool {
        match self {
            Self::TimeOut { .. }
            | Self::Database { .. }
            | Self::Fault { .. }
            | Self::History(_) => true,
            Self::Url { .. }
            | Self::PasswordFile { .. }
            | Self::Ca { .. }
            | Self::NoTls { .. }
            | Self::NoSchema { .. }
            | Self::Foreign { .. }
            | Self::SchemaOlder { .. }
            | Self::Runtime { .. }
            | Self::NoRig { .. }
            | Self::Shifts { .. }
            | Self::RealRigs { .. }
            | Self::Refused { .. } => false,
        }
    }

    /// Returns true when the connection broke or could not be made.
    pub(crate) fn is_broken(&self) -> bool {
        matches!(
            self,
            Self::Database {
                remedy: Remedy::Network,
                ..
            }
        )
    }

    /// Returns the refusal, if the database refuses the file.
    #[must_use]
    pub const fn refusal(&self) -> Option<&Refusal> {
        match self {
            Self::Refused { refusal, .. } => Some(refusal),
            _ => None,
        }
    }
}

/// Returns the end of a message about rows that were to be sent.
const fn queue(queued: bool) -> &'static str {
    match queued {
        true => ". The rows stay in the queue",
        false => "",
    }
}

/// Names the database and the step in errors of the client library.
pub(crate) trait Doing<T> {
    /// Converts an error of the client library to one of this crate.
    fn doing(self, target: &str, doing: &'static str) -> Result<T>;
}

impl<T> Doing<T> for std::result::Result<T, tokio_postgres::Error> {
    fn doing(self, target: &str, doing: &'static str) -> Result<T> {
        self.map_err(|error| FleetError::of(target, doing, error))
    }
}

/// Returns what the database or the system said, without the wrapping of the library.
fn said(error: &tokio_postgres::Error) -> String {
    if let Some(db) = error.as_db_error() {
        return db.message().to_owned();
    }
    let mut cause: &dyn std::error::Error = error;
    while let Some(inner) = cause.source() {
        cause = inner;
    }
    cause.to_string()
}
