//! Refills the queue of a target (a fleet database): when the target is new, when it has lost rows, or when this history
//! replaces another history of the same rig.

use super::{Outbox, read_target, uuid};
use crate::error::{Doing, Result};
use rusqlite::{Transaction, params};

/// How to fill the queue of a target anew.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Restart {
    /// Queues every row again; the target keeps what it has. `last` is the target's last batch of this file: its number
    /// and its UUID.
    Again {
        /// Number and UUID; `None` when the target has no batch of this file.
        last: Option<(i64, String)>,
    },
    /// Continues as a new history of the rig and queues the runs that the target lacks.
    TakeOver {
        /// UUID of every run of the rig that the target has.
        known: Vec<String>,
        /// Rows outside of runs are queued when they are younger than this instant, microseconds since 1970 UTC.
        since_us: i64,
    },
}

/// Kind of the entries, table, column with the row number of an entry, expression for the run of a row (NULL outside
/// of runs), and expression for the time of a row outside of runs.
const QUEUED: [[&str; 5]; 13] = [
    ["run", "run", "id", "id", "0"],
    ["run_state", "run", "id", "id", "0"],
    ["part", "part", "id", "run_id", "0"],
    ["retest", "retest", "run_id", "run_id", "0"],
    ["run_end", "run_end", "run_id", "run_id", "0"],
    ["alarm", "alarm", "id", "run_id", "raised_at_us"],
    [
        "alarm_state",
        "alarm_state",
        "alarm_id",
        "(SELECT run_id FROM alarm WHERE id = alarm_id)",
        "(SELECT raised_at_us FROM alarm WHERE id = alarm_id)",
    ],
    ["lot_state", "lot_state", "lot_id", "NULL", "since_us"],
    ["golden_check", "golden_check", "id", "run_id", "0"],
    ["ordered", "ordered", "id", "run_id", "at_us"],
    ["reopening", "reopening", "id", "NULL", "at_us"],
    [
        "external_result",
        "external_result",
        "id",
        "NULL",
        "entered_at_us",
    ],
    ["calibration", "calibration", "id", "NULL", "made_at_us"],
];

/// Queues every row of the file for a target.
pub(super) fn queue_all(tx: &Transaction<'_>, target: i64) -> rusqlite::Result<()> {
    queue(tx, target, (&[], i64::MIN))
}

/// Queues the rows of runs that are not `known`, and rows outside of runs that are younger than `since_us`.
fn queue(
    tx: &Transaction<'_>,
    target: i64,
    (known, since_us): (&[String], i64),
) -> rusqlite::Result<()> {
    let known = serde_json::json!(known);
    for [kind, table, key, run, time] in QUEUED {
        let sql = format!(
            "INSERT INTO outbox (target_id, kind, row_id) SELECT ?1, '{kind}', t.{key} FROM (
               SELECT *, {run} AS run_of, {time} AS time_of FROM {table}) AS t
             WHERE iif(run_of IS NULL, time_of > ?3, run_of NOT IN (SELECT id FROM run
               WHERE uuid IN (SELECT value FROM json_each(?2)))) ORDER BY t.{key}"
        );
        tx.execute(&sql, params![target, known, since_us])?;
    }
    Ok(())
}

impl Outbox {
    /// Fills the queue of a target anew.
    ///
    /// # Errors
    /// Fails when the file cannot be written; then the queue is as it was.
    pub fn restart(&mut self, url: &str, how: &Restart) -> Result<()> {
        const DOING: &str = "filling a queue anew";
        let tx = self.transaction().doing(DOING)?;
        let target = read_target(&tx, url).doing(DOING)?;
        let emptied = tx.execute("DELETE FROM outbox WHERE target_id = ?1", [target.id]);
        emptied.doing(DOING)?;
        let (identity, sent, confirmed) = match how {
            Restart::Again { last } => {
                queue_all(&tx, target.id).doing(DOING)?;
                let last = last.clone();
                let (sent, confirmed) = last.map_or((0, None), |(n, batch)| (n, Some(batch)));
                (target.identity, sent, confirmed)
            }
            Restart::TakeOver { known, since_us } => {
                queue(&tx, target.id, (known, *since_us)).doing(DOING)?;
                (uuid(&tx).doing(DOING)?, 0, None)
            }
        };
        let begun = tx.execute(
            "UPDATE target SET identity = ?2, sent = ?3, confirmed = ?4, watermark = 0, pending = NULL,
               pending_to = NULL WHERE id = ?1",
            params![target.id, identity, sent, confirmed],
        );
        assert_eq!(begun.doing(DOING)?, 1, "a target without its row");
        tx.commit().doing(DOING)
    }
}
