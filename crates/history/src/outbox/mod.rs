//! Rows on their way to databases that collect the histories of many rigs.
//!
//! - Triggers of schema 15 queue each new row, and each change of a row, once per target, in the transaction that
//!   writes the row. A history without targets queues nothing.
//! - [`Outbox::prepare`] gives the next batch a UUID and stores the UUID before the caller sends anything. A batch that
//!   may have arrived keeps its UUID until the target says whether it has that batch, so no batch is sent under two
//!   UUIDs. [`Outbox::prepare`] returns such a batch again, with half of the entries, so that a batch too long for the
//!   link gets through at last. The target drops rows that arrive a second time.
//! - [`Outbox::confirm`] moves the watermark and removes the queued entries. Call it after the target has committed.
//! - Retention deletes no run of which a target lacks rows.
//!
//! An outbox has a connection of its own and holds the lock of the file only while it notes UUIDs and watermarks, never
//! while it reads rows.

mod batch;
mod restart;
mod rows;

pub use batch::{
    Batch, CurveRow, EventRow, MeasurementRow, PartChange, PartRow, PartState, ReasonRow,
    RecipeRow, RunRow, SampleChoice, SampleRow,
};
pub use restart::Restart;

use super::error::{Doing, HistoryError, Result};
use super::open;
use rusqlite::{Connection, OptionalExtension, Transaction, TransactionBehavior, params};
use std::path::Path;

/// The queue of a history file.
#[derive(Debug)]
pub struct Outbox {
    connection: Connection,
}

/// What the history knows about a target, that is, a database to which it sends its rows.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Target {
    /// Row number in the table `target`.
    id: i64,
    /// UUID by which the target knows this file.
    pub identity: String,
    /// Number of batches that the target has confirmed.
    pub sent: i64,
    /// UUID of the last confirmed batch.
    pub confirmed: Option<String>,
    /// Last entry of the queue in the last confirmed batch.
    pub watermark: i64,
    /// UUID of a batch that was sent and may have arrived.
    pub pending: Option<String>,
}

/// Counts of the entries that a target still lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lag {
    /// Number of entries in the queue.
    pub entries: u64,
    /// Number of parts among the entries.
    pub parts: u64,
    /// Judgement of the oldest of these parts, microseconds since 1970 UTC.
    pub oldest_us: Option<i64>,
}

/// Returns a new UUID (version 4).
pub(super) fn uuid(connection: &Connection) -> rusqlite::Result<String> {
    connection.query_row(
        "SELECT lower(format('%s-%s-4%s-8%s-%s', hex(randomblob(4)), hex(randomblob(2)),
           substr(hex(randomblob(2)), 2), substr(hex(randomblob(2)), 2), hex(randomblob(6))))",
        [],
        |row| row.get(0),
    )
}

impl Outbox {
    /// Opens the queue of a history; creates the file if it is missing, migrates an older schema.
    ///
    /// # Errors
    /// Fails as [`Store::open`](super::Store::open) does.
    pub fn open(path: &Path) -> Result<Self> {
        Ok(Self {
            connection: open::writer(path)?,
        })
    }

    /// Returns the target with this URL. The first call registers it and queues every row of the file for it.
    ///
    /// # Errors
    /// Fails when the file cannot be read or written.
    pub fn target(&mut self, url: &str) -> Result<Target> {
        const DOING: &str = "registering a target";
        if let Some(known) = self.known(url)? {
            return Ok(known);
        }
        let tx = self.transaction().doing(DOING)?;
        let identity = uuid(&tx).doing(DOING)?;
        let inserted = tx.execute(
            "INSERT INTO target (url, identity) VALUES (?1, ?2) ON CONFLICT DO NOTHING",
            params![url, identity],
        );
        if inserted.doing(DOING)? == 1 {
            let id = tx.last_insert_rowid();
            restart::queue_all(&tx, id).doing(DOING)?;
        }
        tx.commit().doing(DOING)?;
        self.read(url)
    }

    /// Returns the target with this URL; `None` when the file has no such target.
    ///
    /// # Errors
    /// Fails when the file cannot be read.
    pub fn known(&self, url: &str) -> Result<Option<Target>> {
        read_target(&self.connection, url)
            .optional()
            .doing("reading a target")
    }

    /// Removes every target that is not in `urls`, with its queue, so that retention no longer waits for that target.
    /// Returns the removed URLs.
    ///
    /// # Errors
    /// Fails when the file cannot be written.
    pub fn forget_others(&mut self, urls: &[&str]) -> Result<Vec<String>> {
        const DOING: &str = "removing targets";
        let keep = serde_json::json!(urls);
        let tx = self.transaction().doing(DOING)?;
        let others = "SELECT id FROM target WHERE url NOT IN (SELECT value FROM json_each(?1))";
        let queue = format!("DELETE FROM outbox WHERE target_id IN ({others})");
        tx.execute(&queue, [&keep]).doing(DOING)?;
        let gone = tx
            .prepare(&format!(
                "DELETE FROM target WHERE id IN ({others}) RETURNING url"
            ))
            .and_then(|mut it| it.query_map([&keep], |row| row.get(0))?.collect())
            .doing(DOING)?;
        tx.commit().doing(DOING)?;
        Ok(gone)
    }

    /// Returns what the target lacks.
    ///
    /// # Errors
    /// Fails when the file cannot be read.
    pub fn lag(&self, target: &Target) -> Result<Lag> {
        self.connection
            .query_row(
                "SELECT count(*), coalesce(sum(kind = 'part'), 0), (SELECT part.judged_at_us FROM outbox AS first
                   JOIN part ON part.id = first.row_id WHERE first.target_id = ?1 AND first.kind = 'part'
                   ORDER BY first.id LIMIT 1)
                 FROM outbox WHERE target_id = ?1",
                [target.id],
                |row| {
                    Ok(Lag {
                        entries: row.get::<_, i64>(0)?.unsigned_abs(),
                        parts: row.get::<_, i64>(1)?.unsigned_abs(),
                        oldest_us: row.get(2)?,
                    })
                },
            )
            .doing("reading what a target lacks")
    }

    /// Returns the UUID of the last run of the file with the number of its parts, and the number of all parts.
    ///
    /// # Errors
    /// Fails when the file cannot be read.
    pub fn last_run(&self) -> Result<Option<(String, u64)>> {
        self.connection
            .query_row(
                "SELECT uuid, (SELECT count(*) FROM part WHERE run_id = run.id) FROM run ORDER BY id DESC LIMIT 1",
                [],
                |row| Ok((row.get(0)?, row.get::<_, i64>(1)?.unsigned_abs())),
            )
            .optional()
            .doing("reading the last run")
    }

    /// Returns true when the target has every row and no batch is under way; false for an unregistered target.
    ///
    /// # Errors
    /// Fails when the file cannot be read.
    pub fn is_sent(&self, url: &str) -> Result<bool> {
        const SENT: &str = "SELECT EXISTS (SELECT 1 FROM target WHERE url = ?1 AND pending IS NULL
              AND NOT EXISTS (SELECT 1 FROM outbox WHERE target_id = target.id))";
        self.connection
            .query_row(SENT, [url], |row| row.get(0))
            .doing("reading what a target lacks")
    }

    /// Returns the next batch, at most `entries` entries of the queue; `None` when the target lacks nothing. A batch
    /// that may have arrived comes again under its own UUID, with half of its entries.
    ///
    /// # Errors
    /// Fails when the file cannot be read or written.
    pub fn prepare(
        &mut self,
        url: &str,
        entries: u32,
        samples: SampleChoice,
    ) -> Result<Option<Batch>> {
        const DOING: &str = "preparing a batch";
        assert!(entries > 0, "a batch of nothing");
        let tx = self.transaction().doing(DOING)?;
        let target = read_target(&tx, url).doing(DOING)?;
        let Some((name, to)) = named(&tx, &target, entries).doing(DOING)? else {
            return Ok(None);
        };
        tx.commit().doing(DOING)?;
        // Reads without the lock of the file, so that the rig never waits for a large batch.
        let read = self.connection.transaction().doing(DOING)?;
        let batch = rows::batch(&read, (target.id, to), samples).doing(DOING)?;
        read.commit().doing(DOING)?;
        Ok(Some(Batch {
            uuid: name,
            number: target.sent + 1,
            to,
            ..batch
        }))
    }

    /// Notes that the target has committed the pending batch. Does nothing when another program that sends this file
    /// has noted the batch already.
    ///
    /// # Errors
    /// Fails when the file cannot be written, or when another program has begun another batch.
    pub fn confirm(&mut self, url: &str, batch: &str) -> Result<()> {
        const DOING: &str = "confirming a batch";
        let tx = self.transaction().doing(DOING)?;
        let target = read_target(&tx, url).doing(DOING)?;
        assert!(!batch.is_empty(), "a batch without a name");
        if target.confirmed.as_deref() == Some(batch) {
            return Ok(());
        }
        if target.pending.as_deref() != Some(batch) {
            return Err(HistoryError::OtherBatch {
                url: url.to_owned(),
            });
        }
        tx.execute(
            "DELETE FROM outbox WHERE target_id = ?1 AND id <= (SELECT pending_to FROM target WHERE id = ?1)",
            [target.id],
        )
        .doing(DOING)?;
        tx.execute(
            "UPDATE target SET sent = sent + 1, confirmed = pending, watermark = pending_to, pending = NULL,
               pending_to = NULL WHERE id = ?1",
            [target.id],
        )
        .doing(DOING)?;
        tx.commit().doing(DOING)
    }

    fn read(&self, url: &str) -> Result<Target> {
        read_target(&self.connection, url).doing("reading a target")
    }

    fn transaction(&mut self) -> rusqlite::Result<Transaction<'_>> {
        self.connection
            .transaction_with_behavior(TransactionBehavior::Immediate)
    }
}

fn read_target(connection: &Connection, url: &str) -> rusqlite::Result<Target> {
    connection
        .prepare_cached(
            "SELECT id, identity, sent, confirmed, watermark, pending FROM target WHERE url = ?1",
        )?
        .query_row([url], |row| {
            Ok(Target {
                id: row.get(0)?,
                identity: row.get(1)?,
                sent: row.get(2)?,
                confirmed: row.get(3)?,
                watermark: row.get(4)?,
                pending: row.get(5)?,
            })
        })
}

/// Returns UUID and last entry of the batch to send: the pending batch, cut to half, or a new one. Stores the batch as
/// pending.
fn named(
    tx: &Transaction<'_>,
    target: &Target,
    entries: u32,
) -> rusqlite::Result<Option<(String, i64)>> {
    const LAST: &str =
        "SELECT max(id) FROM (SELECT id FROM outbox WHERE target_id = ?1 ORDER BY id LIMIT ?2)";
    let (name, entries) = match &target.pending {
        Some(pending) => (pending.clone(), half(tx, target)?),
        None => (uuid(tx)?, i64::from(entries)),
    };
    let to: Option<i64> = tx.query_row(LAST, [target.id, entries], |row| row.get(0))?;
    let Some(to) = to else {
        return Ok(None);
    };
    tx.execute(
        "UPDATE target SET pending = ?2, pending_to = ?3 WHERE id = ?1",
        params![target.id, name, to],
    )?;
    Ok(Some((name, to)))
}

/// Returns half the number of entries in the pending batch, at least 1.
fn half(tx: &Transaction<'_>, target: &Target) -> rusqlite::Result<i64> {
    const COUNT: &str = "SELECT count(*) FROM outbox JOIN target ON target.id = target_id
        WHERE target_id = ?1 AND outbox.id <= pending_to";
    let entries: i64 = tx.query_row(COUNT, [target.id], |row| row.get(0))?;
    assert!(target.pending.is_some(), "half of no batch");
    Ok((entries / 2).max(1))
}
