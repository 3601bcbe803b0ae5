//! Retention: deletes the parts of runs that were copied whole.
//!
//! - Backup and export call [`Store::record_export`] once their file is on the disk. Only closed runs count as copied.
//! - [`Store::prune`] deletes parts, reasons, measurements, raw replies, curves, batches and alarms of copied runs that
//!   ended before a given instant, one transaction per run. It skips runs of which a target of the
//!   [outbox](super::outbox) still lacks rows. Lot, run, recipe and the note of the copy stay: run numbers
//!   continue, and the note names the file that holds the parts.

use super::error::{Doing, Result};
use super::{Filter, Store};
use rusqlite::{Transaction, params, params_from_iter};
use serde::Serialize;

/// A run whose parts [`Store::prune`] has deleted or would delete.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Pruned {
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// Number of deleted parts, tests of reference parts included.
    pub parts: u64,
    /// File that holds the copy of the run.
    pub file: String,
}

impl Store {
    /// Notes that `file` holds the closed runs that lot, run and recipe of the filter select. Returns their number.
    pub fn record_export(&mut self, filter: &Filter, file: &str, at_us: i64) -> Result<u64> {
        const DOING: &str = "noting a copy";
        let runs = filter.runs();
        let sql = format!(
            "INSERT INTO export (run_id, at_us, file, parts)
             SELECT run.id, ?, ?, (SELECT count(*) FROM part WHERE part.run_id = run.id)
             FROM run WHERE run.closed_at_us IS NOT NULL AND run.id IN ({})
             ON CONFLICT (run_id) DO UPDATE SET at_us = excluded.at_us, file = excluded.file
             WHERE pruned_at_us IS NULL",
            runs.sql
        );
        let mut values = vec![at_us.into(), file.to_owned().into()];
        values.extend(runs.values);
        let transaction = self.transaction(DOING)?;
        let noted = transaction
            .execute(&sql, params_from_iter(&values))
            .doing(DOING)?;
        transaction.commit().doing(DOING)?;
        Ok(noted as u64)
    }

    /// Returns the runs whose parts [`Store::prune`] would delete, oldest first.
    pub fn prunable(&self, closed_before_us: i64) -> Result<Vec<Pruned>> {
        let found = self
            .prunable_rows(closed_before_us)
            .doing("looking for old runs")?;
        Ok(found.into_iter().map(|(_, run)| run).collect())
    }

    /// Deletes the parts of copied runs that ended before the given instant, and calls `each` after every run.
    pub fn prune(
        &mut self,
        closed_before_us: i64,
        now_us: i64,
        mut each: impl FnMut(&Pruned),
    ) -> Result<()> {
        const DOING: &str = "pruning a run";
        for (id, run) in self.prunable_rows(closed_before_us).doing(DOING)? {
            let transaction = self.transaction(DOING)?;
            empty_run(&transaction, id, now_us).doing(DOING)?;
            transaction.commit().doing(DOING)?;
            each(&run);
        }
        Ok(())
    }

    fn prunable_rows(&self, closed_before_us: i64) -> rusqlite::Result<Vec<(i64, Pruned)>> {
        let mut statement = self.connection().prepare(
            "SELECT run.id, lot.name, run.number, export.parts, export.file
             FROM export JOIN run ON run.id = export.run_id JOIN lot ON lot.id = run.lot_id
             WHERE export.pruned_at_us IS NULL AND run.closed_at_us < ?1
               AND NOT EXISTS (SELECT 1 FROM outbox WHERE kind = 'run' AND row_id = run.id)
               AND NOT EXISTS (SELECT 1 FROM part JOIN outbox ON outbox.row_id = part.id
                 WHERE part.run_id = run.id AND outbox.kind IN ('part', 'part_change'))
               AND NOT EXISTS (SELECT 1 FROM alarm JOIN outbox ON outbox.row_id = alarm.id
                 WHERE alarm.run_id = run.id AND outbox.kind IN ('alarm', 'alarm_state'))
             ORDER BY run.closed_at_us, run.id",
        )?;
        let rows = statement.query_map([closed_before_us], |row| {
            let run = Pruned {
                lot: row.get(1)?,
                run: row.get(2)?,
                parts: row.get::<_, i64>(3)?.unsigned_abs(),
                file: row.get(4)?,
            };
            Ok((row.get(0)?, run))
        })?;
        rows.collect()
    }
}

/// Statements that delete the rows of a run; a table that refers to another comes first.
pub(super) const EMPTYING: [&str; 10] = [
    "DELETE FROM batch_curve WHERE batch_id IN (SELECT id FROM batch WHERE run_id = ?1)",
    "DELETE FROM batch WHERE run_id = ?1",
    "DELETE FROM series WHERE run_id = ?1",
    "DELETE FROM curve WHERE part_id IN (SELECT id FROM part WHERE run_id = ?1)",
    "DELETE FROM sample WHERE part_id IN (SELECT id FROM part WHERE run_id = ?1)",
    "DELETE FROM measurement WHERE part_id IN (SELECT id FROM part WHERE run_id = ?1)",
    "DELETE FROM reason WHERE part_id IN (SELECT id FROM part WHERE run_id = ?1)",
    "DELETE FROM part WHERE run_id = ?1",
    "DELETE FROM alarm_state WHERE alarm_id IN (SELECT id FROM alarm WHERE run_id = ?1)",
    "DELETE FROM alarm WHERE run_id = ?1",
];

/// Notes the highest row numbers before rows are deleted, so that no later row gets a number that a target knows.
const FLOOR: &str = "INSERT INTO row_floor (name, last)
    SELECT name, last FROM (SELECT 'part' AS name, max(id) AS last FROM part
      UNION ALL SELECT 'alarm', max(id) FROM alarm) WHERE last IS NOT NULL
    ON CONFLICT (name) DO UPDATE SET last = max(last, excluded.last)";

fn empty_run(transaction: &Transaction<'_>, run: i64, now_us: i64) -> rusqlite::Result<()> {
    transaction.execute(FLOOR, [])?;
    for sql in EMPTYING {
        transaction.execute(sql, [run])?;
    }
    let noted = transaction.execute(
        "UPDATE export SET pruned_at_us = ?2 WHERE run_id = ?1",
        params![run, now_us],
    )?;
    assert_eq!(noted, 1, "run {run} has no copy");
    Ok(())
}
