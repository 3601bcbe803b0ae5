//! The file of people and sessions.
//!
//! Callers pass the time, microseconds since 1970 UTC. Names are case-sensitive.

mod failures;
mod sessions;

pub use sessions::Login;

use super::error::{AccessError, Doing, Result};
use super::role::NoRole;
use super::{Role, SetupCode, password};
use data_encoding::HEXLOWER;
use history::Moment;
use rusqlite::{Connection, OpenFlags, params};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::time::Duration;
use utoipa::ToSchema;

/// Application id in the header of the file: `RRac` in ASCII.
const APPLICATION_ID: i64 = 0x5252_6163;
const SCHEMA: i64 = 2;
/// Tables of schema 1.
const PEOPLE: &str = include_str!("people.sql");
/// Table that schema 2 adds.
const FAILURES: &str = include_str!("failures.sql");

/// Name of the failed step in errors.
const OPENING: &str = "opening the list of people";

/// A person of the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Person {
    /// Name for the login, 1 to 40 characters.
    pub name: String,
    /// Role, which decides what the person may order and change.
    pub role: Role,
}

/// Entry of the list of people that engineers see.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Entry {
    /// Name and role.
    #[serde(flatten)]
    pub person: Person,
    /// Time at which the person was added.
    pub since: Moment,
    /// Time until which wrong passwords keep the person from logging in; `None` when the person may log in.
    pub locked_until: Option<Moment>,
}

/// The open file of people and sessions. Every call blocks; a login computes for about 20 ms.
#[derive(Debug)]
pub struct Register {
    connection: Connection,
}

/// Returns the path of the file of people that lies beside `history`: `relayrig-access.db` for `relayrig.db`.
#[must_use]
pub fn access_path(history: &Path) -> PathBuf {
    let stem = history.file_stem().unwrap_or_default().to_string_lossy();
    history.with_file_name(format!("{stem}-access.db"))
}

impl Register {
    /// Opens the file, or creates it; migrates an older schema.
    ///
    /// # Errors
    /// Fails for a file of another program or of a later version, which stays unchanged, and when SQLite fails.
    pub fn open(path: &Path) -> Result<Self> {
        own(path);
        let (register, schema) = Self::connect(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        match schema {
            0 => make(&register.connection, PEOPLE).doing("making the list of people")?,
            1 => make(&register.connection, "").doing("updating the list of people")?,
            _ => {}
        }
        let keys = register
            .connection
            .pragma_update(None, "foreign_keys", true);
        keys.doing(OPENING)?;
        Ok(register)
    }

    /// Opens an existing file for reading; changes neither the file nor its schema.
    ///
    /// # Errors
    /// Fails for a missing or empty file, for a file of another program or of a later version, and when SQLite fails.
    pub fn open_unchanged(path: &Path) -> Result<Self> {
        match Self::connect(path, OpenFlags::SQLITE_OPEN_READ_ONLY)? {
            (_, 0) => Err(foreign(path, 0, 0)),
            (register, _) => Ok(register),
        }
    }

    /// Returns the open file with its schema, 0 for an empty file.
    fn connect(path: &Path, access: OpenFlags) -> Result<(Self, i64)> {
        let connection = Connection::open_with_flags(path, access).doing(OPENING)?;
        connection
            .busy_timeout(Duration::from_secs(5))
            .doing(OPENING)?;
        let pragma = |name| connection.pragma_query_value(None, name, |row| row.get::<_, i64>(0));
        let tables =
            connection.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0));
        let (id, schema, tables): (i64, i64, i64) = (
            pragma("application_id").doing(OPENING)?,
            pragma("user_version").doing(OPENING)?,
            tables.doing(OPENING)?,
        );
        match (id, schema, tables) {
            (0, 0, 0) | (APPLICATION_ID, 1..=SCHEMA, _) => Ok((Self { connection }, schema)),
            _ => Err(foreign(path, id, schema)),
        }
    }

    /// Copies the file to `target`; creates `target` as a file that only this user can read or write.
    ///
    /// # Errors
    /// Fails when `target` is not empty, or cannot be written.
    pub fn copy_to(&self, target: &Path) -> Result<()> {
        own(target);
        self.connection
            .execute("VACUUM INTO ?1", [target.to_string_lossy()])
            .doing("copying the list of people")?;
        Ok(())
    }

    /// Checks the whole file; returns all people in order of their names.
    ///
    /// # Errors
    /// Fails when the file is damaged.
    pub fn checked_people(&self) -> Result<Vec<Person>> {
        const DOING: &str = "checking the list of people";
        let pragma = "PRAGMA integrity_check(1)";
        let found: String = (self.connection)
            .query_row(pragma, [], |row| row.get(0))
            .doing(DOING)?;
        match found.as_str() {
            "ok" => self.people(),
            _ => Err(AccessError::Damaged { found }),
        }
    }

    /// Returns a code for adding the first engineer; `None` when there is an engineer.
    pub fn setup_code(&self) -> Result<Option<SetupCode>> {
        (!self.has_engineer()?).then(SetupCode::draw).transpose()
    }

    /// Returns true when a person has the role engineer.
    pub fn has_engineer(&self) -> Result<bool> {
        let engineers = self.people()?;
        Ok(engineers.iter().any(|it| it.role == Role::Engineer))
    }

    /// Returns all people in order of their names.
    fn people(&self) -> Result<Vec<Person>> {
        const DOING: &str = "listing people";
        let mut rows = self
            .connection
            .prepare("SELECT name, role FROM person ORDER BY name")
            .doing(DOING)?;
        let people = rows.query_map([], person).doing(DOING)?;
        people.collect::<rusqlite::Result<_>>().doing(DOING)
    }

    /// Returns all people in order of their names, each with the end of a lock that holds at `now_us`.
    pub fn entries(&self, now_us: i64) -> Result<Vec<Entry>> {
        const DOING: &str = "listing people";
        let mut rows = self
            .connection
            .prepare("SELECT name, role, since_us FROM person ORDER BY name")
            .doing(DOING)?;
        let found = rows
            .query_map([], |row| Ok((person(row)?, row.get(2)?)))
            .doing(DOING)?;
        found
            .map(|row| {
                let (person, since_us) = row.doing(DOING)?;
                let locked_until = self.locked_until_us(&person.name, now_us)?.map(Moment);
                Ok(Entry {
                    person,
                    since: Moment(since_us),
                    locked_until,
                })
            })
            .collect()
    }

    /// Adds a person. Fails when the name is taken or malformed or the password has a wrong length.
    pub fn add(&mut self, name: &str, role: Role, password: &str, now_us: i64) -> Result<()> {
        let typed = |it: char| it.is_alphanumeric() || ".-_".contains(it);
        if !(1..=40).contains(&name.chars().count()) || !name.chars().all(typed) {
            let found = name.chars().take(60).collect();
            return Err(AccessError::Name { found });
        }
        let hash = password::hash(password)?;
        let sql = "INSERT INTO person VALUES (?1, ?2, ?3, ?4) ON CONFLICT DO NOTHING";
        let row = params![name, role.word(), hash, now_us];
        match self.connection.execute(sql, row).doing("adding a person")? {
            0 => Err(AccessError::Taken {
                name: name.to_owned(),
            }),
            _ => Ok(()),
        }
    }

    /// Changes the password and ends the person's sessions. Fails for an unknown name and a wrong length.
    pub fn set_password(&mut self, name: &str, password: &str) -> Result<()> {
        const DOING: &str = "changing a password";
        let hash = password::hash(password)?;
        let change = self.connection.transaction().doing(DOING)?;
        let sql = "UPDATE person SET password = ?2 WHERE name = ?1";
        let found = change.execute(sql, params![name, hash]).doing(DOING)?;
        change
            .execute("DELETE FROM session WHERE person = ?1", [name])
            .doing(DOING)?;
        require_found(found, name)?;
        change.commit().doing(DOING)
    }

    /// Gives a person another role. Fails for an unknown name, and for the last engineer.
    pub fn set_role(&mut self, name: &str, role: Role) -> Result<()> {
        if role != Role::Engineer {
            self.spare_last_engineer(name)?;
        }
        let sql = "UPDATE person SET role = ?2 WHERE name = ?1";
        let found = self.connection.execute(sql, [name, role.word()]);
        require_found(found.doing("changing a role")?, name)
    }

    /// Forgets the wrong passwords of a person. Fails for an unknown name.
    pub fn unlock(&mut self, name: &str) -> Result<()> {
        let people = self.people()?;
        require_found(people.iter().filter(|it| it.name == name).count(), name)?;
        self.forgive(name)
    }

    /// Removes a person with all sessions. Fails for an unknown name and for the last engineer.
    pub fn remove(&mut self, name: &str) -> Result<()> {
        self.spare_last_engineer(name)?;
        let sql = "DELETE FROM person WHERE name = ?1";
        let found = self.connection.execute(sql, [name]);
        require_found(found.doing("removing a person")?, name)
    }

    fn spare_last_engineer(&self, name: &str) -> Result<()> {
        let mut engineers = self.people()?;
        engineers.retain(|it| it.role == Role::Engineer);
        match &engineers[..] {
            [last] if last.name == name => Err(AccessError::LastEngineer {
                name: name.to_owned(),
            }),
            _ => Ok(()),
        }
    }
}

/// Creates a missing file so that no other user can read or write it, because the file holds hashes of passwords.
/// Ignores a failure, because the caller then fails to open the file.
fn own(path: &Path) {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let _ = options.open(path);
}

/// Runs the SQL `first`, then brings the file from schema 1 to the present schema, in one transaction.
fn make(connection: &Connection, first: &str) -> rusqlite::Result<()> {
    connection.execute_batch(&format!(
        "BEGIN IMMEDIATE; {first} {FAILURES} PRAGMA user_version = {SCHEMA}; \
         PRAGMA application_id = {APPLICATION_ID}; COMMIT;"
    ))
}

fn person(row: &rusqlite::Row<'_>) -> rusqlite::Result<Person> {
    let role: String = row.get(1)?;
    let role = role.parse().map_err(|reason: NoRole| {
        rusqlite::Error::FromSqlConversionFailure(1, rusqlite::types::Type::Text, reason.into())
    })?;
    let name = row.get(0)?;
    Ok(Person { name, role })
}

fn foreign(path: &Path, id: i64, schema: i64) -> AccessError {
    let found = format!("application id {id:#x}, schema {schema}");
    let path = path.to_owned();
    AccessError::Foreign { path, found }
}

fn require_found(rows: usize, name: &str) -> Result<()> {
    match rows {
        0 => Err(AccessError::Unknown {
            name: name.to_owned(),
        }),
        _ => Ok(()),
    }
}

fn digest(token: &str) -> String {
    HEXLOWER.encode(&Sha256::digest(token))
}

#[cfg(test)]
mod tests;
