//! Places of the parts that a run leaves inside the machine; the next run takes them over.

use super::Store;
use super::error::{Doing, Result};
use super::store::source;
use machine::handling::inside::Inside;
use machine::rig::bin::Bin;
use rusqlite::{OptionalExtension, Transaction, params};

/// Places that were occupied when last known, on the real or the simulated rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InsideRecord {
    /// True for the simulated rig.
    pub simulated: bool,
    /// Occupied places.
    pub inside: Inside,
}

pub(super) fn keep(tx: &Transaction<'_>, it: &InsideRecord) -> Result<()> {
    let Inside {
        pocket,
        nest,
        gripper,
        falling,
    } = it.inside;
    let kept = tx.execute(
        "INSERT OR REPLACE INTO inside (source, pocket, nest, gripper, falling) VALUES (?1, ?2, ?3, ?4, ?5)",
        params![source(it.simulated), pocket, nest, gripper, falling.as_ref().map(Bin::name)],
    )
    .doing("recording what is inside")?;
    assert_eq!(kept, 1, "one row for each rig");
    Ok(())
}

impl Store {
    /// Returns the places of the parts that the previous run left inside; none when there was no previous run.
    pub fn left_inside(&self, simulated: bool) -> Result<Inside> {
        let read = |row: &rusqlite::Row<'_>| {
            Ok(Inside {
                pocket: row.get(0)?,
                nest: row.get(1)?,
                gripper: row.get(2)?,
                falling: row
                    .get::<_, Option<String>>(3)?
                    .and_then(|bin| Bin::from_name(&bin)),
            })
        };
        let found = self.connection().query_row(
            "SELECT pocket, nest, gripper, falling FROM inside WHERE source = ?1",
            [source(simulated)],
            read,
        );
        let found = found.optional().doing("reading what was inside")?;
        Ok(found.unwrap_or_default())
    }
}
