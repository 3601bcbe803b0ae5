//! Writes how a run ended, with the cause when trouble ended it. `app/src/lot/journal.rs` makes the record.

use super::error::{Doing, Result};
use super::store::RowIds;
use machine::station::turn::Ending;
use rusqlite::{Transaction, params};

/// How the open run of a lot ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunEndRecord {
    /// Name of the lot.
    pub lot: String,
    /// Complete, stopped, or ended by an alarm.
    pub ended: Ending,
    /// Code and English text of the trouble that ended the run, if any.
    pub cause: Option<(String, String)>,
}

/// Stores how a run ended; replaces an earlier record of the same run.
pub(super) fn insert(tx: &Transaction<'_>, row_ids: &RowIds, it: &RunEndRecord) -> Result<()> {
    assert!(
        it.cause.is_none() || it.ended == Ending::Alarm,
        "trouble of a run that ended well"
    );
    let (cause, text) = it.cause.as_ref().map(|it| (&it.0, &it.1)).unzip();
    tx.execute(
        "INSERT OR REPLACE INTO run_end (run_id, ended, cause, cause_text) VALUES (?1, ?2, ?3, ?4)",
        params![row_ids.run(&it.lot)?, it.ended.name(), cause, text],
    )
    .doing("recording the end of a run")?;
    Ok(())
}
