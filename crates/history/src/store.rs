//! The writer of the history: opens runs of lots, records batches of rows, closes runs.
//!
//! A batch is one transaction and, unless the store trusts the power, one disk flush. A rig records each part alone; an import records hundreds at once.

use super::error::{Doing, HistoryError, Result};
use super::{
    CalibratedRecord, CalibrationRecord, LotRecord, PartRecord, Row, alarm_states, batches, gates,
    insert, inside, landing, open, orders, owner, reopening, run_end, scans, series, wear,
};
use rusqlite::{Connection, OptionalExtension, Transaction, TransactionBehavior, params};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Name and version of this program; every run stores them and every printed page shows them.
pub(crate) const PROGRAM: &str = concat!("relayrig ", env!("CARGO_PKG_VERSION"));

/// The writer of a history file. A call blocks for at most about one disk flush.
#[derive(Debug)]
pub struct Store {
    connection: Connection,
    /// Path of the file, for messages.
    pub(super) path: PathBuf,
    row_ids: RowIds,
}

/// Row numbers kept in memory, so that they need no query.
#[derive(Debug, Default)]
pub(super) struct RowIds {
    /// Row number of the open run, by name of the lot.
    pub runs: HashMap<String, i64>,
    /// Row number of each parameter, by key.
    pub parameters: HashMap<String, i64>,
}

impl RowIds {
    /// Returns the row number of the open run of `lot`; fails when this writer has opened none.
    pub fn run(&self, lot: &str) -> Result<i64> {
        let missing = || HistoryError::LotNotOpen {
            lot: lot.to_owned(),
        };
        self.runs.get(lot).copied().ok_or_else(missing)
    }
}

impl Store {
    /// Opens a file; creates it if it is missing, migrates an older schema. Fails on a file of another program, and on
    /// a schema newer than [`SCHEMA`](super::SCHEMA).
    pub fn open(path: &Path) -> Result<Self> {
        Ok(Self {
            connection: open::writer(path)?,
            path: path.to_owned(),
            row_ids: RowIds::default(),
        })
    }

    /// Opens a run of the lot and returns its number within the lot, from 1.
    pub fn begin_lot(&mut self, lot: &LotRecord) -> Result<u32> {
        const DOING: &str = "opening the lot";
        let path = self.path.clone();
        let transaction = self.transaction(DOING)?;
        let (run, number) = begin(&transaction, &path, lot)?;
        transaction.commit().doing(DOING)?;
        let before = self.row_ids.runs.insert(lot.lot.clone(), run);
        assert_ne!(before, Some(run), "one row for two runs");
        assert!(number >= 1, "the first run has number 1");
        Ok(number)
    }

    /// Opens a run, records `parts` of its lot and closes the run, all in one transaction. Returns the number of the
    /// run.
    pub fn import(&mut self, lot: &LotRecord, parts: Vec<PartRecord>) -> Result<u32> {
        const DOING: &str = "importing";
        let own = parts.iter().all(|part| part.lot == lot.lot);
        assert!(own, "a part of another lot");
        let transaction = self.transaction(DOING)?;
        let (run, number) = insert::run(&transaction, lot, "import").doing(DOING)?;
        let mut row_ids = RowIds::default();
        row_ids.runs.insert(lot.lot.clone(), run);
        for part in &parts {
            insert::part(&transaction, &mut row_ids, part)?;
        }
        transaction
            .execute(
                "UPDATE run SET closed_at_us = opened_at_us WHERE id = ?1",
                [run],
            )
            .doing(DOING)?;
        series::pack(&transaction, run).doing(DOING)?;
        transaction.commit().doing(DOING)?;
        Ok(number)
    }

    /// From now on acknowledges a batch before the disk has it: batches survive the end of the program, but a power loss
    /// may take the last ones. The file stays whole.
    pub fn trust_the_power(&mut self) -> Result<()> {
        let relaxed = self.connection.pragma_update(None, "synchronous", "NORMAL");
        relaxed.doing("preparing the history")
    }

    /// Closes the run of the lot, packs its values and drops the scans of parts that never arrived; later rows for the
    /// run are refused. After an error the run is still open.
    pub fn close_lot(&mut self, lot: &str, at_us: i64) -> Result<()> {
        const DOING: &str = "closing the lot";
        let run = self.row_ids.run(lot)?;
        let transaction = self.transaction(DOING)?;
        let closed = "UPDATE run SET closed_at_us = ?2 WHERE id = ?1";
        let changed = transaction
            .execute(closed, params![run, at_us])
            .doing(DOING)?;
        assert_eq!(changed, 1, "an open run without its row");
        series::pack(&transaction, run).doing(DOING)?;
        scans::drop_left(&transaction, run, at_us)?;
        transaction.commit().doing(DOING)?;
        self.row_ids.runs.remove(lot);
        assert!(self.row_ids.run(lot).is_err(), "a closed run gets rows");
        Ok(())
    }

    /// Writes a batch in one transaction; on an error no row of it is written.
    ///
    /// A part or landing that equals its row is skipped, so after an error that leaves open whether the batch was
    /// written the caller may send it again. A part that differs from its row is refused.
    pub fn record(&mut self, rows: &[Row]) -> Result<()> {
        const DOING: &str = "recording";
        let Self {
            connection,
            path,
            row_ids,
            ..
        } = self;
        let transaction = connection
            .transaction_with_behavior(TransactionBehavior::Immediate)
            .doing(DOING)?;
        let (parameters, runs) = (row_ids.parameters.len(), row_ids.runs.clone());
        let written = write(&transaction, (path, row_ids), rows)
            .and_then(|()| transaction.commit().doing(DOING));
        if written.is_err() {
            row_ids.runs = runs;
            if row_ids.parameters.len() != parameters {
                row_ids.parameters.clear();
            }
        }
        let is_over = connection.is_autocommit();
        assert!(written.is_err() || is_over, "a batch is left open");
        written
    }

    /// Stores a calibration; if it is stored already, only updates `verified`.
    pub fn save_calibration(&mut self, calibration: &CalibrationRecord) -> Result<()> {
        save(&self.connection, calibration)
    }

    /// Returns the calibration that was stored last for one coil voltage, expired or not, of the real or the simulated
    /// rig. After the clock was set back, this may not be the calibration with the latest date.
    pub fn latest_calibration_of(
        &self,
        simulated: bool,
        nominal_v: f64,
    ) -> Result<Option<CalibrationRecord>> {
        self.connection
            .query_row(
                "SELECT made_at_us, due_at_us, hash, body, verified FROM calibration
                 WHERE body ->> 'simulated' = ?1 AND body ->> 'nominal_v' = ?2
                 ORDER BY id DESC LIMIT 1",
                params![simulated, nominal_v],
                calibration,
            )
            .optional()
            .doing("reading the latest calibration of a kind")
    }

    pub(super) fn connection(&self) -> &Connection {
        &self.connection
    }

    pub(super) fn transaction(&mut self, doing: &'static str) -> Result<Transaction<'_>> {
        self.connection
            .transaction_with_behavior(TransactionBehavior::Immediate)
            .doing(doing)
    }
}

/// Returns the text that the column `source` holds for a rig.
pub(super) const fn source(simulated: bool) -> &'static str {
    if simulated { "simulated" } else { "rig" }
}

/// Opens a run; returns its row and its number within the lot.
fn begin(tx: &Transaction<'_>, path: &Path, lot: &LotRecord) -> Result<(i64, u32)> {
    owner::claim(tx, path, lot.simulated)?;
    insert::run(tx, lot, source(lot.simulated)).doing("opening the lot")
}

fn save(connection: &Connection, calibration: &CalibrationRecord) -> Result<()> {
    let CalibrationRecord {
        made_at_us,
        due_at_us,
        hash,
        body,
        verified,
    } = calibration;
    assert!(made_at_us <= due_at_us, "due before it was made");
    assert!(!hash.is_empty(), "a calibration without its name");
    connection
        .execute(
            "INSERT INTO calibration (made_at_us, due_at_us, hash, body, verified)
             VALUES (?1, ?2, ?3, ?4, ?5)
             ON CONFLICT (hash, made_at_us) DO UPDATE SET verified = excluded.verified",
            params![made_at_us, due_at_us, hash, body, verified],
        )
        .doing("saving the calibration")?;
    Ok(())
}

/// Saves a calibration that the open run of the lot uses from now on.
fn calibrated(tx: &Transaction<'_>, row_ids: &RowIds, it: &CalibratedRecord) -> Result<()> {
    save(tx, &it.calibration)?;
    let freeze = "UPDATE run SET calibration_hash = ?2 WHERE id = ?1";
    let run = row_ids.run(&it.lot)?;
    let changed = tx.execute(freeze, params![run, it.calibration.hash]);
    let changed = changed.doing("freezing the calibration of a run")?;
    assert_eq!(changed, 1, "an open run without its row");
    Ok(())
}

fn write(
    transaction: &Transaction<'_>,
    (path, row_ids): (&Path, &mut RowIds),
    rows: &[Row],
) -> Result<()> {
    rows.iter().try_for_each(|row| match row {
        Row::Run(lot) => {
            let (run, _) = begin(transaction, path, lot)?;
            row_ids.runs.insert(lot.lot.clone(), run);
            Ok(())
        }
        Row::Calibrated(it) => calibrated(transaction, row_ids, it),
        Row::Part(part) => insert::part(transaction, row_ids, part),
        Row::Batch(it) => batches::insert(transaction, row_ids, it),
        Row::Interrupted(it) => landing::interrupted(transaction, row_ids, it),
        Row::Landed(landed) => landing::landing(transaction, row_ids, landed),
        Row::Alarm(alarm) => landing::alarm(transaction, row_ids, alarm),
        Row::AlarmChange(it) => alarm_states::change(transaction, it),
        Row::RunEnded(it) => run_end::insert(transaction, row_ids, it),
        Row::LotState(it) => gates::state(transaction, it)
            .map(|_| ())
            .doing("recording the state of a lot"),
        Row::Reopened(it) => reopening::insert(transaction, it),
        Row::ReferenceCheck(it) => gates::reference_check(transaction, row_ids, it),
        Row::Order(it) => orders::insert(transaction, row_ids, it),
        Row::Wear(it) => wear::add(transaction, it),
        Row::Inside(it) => inside::keep(transaction, it),
    })
}

pub(super) fn calibration(row: &rusqlite::Row<'_>) -> rusqlite::Result<CalibrationRecord> {
    Ok(CalibrationRecord {
        made_at_us: row.get(0)?,
        due_at_us: row.get(1)?,
        hash: row.get(2)?,
        body: row.get(3)?,
        verified: row.get(4)?,
    })
}

#[cfg(test)]
impl Store {
    /// Records that the beam of `bin` saw production part `seq`.
    pub(super) fn landed(
        &mut self,
        lot: &str,
        seq: u64,
        bin: &str,
        at_us: i64,
        cycle_s: Option<f64>,
    ) -> Result<()> {
        self.record(&[Row::Landed(super::LandingRecord {
            lot: lot.to_owned(),
            kind: "lot".to_owned(),
            seq,
            bin: bin.to_owned(),
            at_us,
            cycle_s,
        })])
    }

    /// Records an alarm, or its clearing when `cleared_at_us` is set.
    pub(super) fn alarm(&mut self, alarm: &super::AlarmRecord) -> Result<()> {
        self.record(&[Row::Alarm(alarm.clone())])
    }
    /// Makes every later access to a locked file fail at once.
    pub(super) fn impatient(&self) {
        self.connection
            .busy_timeout(std::time::Duration::ZERO)
            .expect("a time-out can be set");
    }
    /// Makes every later write fail, or none.
    pub(super) fn read_only(&self, on: bool) {
        self.connection
            .pragma_update(None, "query_only", on)
            .expect("a file can be kept from being written");
    }
    /// Makes every later write fail that would enlarge the file.
    pub(super) fn forbid_growth(&self) {
        let pages: i64 = self
            .connection
            .pragma_query_value(None, "page_count", |row| row.get(0))
            .expect("an open file has a size");
        self.connection
            .pragma_update_and_check(None, "max_page_count", pages, |_| Ok(()))
            .expect("a file can be kept from growing");
    }
    /// Returns the value of a pragma as text.
    pub(super) fn pragma(&self, name: &str) -> String {
        let read = |row: &rusqlite::Row<'_>| row.get::<_, rusqlite::types::Value>(0);
        match self.connection.pragma_query_value(None, name, read) {
            Ok(rusqlite::types::Value::Integer(number)) => number.to_string(),
            Ok(rusqlite::types::Value::Text(text)) => text,
            other => format!("{other:?}"),
        }
    }
    /// Writes in a transaction that is never committed, then closes the file.
    pub(super) fn begin_and_forget(self) {
        self.connection
            .execute_batch("BEGIN IMMEDIATE; UPDATE part SET verdict = 'void'; DELETE FROM sample;")
            .expect("an open file can be written");
    }
}
