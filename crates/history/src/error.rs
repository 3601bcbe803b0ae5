//! Why the history could not be read or written.

use std::path::PathBuf;

/// A failed access to the history. The cause is in `source()`.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// The file to read does not exist.
    #[error("no history at {path}: run a lot or import a file first")]
    Missing {
        /// The missing file.
        path: PathBuf,
    },
    /// The file is no SQLite database, or one of another program.
    #[error("{path} is not a relayrig history ({found}); it was left untouched")]
    Foreign {
        /// The file asked for.
        path: PathBuf,
        /// What was found instead.
        found: String,
    },
    /// The file was written by a later version of the program.
    #[error("{path} has schema {found}, this program knows up to {known}: use a newer program")]
    Newer {
        /// The file asked for.
        path: PathBuf,
        /// Schema of the file.
        found: i64,
        /// Latest schema known here.
        known: i64,
    },
    /// The file belongs to a rig of the other kind.
    #[error(
        "{path} is the history of {holds}, found {found}: name another file with --db, since real and simulated parts never share one"
    )]
    OtherRig {
        /// The file asked for.
        path: PathBuf,
        /// Rig of the file.
        holds: &'static str,
        /// Rig that would write.
        found: &'static str,
    },
    /// Another process held the file for longer than the busy timeout.
    #[error("{doing}: the history is locked by another process")]
    Locked {
        /// The step that failed.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// The disk is full; nothing of the batch was written.
    #[error("{doing}: the disk is full")]
    DiskFull {
        /// The step that failed.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// The file or its folder is read-only.
    #[error("{doing}: the history is read-only")]
    ReadOnly {
        /// The step that failed.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// Any other answer of the database.
    #[error("{doing}")]
    Database {
        /// The step that failed.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// A row names a lot that this writer did not open.
    #[error("lot {lot:?} is not open")]
    LotNotOpen {
        /// The lot named.
        lot: String,
    },
    /// A landing names a part that has no row.
    #[error("lot {lot:?} has no {kind} part {seq} that could land")]
    NoSuchPart {
        /// The lot named.
        lot: String,
        /// `lot` or `golden`.
        kind: String,
        /// The part named.
        seq: u64,
    },
    /// A part differs from the row that it already has.
    #[error("lot {lot:?} already has another {kind} part {seq}; the first one stays")]
    PartTwice {
        /// The lot named.
        lot: String,
        /// `lot` or `golden`.
        kind: String,
        /// The part named.
        seq: u64,
    },
    /// The beams of two bins confirm the same part.
    #[error("part {seq} of lot {lot:?} already landed in {first:?}, now in {second:?}")]
    LandedTwice {
        /// The lot named.
        lot: String,
        /// The part named.
        seq: u64,
        /// The bin in the row.
        first: String,
        /// The bin refused.
        second: String,
    },
    /// A count exceeds what SQLite can store.
    #[error("{what} {value} is beyond 2^63 - 1")]
    TooLarge {
        /// Name of the count.
        what: &'static str,
        /// Its value.
        value: u64,
    },
    /// The target of a backup exists.
    #[error("{path} exists already; a backup never overwrites")]
    Exists {
        /// The existing file.
        path: PathBuf,
    },
    /// A finished copy could not get its name.
    #[error("putting the backup in place at {path}")]
    Place {
        /// Target of the backup.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The integrity check found damage.
    #[error("{path} is damaged: {finding}")]
    Damaged {
        /// The file checked.
        path: PathBuf,
        /// First finding of the integrity check.
        finding: String,
    },
}

/// Result of an access to the history.
pub type Result<T> = std::result::Result<T, HistoryError>;

/// Adds the step that failed to a database error.
pub(super) trait Doing<T> {
    /// Turns a database error into the variant an operator can act upon.
    fn doing(self, doing: &'static str) -> Result<T>;
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
