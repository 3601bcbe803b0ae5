//! Why the history could not be read or written.

use std::path::PathBuf;

/// Each variant says what was being done; the cause stays in `source()`.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// Reading a history that was never written.
    #[error("no history at {path}: run a lot or import a file first")]
    Missing {
        /// The file asked for.
        path: PathBuf,
    },
    /// The file is no SQLite database, or one of another program.
    #[error("{path} is not a relayrig history ({found}); it was left untouched")]
    Foreign {
        /// The file asked for.
        path: PathBuf,
        /// What it is instead.
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
    /// Another process held the file for longer than the busy time.
    #[error("{doing}: the history is locked by another process")]
    Locked {
        /// What was being done.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// No room; nothing of the batch was kept.
    #[error("{doing}: the disk is full")]
    DiskFull {
        /// What was being done.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// The file or its folder may not be written.
    #[error("{doing}: the history is read-only")]
    ReadOnly {
        /// What was being done.
        doing: &'static str,
        /// The cause.
        source: rusqlite::Error,
    },
    /// Any other answer of the database.
    #[error("{doing}")]
    Database {
        /// What was being done.
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
    /// A landing without its part.
    #[error("lot {lot:?} has no {kind} part {seq} that could land")]
    NoSuchPart {
        /// The lot named.
        lot: String,
        /// `lot` or `golden`.
        kind: String,
        /// The part named.
        seq: u64,
    },
    /// The same part twice with different contents.
    #[error("lot {lot:?} already has another {kind} part {seq}; the first one stays")]
    PartTwice {
        /// The lot named.
        lot: String,
        /// `lot` or `golden`.
        kind: String,
        /// The part named.
        seq: u64,
    },
    /// A part confirmed by the beams of two bins.
    #[error("part {seq} of lot {lot:?} already landed in {first:?}, now in {second:?}")]
    LandedTwice {
        /// The lot named.
        lot: String,
        /// The part named.
        seq: u64,
        /// The bin that stays.
        first: String,
        /// The bin refused.
        second: String,
    },
    /// A count beyond what a row can hold.
    #[error("{what} {value} is beyond 2^63 - 1")]
    TooLarge {
        /// Which count.
        what: &'static str,
        /// Its value.
        value: u64,
    },
    /// A copy would overwrite something.
    #[error("{path} exists already; a backup never overwrites")]
    Exists {
        /// The file in the way.
        path: PathBuf,
    },
    /// The copy could not be moved into place.
    #[error("putting the backup in place at {path}")]
    Place {
        /// The file wanted.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The database fails its own check.
    #[error("{path} is damaged: {finding}")]
    Damaged {
        /// The file checked.
        path: PathBuf,
        /// First finding of the integrity check.
        finding: String,
    },
}

/// Shorthand of this module.
pub type Result<T> = std::result::Result<T, HistoryError>;

/// Gives a database answer the sentence of what was being done.
pub(super) trait Doing<T> {
    /// Sorts the cause into the variants an operator can act upon.
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
