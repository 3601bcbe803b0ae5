//! Use counts of wearing parts since they were last replaced.

use super::error::{Doing, Result};
use super::store::source;
use super::{Archive, Moment, Store};
use rusqlite::{Connection, Transaction, params};
use serde::Serialize;
use utoipa::ToSchema;

/// Increase of the use count of a wearing part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WearRecord {
    /// True on the simulated rig.
    pub simulated: bool,
    /// Name of the counter.
    pub name: String,
    /// Number of uses since the previous record, at least 1.
    pub more: u64,
}

/// The use count of a wearing part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Wear {
    /// Name of the counter.
    pub name: String,
    /// Number of uses since the last replacement.
    pub count: u64,
    /// Time of the last replacement, if any.
    pub replaced: Option<Moment>,
    /// Person who made the last replacement.
    pub replaced_by: Option<String>,
}

pub(super) fn add(tx: &Transaction<'_>, it: &WearRecord) -> Result<()> {
    assert!(it.more > 0, "no use of {} to add", it.name);
    tx.execute(
        "INSERT INTO wear (source, name, count) VALUES (?1, ?2, ?3)
         ON CONFLICT (source, name) DO UPDATE SET count = count + excluded.count",
        params![
            source(it.simulated),
            it.name,
            i64::try_from(it.more).unwrap_or(i64::MAX)
        ],
    )
    .doing("recording wear")?;
    Ok(())
}

fn read(connection: &Connection, simulated: bool) -> Result<Vec<Wear>> {
    let read = |row: &rusqlite::Row<'_>| {
        Ok(Wear {
            name: row.get(0)?,
            count: row.get::<_, i64>(1)?.unsigned_abs(),
            replaced: row.get::<_, Option<i64>>(2)?.map(Moment),
            replaced_by: row.get(3)?,
        })
    };
    connection
        .prepare(
            "SELECT name, count, replaced_at_us, replaced_by FROM wear WHERE source = ?1
             ORDER BY name",
        )
        .and_then(|mut it| it.query_map([source(simulated)], read)?.collect())
        .doing("reading wear")
}

impl Archive {
    /// Returns the use counts of all wearing parts of the real or the simulated rig.
    pub fn wear(&self, simulated: bool) -> Result<Vec<Wear>> {
        read(self.source.file()?, simulated)
    }
}

impl Store {
    /// Returns what [`Archive::wear`] returns, for a program that writes.
    pub fn wear(&self, simulated: bool) -> Result<Vec<Wear>> {
        read(self.connection(), simulated)
    }

    /// Sets the counter `name` to 0, because the part was replaced. Returns false when there is no such counter.
    pub fn replaced(&mut self, simulated: bool, name: &str, by: &str, at_us: i64) -> Result<bool> {
        self.connection()
            .execute(
                "UPDATE wear SET count = 0, replaced_at_us = ?3, replaced_by = ?4
                 WHERE source = ?1 AND name = ?2",
                params![source(simulated), name, at_us, by],
            )
            .map(|changed| changed == 1)
            .doing("recording a replacement")
    }
}
