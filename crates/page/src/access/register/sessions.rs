//! Logins and sessions.

use super::{Person, Register, digest, person};
use crate::access::error::{Doing, Result};
use crate::access::{SESSION_S, SetupCode, password};
use rusqlite::{OptionalExtension, params};
use std::time::Duration;

/// Hash that no password matches: a login with an unknown name checks this hash, and so takes as long as with a known
/// name.
const NOBODY: &str = "$argon2id$v=19$m=19456,t=2,p=1$c29tZSBzYWx0IGhlcmU$\
                      zY2ZxH5hG1m3pV0Q3mCkGd5dTn0l2yq0hXo1m3u9m6E";

/// Name under which wrong set-up codes count; no person can have this name.
const SETUP: &str = "set-up code";

/// Outcome of an attempt to log in, or to prove one's password.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Login<T = (Person, String)> {
    /// Name and password are right. Holds the person; after a login also the token of the session.
    Right(T),
    /// Name or password is wrong.
    Wrong {
        /// True when a person has this name; for the audit, not for the client.
        known: bool,
    },
    /// The register checked no password, because too many were wrong before. Holds the time until the next attempt may
    /// come.
    Wait(Duration),
}

impl Register {
    /// Checks a password: counts a wrong password, and clears the failures of the name after a right one.
    pub fn prove(&mut self, name: &str, password: &str, now_us: i64) -> Result<Login<Person>> {
        if let Some(wait) = self.wait(name, now_us)? {
            return Ok(Login::Wait(wait));
        }
        let sql = "SELECT name, role, password FROM person WHERE name = ?1";
        let found = self
            .connection
            .query_row(sql, [name], |row| {
                Ok((person(row)?, row.get::<_, String>(2)?))
            })
            .optional()
            .doing("logging in")?;
        let known = found.is_some();
        let kept = found.as_ref().map_or(NOBODY, |(_, hash)| hash.as_str());
        let fits = password::matches(password, kept)?;
        match found.filter(|_| fits) {
            Some((person, _)) => {
                self.forgive(name)?;
                Ok(Login::Right(person))
            }
            None => {
                self.failed(name, now_us)?;
                Ok(Login::Wrong { known })
            }
        }
    }

    /// Checks `typed` against the set-up code; counts a wrong code like a wrong password. Once there is an engineer,
    /// every code is wrong.
    pub fn prove_code(
        &mut self,
        code: Option<&SetupCode>,
        typed: &str,
        now_us: i64,
    ) -> Result<Login<()>> {
        if let Some(wait) = self.wait(SETUP, now_us)? {
            return Ok(Login::Wait(wait));
        }
        if code.is_some_and(|it| it.fits(typed)) && !self.has_engineer()? {
            return Ok(Login::Right(()));
        }
        self.failed(SETUP, now_us)?;
        Ok(Login::Wrong { known: false })
    }

    /// Opens a session after a right password; see [`Self::prove`].
    pub fn log_in(&mut self, name: &str, password: &str, now_us: i64) -> Result<Login> {
        Ok(match self.prove(name, password, now_us)? {
            Login::Right(person) => {
                let token = self.open_session(&person.name, now_us)?;
                Login::Right((person, token))
            }
            Login::Wrong { known } => Login::Wrong { known },
            Login::Wait(wait) => Login::Wait(wait),
        })
    }

    /// Opens a session of a person; returns the token of the session.
    pub fn open_session(&mut self, name: &str, now_us: i64) -> Result<String> {
        const DOING: &str = "opening a session";
        let token = password::random_hex(32)?;
        let until_us = now_us + SESSION_S * 1_000_000;
        let begin = self.connection.transaction().doing(DOING)?;
        begin
            .execute("DELETE FROM session WHERE until_us <= ?1", [now_us])
            .doing(DOING)?;
        let row = params![digest(&token), name, until_us];
        begin
            .execute("INSERT INTO session VALUES (?1, ?2, ?3)", row)
            .doing(DOING)?;
        begin.commit().doing(DOING)?;
        Ok(token)
    }

    /// Returns the person who holds the session `token`; `None` for an unknown or expired token.
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
