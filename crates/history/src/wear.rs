//! How often what wears was used since it was replaced.

use super::error::{Doing, Result};
use super::store::source;
use super::{Archive, Moment, Store};
use rusqlite::{Connection, Transaction, params};
use serde::Serialize;

/// So many uses more.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WearRecord {
    /// Of the simulated rig.
    pub simulated: bool,
    /// What wears.
    pub name: String,
    /// Uses since the record before.
    pub more: u64,
}

/// A counter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Wear {
    /// What wears.
    pub name: String,
    /// Uses since it was replaced.
    pub count: u64,
    /// When it was replaced last.
    pub replaced: Option<Moment>,
    /// Who did it.
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
    /// Every counter of the rig or of the simulated one.
    pub fn wear(&self, simulated: bool) -> Result<Vec<Wear>> {
        read(&self.connection, simulated)
    }
}

impl Store {
    /// Every counter of the rig or of the simulated one.
    pub fn wear(&self, simulated: bool) -> Result<Vec<Wear>> {
        read(self.connection(), simulated)
    }

    /// `name` was replaced: its counter begins anew. False when it has none.
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
