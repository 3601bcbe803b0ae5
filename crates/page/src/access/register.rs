//! The file of people and sessions.
//!
//! Callers pass the time, microseconds since 1970 UTC. Names are case-sensitive.

use super::error::{AccessError, Doing, Result};
use super::role::NoRole;
use super::{Role, SESSION_S, password};
use data_encoding::HEXLOWER;
use rusqlite::{Connection, OptionalExtension, params};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Application id in the header of the file: `RRac` in ASCII.
const APPLICATION_ID: i64 = 0x5252_6163;
const SCHEMA: i64 = 1;
/// Name of the engineer whom the first start adds.
const FIRST: &str = "engineer";
/// Hash that no password matches: checking it costs an unknown name the time of a known one.
const NOBODY: &str = "$argon2id$v=19$m=19456,t=2,p=1$c29tZSBzYWx0IGhlcmU$\
                      zY2ZxH5hG1m3pV0Q3mCkGd5dTn0l2yq0hXo1m3u9m6E";

/// A person of the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Person {
    /// Name for the login, 1 to 40 characters.
    pub name: String,
    /// Role, which decides what the person may order and change.
    pub role: Role,
}

/// The open file of people and sessions. Every call blocks; a login computes for about 20 ms.
#[derive(Debug)]
pub struct Register {
    connection: Connection,
}

/// Returns the path of the file of people that belongs to `history`: `relayrig-access.db` for `relayrig.db`.
#[must_use]
pub fn access_path(history: &Path) -> PathBuf {
    let stem = history.file_stem().unwrap_or_default().to_string_lossy();
    history.with_file_name(format!("{stem}-access.db"))
}

impl Register {
    /// Opens the file, or creates it.
    ///
    /// # Errors
    /// Fails for a file of another program or of a later version, which stays unchanged, and when SQLite fails.
    pub fn open(path: &Path) -> Result<Self> {
        const DOING: &str = "opening the list of people";
        own(path);
        let connection = Connection::open(path).doing(DOING)?;
        connection
            .busy_timeout(Duration::from_secs(5))
            .doing(DOING)?;
        let pragma = |name| connection.pragma_query_value(None, name, |row| row.get::<_, i64>(0));
        let tables =
            connection.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0));
        let (id, schema, tables): (i64, i64, i64) = (
            pragma("application_id").doing(DOING)?,
            pragma("user_version").doing(DOING)?,
            tables.doing(DOING)?,
        );
        match (id, schema, tables) {
            (0, 0, 0) => make(&connection).doing("making the list of people")?,
            (APPLICATION_ID, SCHEMA, _) => {}
            _ => {
                let found = format!("application id {id:#x}, schema {schema}");
                let path = path.to_owned();
                return Err(AccessError::Foreign { path, found });
            }
        }
        connection
            .pragma_update(None, "foreign_keys", true)
            .doing(DOING)?;
        Ok(Self { connection })
    }

    /// Copies the file to `target`, which must not exist and gets the same access rights.
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

    /// Adds an engineer to a file without people; returns name and password, of which the file holds only the hash.
    pub fn first_engineer(&mut self, now_us: i64) -> Result<Option<(String, String)>> {
        if !self.people()?.is_empty() {
            return Ok(None);
        }
        let drawn = Self::random_password()?;
        self.add(FIRST, Role::Engineer, &drawn, now_us)?;
        Ok(Some((FIRST.to_owned(), drawn)))
    }

    /// Returns a password of 64 random bits in hexadecimal.
    pub fn random_password() -> Result<String> {
        password::random(8)
    }

    /// Returns all people in order of their names.
    pub fn people(&self) -> Result<Vec<Person>> {
        const DOING: &str = "listing people";
        let mut rows = self
            .connection
            .prepare("SELECT name, role FROM person ORDER BY name")
            .doing(DOING)?;
        let people = rows.query_map([], person).doing(DOING)?;
        people.collect::<rusqlite::Result<_>>().doing(DOING)
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

    /// Changes the password and ends the person's sessions. Fails for an unknown name.
    pub fn set_password(&mut self, name: &str, password: &str) -> Result<()> {
        const DOING: &str = "changing a password";
        let hash = password::hash(password)?;
        let change = self.connection.transaction().doing(DOING)?;
        let sql = "UPDATE person SET password = ?2 WHERE name = ?1";
        let found = change.execute(sql, params![name, hash]).doing(DOING)?;
        change
            .execute("DELETE FROM session WHERE person = ?1", [name])
            .doing(DOING)?;
        change.commit().doing(DOING)?;
        require_found(found, name)
    }

    /// Removes a person with all sessions. Fails for an unknown name and for the last engineer.
    pub fn remove(&mut self, name: &str) -> Result<()> {
        let mut engineers = self.people()?;
        engineers.retain(|it| it.role == Role::Engineer);
        if let [last] = &engineers[..]
            && last.name == name
        {
            return Err(AccessError::LastEngineer {
                name: name.to_owned(),
            });
        }
        let sql = "DELETE FROM person WHERE name = ?1";
        let found = self
            .connection
            .execute(sql, [name])
            .doing("removing a person")?;
        require_found(found, name)
    }

    /// Opens a session; returns the person and the token, `None` when name or password is wrong.
    pub fn log_in(
        &mut self,
        name: &str,
        password: &str,
        now_us: i64,
    ) -> Result<Option<(Person, String)>> {
        const DOING: &str = "logging in";
        let sql = "SELECT name, role, password FROM person WHERE name = ?1";
        let found = self
            .connection
            .query_row(sql, [name], |row| {
                Ok((person(row)?, row.get::<_, String>(2)?))
            })
            .optional()
            .doing(DOING)?;
        let kept = found.as_ref().map_or(NOBODY, |(_, hash)| hash.as_str());
        let fits = password::matches(password, kept)?;
        let Some((person, _)) = found.filter(|_| fits) else {
            return Ok(None);
        };
        let token = password::random(32)?;
        let until_us = now_us + SESSION_S * 1_000_000;
        let begin = self.connection.transaction().doing(DOING)?;
        begin
            .execute("DELETE FROM session WHERE until_us <= ?1", [now_us])
            .doing(DOING)?;
        let row = params![digest(&token), person.name, until_us];
        begin
            .execute("INSERT INTO session VALUES (?1, ?2, ?3)", row)
            .doing(DOING)?;
        begin.commit().doing(DOING)?;
        Ok(Some((person, token)))
    }

    /// Returns the person who holds the session `token`; `None` for an unknown or expired one.
    pub fn holder(&self, token: &str, now_us: i64) -> Result<Option<Person>> {
        let sql = "SELECT name, role FROM session JOIN person ON person = name
                   WHERE token_sha256 = ?1 AND until_us > ?2";
        let row = params![digest(token), now_us];
        let found = self.connection.query_row(sql, row, person).optional();
        found.doing("looking up a session")
    }

    /// Ends a session; ignores an unknown token.
    pub fn log_out(&mut self, token: &str) -> Result<()> {
        let sql = "DELETE FROM session WHERE token_sha256 = ?1";
        self.connection
            .execute(sql, [digest(token)])
            .doing("logging out")?;
        Ok(())
    }
}

/// Creates the file, if it is missing, as this user's own: no other user can read or write it, because it holds hashes
/// of passwords. Ignores a failure, because opening the file afterwards reports it.
fn own(path: &Path) {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let _ = options.open(path);
}

fn make(connection: &Connection) -> rusqlite::Result<()> {
    connection.execute_batch(&format!(
        "BEGIN IMMEDIATE; {} PRAGMA user_version = {SCHEMA}; PRAGMA application_id = {APPLICATION_ID}; COMMIT;",
        include_str!("people.sql")
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
