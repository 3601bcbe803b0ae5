//! Opens a history file: checks which program it belongs to, migrates it to the present schema, makes writes durable.
//!
//! 1. A file with tables but another `application_id` belongs to another program; opening it fails before any write.
//! 2. Opening fails on a schema newer than this program, and migrates an older one: all missing steps in one
//!    transaction.
//! 3. Write-ahead log with `synchronous = FULL`: a batch that was acknowledged survives power loss
//!    ([`Store::trust_the_power`](super::Store::trust_the_power) makes an exception).
//! 4. SQLite may not use bound values for its query plans (`QPSG`), because planning a statement again for each part
//!    would take longer than running it.
//! 5. Reads use the page cache, not a memory map: an I/O error in a map raises a signal, which would end the process
//!    that drives the rig.

use super::error::{Doing, HistoryError, Result};
use super::{reasons, series, views};
use rusqlite::config::DbConfig;
use rusqlite::{Connection, ErrorCode, OpenFlags};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Application id in the header of a history file: `RRig` in ASCII.
pub const APPLICATION_ID: i64 = 0x5252_6967;

/// Step `n` migrates schema `n` to `n + 1`. Existing steps never change.
pub(super) const MIGRATIONS: [&str; 17] = [
    include_str!("schema/v1.sql"),
    include_str!("schema/v2.sql"),
    include_str!("schema/v3.sql"),
    include_str!("schema/v4.sql"),
    include_str!("schema/v5.sql"),
    include_str!("schema/v6.sql"),
    include_str!("schema/v7.sql"),
    include_str!("schema/v8.sql"),
    include_str!("schema/v9.sql"),
    include_str!("schema/v10.sql"),
    include_str!("schema/v11.sql"),
    include_str!("schema/v12.sql"),
    include_str!("schema/v13.sql"),
    include_str!("schema/v14.sql"),
    include_str!("schema/v15.sql"),
    include_str!("schema/v16.sql"),
    include_str!("schema/v17.sql"),
];

/// Schema that this program writes.
pub const SCHEMA: i64 = MIGRATIONS.len() as i64;

/// First schema that packs the values of closed runs.
const PACKS: i64 = 6;

/// First schema that stores reasons as codes.
const CODES: i64 = 8;

/// Name of the failed step in errors.
const OPENING: &str = "opening the history";

/// Longest wait for a file that another process has locked; longer than any batch takes.
const BUSY: Duration = Duration::from_secs(5);

/// Page cache of a connection that writes, KiB. It appends rows and seldom reads a page again; a larger cache would go on
/// filling for thousands of parts.
const WRITER_CACHE_KIB: i64 = 512;

/// Opens a file for writing; creates it if it is missing.
pub(super) fn writer(path: &Path) -> Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE
        | OpenFlags::SQLITE_OPEN_CREATE
        | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = connected(path, flags).doing(OPENING)?;
    prepare(&connection, path)?;
    Ok(connection)
}

/// Opens an existing file for reading; migrates an older schema first. On read-only media SQLite
/// makes no files beside it.
pub(super) fn reader(path: &Path) -> Result<Connection> {
    let (connection, schema) = existing(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
    if schema < SCHEMA {
        if connection.is_readonly(rusqlite::MAIN_DB).doing(OPENING)? {
            return Err(HistoryError::Unmigrated {
                path: path.to_owned(),
                found: schema,
                known: SCHEMA,
            });
        }
        prepare(&connection, path)?;
    }
    connection
        .pragma_update(None, "query_only", true)
        .doing(OPENING)?;
    Ok(connection)
}

/// Opens an existing file without changing it; returns its schema too, which may be older than this program's.
pub(super) fn unchanged(path: &Path) -> Result<(Connection, i64)> {
    existing(path, OpenFlags::SQLITE_OPEN_READ_ONLY)
}

/// Returns true when another program has the file open. A damaged file, or a file that is no database, counts as not in
/// use.
///
/// # Errors
/// Fails when the file cannot be opened or locked, because then another program may have it open.
pub fn is_in_use(path: &Path) -> Result<bool> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(path, flags).doing(OPENING)?;
    connection.busy_timeout(Duration::ZERO).doing(OPENING)?;
    let alone = connection
        .pragma_update_and_check(None, "locking_mode", "EXCLUSIVE", |_| Ok(()))
        .and_then(|()| connection.execute_batch("BEGIN EXCLUSIVE; ROLLBACK"));
    let code = alone
        .as_ref()
        .err()
        .and_then(rusqlite::Error::sqlite_error_code);
    if let Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt) = code {
        return Ok(false);
    }
    match alone.doing(OPENING) {
        Err(HistoryError::Locked { .. }) => Ok(true),
        answer => answer.map(|()| false),
    }
}

fn existing(path: &Path, access: OpenFlags) -> Result<(Connection, i64)> {
    if !path.exists() {
        return Err(HistoryError::Missing {
            path: path.to_owned(),
        });
    }
    let opened = |name: &Path, flags| {
        let flags = flags | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection = connected(name, flags).doing(OPENING)?;
        let schema = check(&connection, path)?;
        Ok::<_, HistoryError>((connection, schema))
    };
    match opened(path, access) {
        Err(error) if error.wants_to_write() => {
            let name = immutable_name(path)?;
            let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
            opened(&name, flags)
        }
        done => done,
    }
}

/// Returns the URI by which SQLite opens the file as immutable and makes no files beside it. Fails when a write-ahead
/// log or its index is there already, because SQLite would ignore the rows in it.
fn immutable_name(path: &Path) -> Result<PathBuf> {
    for end in ["-wal", "-shm"] {
        let beside = with_end(path, end);
        if std::fs::metadata(&beside).is_ok_and(|it| it.len() > 0) {
            let path = path.to_owned();
            return Err(HistoryError::Unsettled { path, beside });
        }
    }
    let name = path.to_string_lossy().replace('%', "%25");
    let name = name.replace('?', "%3f").replace('#', "%23");
    Ok(format!("file:{name}?immutable=1").into())
}

/// Returns the path with `end` after its name: `rig.db-wal` for `rig.db` and `-wal`.
#[must_use]
pub fn with_end(path: &Path, end: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(end);
    name.into()
}

fn connected(path: &Path, flags: OpenFlags) -> rusqlite::Result<Connection> {
    let connection = Connection::open_with_flags(path, flags)?;
    connection.busy_timeout(BUSY)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_QPSG, true)?;
    connection.set_prepared_statement_cache_capacity(64);
    Ok(connection)
}

fn prepare(connection: &Connection, path: &Path) -> Result<()> {
    const DOING: &str = "preparing the history";
    let found = check(connection, path)?;
    connection
        .pragma_update_and_check(None, "journal_mode", "WAL", |_| Ok(()))
        .doing(DOING)?;
    connection
        .pragma_update(None, "synchronous", "FULL")
        .doing(DOING)?;
    connection
        .pragma_update(None, "foreign_keys", true)
        .doing(DOING)?;
    connection
        .pragma_update(None, "cache_size", -WRITER_CACHE_KIB)
        .doing(DOING)?;
    migrate(connection, found)
}

/// Returns the schema of the file, 0 for an empty one. Fails when the file belongs to another program, or when its
/// schema is newer.
fn check(connection: &Connection, path: &Path) -> Result<i64> {
    let foreign = |found: String| HistoryError::Foreign {
        path: path.to_owned(),
        found,
    };
    let (id, schema, tables) = match header(connection) {
        Err(cause) if cause.sqlite_error_code() == Some(ErrorCode::NotADatabase) => {
            return Err(foreign("no SQLite database".to_owned()));
        }
        answer => answer.doing("reading the header of the history")?,
    };
    match (id, schema, tables) {
        (0, 0, 0) => Ok(0),
        (APPLICATION_ID, 1..=SCHEMA, _) => Ok(schema),
        (APPLICATION_ID, found, _) if found > SCHEMA => Err(HistoryError::Newer {
            path: path.to_owned(),
            found,
            known: SCHEMA,
        }),
        (other, _, tables) => Err(foreign(format!(
            "application id {other:#x}, {tables} tables and indexes"
        ))),
    }
}

/// Reads the header of the file: application id, schema, and the number of tables and indexes.
fn header(connection: &Connection) -> rusqlite::Result<(i64, i64, i64)> {
    let tables = "SELECT count(*) FROM sqlite_schema";
    Ok((
        connection.pragma_query_value(None, "application_id", |row| row.get(0))?,
        connection.pragma_query_value(None, "user_version", |row| row.get(0))?,
        connection.query_row(tables, [], |row| row.get(0))?,
    ))
}

fn migrate(connection: &Connection, found: i64) -> Result<()> {
    const DOING: &str = "bringing the history to the schema of this program";
    if found >= SCHEMA {
        return Ok(());
    }
    connection.execute_batch("BEGIN IMMEDIATE").doing(DOING)?;
    let done = steps(connection).doing(DOING);
    let end = if done.is_ok() { "COMMIT" } else { "ROLLBACK" };
    connection.execute_batch(end).doing(DOING)?;
    done
}

/// Runs the missing migrations. Reads the schema again, because another process may have migrated the file while this
/// one waited for the lock.
fn steps(connection: &Connection) -> rusqlite::Result<()> {
    let from: i64 = connection.pragma_query_value(None, "user_version", |row| row.get(0))?;
    for (step, sql) in MIGRATIONS
        .iter()
        .enumerate()
        .skip(usize::try_from(from).unwrap_or(0))
    {
        connection.execute_batch(sql)?;
        connection.pragma_update(None, "user_version", step as i64 + 1)?;
    }
    connection.pragma_update(None, "application_id", APPLICATION_ID)?;
    if (1..PACKS).contains(&from) {
        series::pack_all(connection)?;
    }
    if (1..CODES).contains(&from) {
        reasons::read_texts(connection)?;
    }
    views::rebuild(connection)
}
