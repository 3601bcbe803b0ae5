//! Later additions to a row: where a part landed, that it was interrupted, when an alarm was cleared. Every function
//! here runs inside a transaction of [`Store`](super::Store).

use super::error::{Doing, HistoryError, Result};
use super::insert::signed;
use super::reasons;
use super::store::RowIds;
use super::{AlarmRecord, InterruptedRecord, LandingRecord};
use rusqlite::{OptionalExtension, Transaction, params};

/// Adds bin and time of the landing to the row of a part. Later calls change nothing, and fail when they name another
/// bin.
pub(super) fn landing(tx: &Transaction<'_>, row_ids: &RowIds, it: &LandingRecord) -> Result<()> {
    const DOING: &str = "recording a landing";
    let run = row_ids.run(&it.lot)?;
    let seq = signed("part", it.seq)?;
    assert!(!it.bin.is_empty(), "landed in no bin");
    let judged_at_us: Option<i64> = tx
        .prepare_cached(
            "UPDATE part SET landed_bin = ?4, landed_at_us = ?5, cycle_s = ifnull(?6, cycle_s)
             WHERE run_id = ?1 AND kind = ?2 AND seq = ?3 AND landed_bin IS NULL
             RETURNING judged_at_us",
        )
        .and_then(|mut statement| {
            let row = params![run, it.kind, seq, it.bin, it.at_us, it.cycle_s];
            statement.query_row(row, |row| row.get(0)).optional()
        })
        .doing(DOING)?;
    if let Some(judged_at_us) = judged_at_us {
        assert!(
            it.at_us >= judged_at_us,
            "part {seq} landed before its verdict"
        );
        return Ok(());
    }
    let first: Option<String> = tx
        .query_row(
            "SELECT landed_bin FROM part WHERE run_id = ?1 AND kind = ?2 AND seq = ?3",
            params![run, it.kind, seq],
            |row| row.get(0),
        )
        .optional()
        .doing(DOING)?;
    landed_before(it, first)
}

/// Makes a judged part void, assigns bin `retest` and adds the reason; does nothing the second time, and nothing after
/// the part has landed.
pub(super) fn interrupted(
    tx: &Transaction<'_>,
    row_ids: &RowIds,
    it: &InterruptedRecord,
) -> Result<()> {
    const DOING: &str = "recording an interruption";
    let run = row_ids.run(&it.lot)?;
    let seq = signed("part", it.seq)?;
    let voided: Option<(i64, i64)> = tx
        .query_row(
            "UPDATE part SET verdict = 'void', bin = 'retest',
               reasons = json_insert(reasons, '$[#]', ?4)
             WHERE run_id = ?1 AND kind = ?2 AND seq = ?3 AND landed_bin IS NULL
               AND NOT EXISTS (SELECT 1 FROM json_each(reasons) WHERE value = ?4)
             RETURNING id, json_array_length(reasons)",
            params![run, it.kind, seq, it.reason.to_string()],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )
        .optional()
        .doing(DOING)?;
    let Some((part, n)) = voided else {
        return Ok(());
    };
    assert!(n >= 1, "interrupted without a reason");
    let void = "UPDATE measurement SET part_verdict = 'void' WHERE part_id = ?1";
    tx.execute(void, [part])
        .and_then(|_| reasons::insert(tx, part, n, std::slice::from_ref(&it.reason)))
        .doing(DOING)
}

fn landed_before(it: &LandingRecord, first: Option<String>) -> Result<()> {
    let (lot, seq) = (it.lot.clone(), it.seq);
    match first {
        None => Err(HistoryError::NoSuchPart {
            lot,
            kind: it.kind.clone(),
            seq,
        }),
        Some(first) if first == it.bin => Ok(()),
        Some(first) => Err(HistoryError::LandedTwice {
            lot,
            seq,
            first,
            second: it.bin.clone(),
        }),
    }
}

/// Inserts an alarm; for an alarm that already has a row, adds only the time at which it was cleared.
pub(super) fn alarm(tx: &Transaction<'_>, row_ids: &RowIds, it: &AlarmRecord) -> Result<()> {
    let run = it.lot.as_deref().map(|lot| row_ids.run(lot)).transpose()?;
    insert_alarm(tx, run, it)
}

/// Inserts an alarm as [`alarm`] does, for the run with this row number; `None` for an alarm between runs.
pub(super) fn insert_alarm(tx: &Transaction<'_>, run: Option<i64>, it: &AlarmRecord) -> Result<()> {
    assert!(!it.code.is_empty(), "an alarm without a code");
    let cleared_after = it.cleared_at_us.is_none_or(|at| at >= it.raised_at_us);
    assert!(cleared_after, "{} went before it came", it.code);
    tx.prepare_cached(
        "INSERT INTO alarm (id, run_id, code, line, text, raised_at_us, cleared_at_us, args)
         VALUES (max(ifnull((SELECT max(id) FROM alarm), 0),
             ifnull((SELECT last FROM row_floor WHERE name = 'alarm'), 0)) + 1, ?1, ?2, ?3, ?4, ?5, ?6, ?7)
         ON CONFLICT (raised_at_us, code, ifnull(line, ''), ifnull(run_id, 0))
         DO UPDATE SET cleared_at_us = ifnull(cleared_at_us, excluded.cleared_at_us)",
    )
    .and_then(|mut statement| {
        statement.execute(params![
            run,
            it.code,
            it.line,
            it.text,
            it.raised_at_us,
            it.cleared_at_us,
            serde_json::json!(it.args)
        ])
    })
    .doing("recording an alarm")?;
    Ok(())
}
