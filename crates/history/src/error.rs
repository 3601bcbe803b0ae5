//! Reasons why the history cannot be read or written.

use super::source::{Read, ReadError, ServerError};
use std::path::PathBuf;

/// Reason why an access to the history failed; `source()` returns the underlying error.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// The file to read does not exist.
    #[error("no history at {path}: run a lot or import a file first")]
    Missing {
        /// The missing file.
        path: PathBuf,
    },
    /// The file is not an SQLite database, or it belongs to another program.
    #[error("{path} is not a relayrig history ({found}); it was left untouched")]
    Foreign {
        /// File that was to be opened.
        path: PathBuf,
        /// What was found instead.
        found: String,
    },
    /// The file was written by a later version of the program.
    #[error("{path} has schema {found}, this program knows up to {known}: use a newer program")]
    Newer {
        /// File that was to be opened.
        path: PathBuf,
        /// Schema of the file.
        found: i64,
        /// Latest schema that this program knows.
        known: i64,
    },
    /// The file belongs to a real rig, and a simulated rig would write to it, or the other way round.
    #[error(
        "{path} is the history of {holds}, found {found}: name another file with --db, since real and simulated parts never share one"
    )]
    OtherRig {
        /// Path of the file.
        path: PathBuf,
        /// Kind of rig that the file belongs to.
        holds: &'static str,
        /// Kind of rig that would write the file.
        found: &'static str,
    },
    /// Another process held the file for longer than the busy timeout.
    #[error("{doing}: the history is locked by another process")]
    Locked {
        /// What the program was doing.
        doing: &'static str,
        /// Error of SQLite.
        source: rusqlite::Error,
    },
    /// The disk is full; no row of the batch was written.
    #[error("{doing}: the disk is full")]
    DiskFull {
        /// What the program was doing.
        doing: &'static str,
        /// Error of SQLite.
        source: rusqlite::Error,
    },
    /// The file or its folder is read-only.
    #[error("{doing}: the history is read-only")]
    ReadOnly {
        /// What the program was doing.
        doing: &'static str,
        /// Error of SQLite.
        source: rusqlite::Error,
    },
    /// The file is read-only, and SQLite cannot read the rows in the file beside it (write-ahead log or journal)
    /// without write access.
    #[error(
        "{path} is read-only, and {beside} may hold its last rows: copy {path} and all files that begin with its name \
         into a folder that can be written"
    )]
    Unsettled {
        /// Path of the file.
        path: PathBuf,
        /// File that SQLite keeps beside `path`.
        beside: PathBuf,
    },
    /// The file is read-only and has an older schema, which this program would have to migrate.
    #[error(
        "{path} is read-only and has schema {found}; this program reads {known}: copy it into a folder that can be written"
    )]
    Unmigrated {
        /// Path of the file.
        path: PathBuf,
        /// Schema of the file.
        found: i64,
        /// Schema that this program reads.
        known: i64,
    },
    /// Any other error of the database.
    #[error("{doing}")]
    Database {
        /// What the program was doing.
        doing: &'static str,
        /// Error of SQLite.
        source: rusqlite::Error,
    },
    /// A row names a lot of which this writer has opened no run.
    #[error("lot {lot:?} is not open")]
    LotNotOpen {
        /// Name of the lot.
        lot: String,
    },
    /// A [`LandingRecord`](super::LandingRecord) names a part that is not in the history.
    #[error("lot {lot:?} has no {kind} part {seq} that could land")]
    NoSuchPart {
        /// Name of the lot.
        lot: String,
        /// Kind of the part: `lot`, or `golden` for a reference part.
        kind: String,
        /// Number of the part.
        seq: u64,
    },
    /// A part differs from the row that the history already has for it.
    #[error("lot {lot:?} already has another {kind} part {seq}; the first one stays")]
    PartTwice {
        /// Name of the lot.
        lot: String,
        /// Kind of the part: `lot`, or `golden` for a reference part.
        kind: String,
        /// Number of the part.
        seq: u64,
    },
    /// The beams of two bins report the same part.
    #[error("part {seq} of lot {lot:?} already landed in {first:?}, now in {second:?}")]
    LandedTwice {
        /// Name of the lot.
        lot: String,
        /// Number of the part.
        seq: u64,
        /// Bin that was stored first.
        first: String,
        /// Bin that is refused.
        second: String,
    },
    /// A count exceeds what SQLite can store.
    #[error("{what} {value} is beyond 2^63 - 1")]
    TooLarge {
        /// Name of the count.
        what: &'static str,
        /// Value of the count.
        value: u64,
    },
    /// The target of a backup already exists.
    #[error("{path} exists already; a backup never overwrites")]
    Exists {
        /// The existing file.
        path: PathBuf,
    },
    /// A finished copy could not be given its final name.
    #[error("putting the backup in place at {path}")]
    Place {
        /// Final name of the copy.
        path: PathBuf,
        /// Error of the file system.
        source: std::io::Error,
    },
    /// A server with the histories of many rigs cannot answer.
    #[error("{0}")]
    Server(ServerError),
    /// Two programs send this file to the same database.
    #[error("another program sends this file to {url}: stop one of them")]
    OtherBatch {
        /// Address of the database.
        url: String,
    },
    /// Only the file of a rig can answer this question.
    #[error(
        "{server} has no answer to this question; ask the history file of the rig (without --from)"
    )]
    OnlyFile {
        /// Name of the server.
        server: String,
    },
    /// The integrity check found damage.
    #[error("{path} is damaged: {finding}")]
    Damaged {
        /// File that was checked.
        path: PathBuf,
        /// First finding of the integrity check.
        finding: String,
    },
}

impl HistoryError {
    /// Returns true when SQLite failed because it could not write, or could not make a file of its own.
    pub(super) fn wants_to_write(&self) -> bool {
        let made_no_file =
            |it: &rusqlite::Error| it.sqlite_error_code() == Some(rusqlite::ErrorCode::CannotOpen);
        match self {
            Self::ReadOnly { .. } => true,
            Self::Database { source, .. } => made_no_file(source),
            _ => false,
        }
    }

    /// Returns the code of the message, in family `refusal`, that a page shows for this error.
    pub fn refusal(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "history_missing",
            Self::Locked { .. } => "history_locked",
            Self::DiskFull { .. } => "disk_full",
            Self::ReadOnly { .. } => "history_read_only",
            Self::Server(_) => "database_failed",
            _ => "history_failed",
        }
    }
}

/// Result of an access to the history.
pub type Result<T> = std::result::Result<T, HistoryError>;

/// Adds to a database error what the program was doing.
pub(super) trait Doing<T> {
    /// Converts a database error into the [`HistoryError`] that tells an operator what to do.
    fn doing(self, doing: &'static str) -> Result<T>;
}

impl<T> Doing<T> for Read<T> {
    fn doing(self, doing: &'static str) -> Result<T> {
        self.map_err(|error| match error {
            ReadError::File(source) => sorted(doing, source),
            ReadError::Server(error) => HistoryError::Server(error),
        })
    }
}

impl<T> Doing<T> for rusqlite::Result<T> {
    fn doing(self, doing: &'static str) -> Result<T> {
        self.map_err(|source| sorted(doing, source))
    }
}

fn sorted(doing: &'static str, source: rusqlite::Error) -> HistoryError {
    use rusqlite::ErrorCode;
    match source.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
            HistoryError::Locked { doing, source }
        }
        Some(ErrorCode::DiskFull) => HistoryError::DiskFull { doing, source },
        Some(ErrorCode::ReadOnly) => HistoryError::ReadOnly { doing, source },
        _ => HistoryError::Database { doing, source },
    }
}
