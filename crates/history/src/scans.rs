//! Dropped scans: serial numbers that a person scanned for parts that did not arrive before the end of their run. An
//! alarm of the run names them, with the persons who scanned them.
//!
//! The audit of orders has every scan that the rig accepted. A scan is used when a part of the run has the scanned
//! serial number. Any other scan still waited in the queue, or its part was lost, when the run ended or was cut off.

use super::AlarmRecord;
use super::error::{Doing, Result};
use super::landing::insert_alarm;
use machine::handling::serial::readable;
use machine::station::catalogue::AlarmCode;
use machine::station::trouble::Alarm;
use rusqlite::{Connection, Transaction, params};
use texts::Lang;

/// Selects the scans that the rig accepted in a run, and the orders that took back the last scan, in order of time.
pub(super) const SCANS: &str =
    "SELECT what ->> 'order' = 'scan', what ->> 'serial', who FROM ordered
    WHERE run_id = ?1 AND refused IS NULL AND what ->> 'order' IN ('scan', 'unscan') ORDER BY id";

/// Selects the runs of a rig that were cut off and have no alarm about dropped scans.
const CUT_OFF: &str = "SELECT id FROM run WHERE closed_at_us IS NULL AND source = ?1
    AND NOT EXISTS (SELECT 1 FROM alarm WHERE run_id = run.id AND code = ?2)";

/// Raises the alarm about the scans that a run has left unused; does nothing when there are none.
pub(super) fn drop_left(tx: &Transaction<'_>, run: i64, at_us: i64) -> Result<()> {
    let left = left(tx, run).doing("looking for scans of a run")?;
    if left.is_empty() {
        return Ok(());
    }
    let alarm = Alarm::scans_dropped(&left);
    let record = AlarmRecord {
        lot: None,
        code: alarm.code.name(),
        line: None,
        text: alarm.text(Lang::En),
        args: alarm.args,
        raised_at_us: at_us,
        cleared_at_us: Some(at_us),
    };
    insert_alarm(tx, Some(run), &record)
}

/// Calls [`drop_left`] for every cut-off run of the real (`source` is `rig`) or the simulated rig (`simulated`).
pub(super) fn drop_cut_off(tx: &Transaction<'_>, source: &str, at_us: i64) -> Result<()> {
    let code = AlarmCode::ScansDropped.name();
    let runs: Vec<i64> = (tx.prepare(CUT_OFF))
        .and_then(|mut it| {
            it.query_map(params![source, code], |row| row.get(0))?
                .collect()
        })
        .doing("looking for runs that were cut off")?;
    runs.into_iter()
        .try_for_each(|run| drop_left(tx, run, at_us))
}

/// Returns serial number and person of each scan that the run has left unused, the oldest first.
fn left(connection: &Connection, run: i64) -> rusqlite::Result<Vec<(String, String)>> {
    let mut left: Vec<(String, String)> = Vec::new();
    let mut scans = connection.prepare(SCANS)?;
    let mut rows = scans.query([run])?;
    while let Some(row) = rows.next()? {
        if row.get(0)? {
            let text: String = row.get(1)?;
            let serial = readable(&text).unwrap_or(&text);
            left.push((serial.to_owned(), row.get(2)?));
        } else {
            left.pop();
        }
    }
    let mut parts =
        connection.prepare("SELECT serial FROM part WHERE run_id = ?1 AND serial IS NOT NULL")?;
    let mut rows = parts.query([run])?;
    while let Some(row) = rows.next()? {
        let serial: String = row.get(0)?;
        if let Some(at) = left.iter().position(|it| it.0 == serial) {
            left.remove(at);
        }
    }
    Ok(left)
}
