//! Limits the number of wrong passwords within five minutes.
//!
//! A name may fail five times within five minutes, all names together thirty times. Then the next attempt must wait
//! until the oldest of these failures is five minutes old. A right password clears the failures of its name, and so
//! does an engineer who unlocks the name. The file keeps the failures, so that a restart clears none. A failure dated
//! in the future, from before the clock was set back, does not count.

use super::{Register, digest};
use crate::access::error::{Doing, Result};
use rusqlite::{OptionalExtension, params};
use std::time::Duration;

/// Time for which a failure counts, microseconds.
const WINDOW_US: i64 = 300_000_000;
/// Largest number of failures of one name within [`WINDOW_US`].
const PER_NAME: i64 = 5;
/// Largest number of failures of all names within [`WINDOW_US`]: above the typing errors of a shift, far below what
/// guessing needs.
const IN_ALL: i64 = 30;

impl Register {
    /// Returns the time for which a login as `name` must wait; `None` when it need not wait.
    pub(super) fn wait(&self, name: &str, now_us: i64) -> Result<Option<Duration>> {
        let own = self.binding(&digest(name), PER_NAME, now_us)?;
        let all = self.binding("%", IN_ALL, now_us)?;
        let until_us = own.max(all).map(|at_us| at_us + WINDOW_US - now_us);
        Ok(until_us.map(|it| Duration::from_micros(it.unsigned_abs())))
    }

    /// Returns the instant until which [`PER_NAME`] failures lock the login of `name`; `None` when nothing locks it.
    pub(super) fn locked_until_us(&self, name: &str, now_us: i64) -> Result<Option<i64>> {
        let binding = self.binding(&digest(name), PER_NAME, now_us)?;
        Ok(binding.map(|at_us| at_us + WINDOW_US))
    }

    /// Returns the instant of failure number `most`, counted from the newest; `None` when fewer failures count. `names`
    /// is the digest of a name, or `%` for all names.
    fn binding(&self, names: &str, most: i64, now_us: i64) -> Result<Option<i64>> {
        let sql = "SELECT at_us FROM failure WHERE name_sha256 LIKE ?1 AND at_us > ?2 AND at_us <= ?3 \
                   ORDER BY at_us DESC LIMIT 1 OFFSET ?4";
        let row = params![names, now_us - WINDOW_US, now_us, most - 1];
        let found = self.connection.query_row(sql, row, |row| row.get(0));
        found.optional().doing("counting wrong passwords")
    }

    /// Counts a wrong password of `name`.
    pub(super) fn failed(&self, name: &str, now_us: i64) -> Result<()> {
        const DOING: &str = "noting a wrong password";
        let execute = |sql, row: &[&dyn rusqlite::ToSql]| self.connection.execute(sql, row);
        let past = now_us - WINDOW_US;
        execute("DELETE FROM failure WHERE at_us <= ?1", params![past]).doing(DOING)?;
        let row = params![digest(name), now_us];
        execute("INSERT INTO failure VALUES (?1, ?2)", row).doing(DOING)?;
        Ok(())
    }

    /// Forgets the failures of `name`.
    pub(super) fn forgive(&self, name: &str) -> Result<()> {
        let sql = "DELETE FROM failure WHERE name_sha256 = ?1";
        let deleted = self.connection.execute(sql, [digest(name)]);
        deleted.doing("forgetting wrong passwords").map(drop)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::tests::fresh;
    use super::*;

    const SECOND_US: i64 = 1_000_000;

    #[test]
    fn the_sixth_try_waits_five_minutes_from_the_first() {
        let (register, _folder) = fresh();
        for number in 0..5 {
            assert_eq!(register.wait("li", number * SECOND_US).unwrap(), None);
            register.failed("li", number * SECOND_US).unwrap();
        }
        let later = 10 * SECOND_US;
        let wait = register.wait("li", later).unwrap();
        assert_eq!(wait, Some(Duration::from_secs(290)));
        assert_eq!(register.wait("wang", later).unwrap(), None);
        assert_eq!(register.wait("li", WINDOW_US).unwrap(), None);
    }

    #[test]
    fn thirty_failures_of_different_names_block_all_names() {
        let (register, _folder) = fresh();
        for number in 0..30 {
            register.failed(&number.to_string(), 0).unwrap();
        }
        let wait = register.wait("li", 0).unwrap();
        assert_eq!(wait, Some(Duration::from_secs(300)));
        assert_eq!(register.wait("li", WINDOW_US).unwrap(), None);
    }

    #[test]
    fn forgiveness_clears_its_own_name_only() {
        let (register, _folder) = fresh();
        for name in ["li", "wang"] {
            (0..5).for_each(|_| register.failed(name, 0).unwrap());
        }
        register.forgive("li").unwrap();
        assert_eq!(register.wait("li", 0).unwrap(), None);
        assert!(register.wait("wang", 0).unwrap().is_some());
    }
}
