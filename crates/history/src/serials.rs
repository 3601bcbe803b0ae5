//! Reads the serial numbers of the parts of a lot.

use super::Store;
use super::error::{Doing, Result};
use std::collections::BTreeSet;

const DOING: &str = "reading the serial numbers of a lot";

impl Store {
    /// Returns how many serial numbers the rig has given to the parts of a lot: the sum, over its runs, of the number
    /// of the last part.
    pub fn parts_numbered(&self, lot: &str) -> Result<u64> {
        let sql = "SELECT ifnull(sum(last), 0) FROM (
              SELECT max(part.seq) AS last FROM part
                JOIN run ON run.id = part.run_id JOIN lot ON lot.id = run.lot_id
              WHERE lot.name = ?1 AND part.kind = 'lot' GROUP BY run.id)";
        let number = |row: &rusqlite::Row<'_>| row.get::<_, i64>(0);
        let given = self
            .connection()
            .query_row(sql, [lot], number)
            .doing(DOING)?;
        Ok(given.unsigned_abs())
    }

    /// Returns the serial numbers of the parts of a lot that passed or failed.
    pub fn serials(&self, lot: &str) -> Result<BTreeSet<String>> {
        let sql = "SELECT part.serial FROM part
              JOIN run ON run.id = part.run_id JOIN lot ON lot.id = run.lot_id
            WHERE lot.name = ?1 AND part.kind = 'lot' AND part.serial IS NOT NULL
              AND part.verdict IN ('pass', 'fail')";
        let mut statement = self.connection().prepare(sql).doing(DOING)?;
        let serials = statement.query_map([lot], |row| row.get(0));
        serials.and_then(Iterator::collect).doing(DOING)
    }
}
