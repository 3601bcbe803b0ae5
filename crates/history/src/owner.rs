//! The rig that a history belongs to. The first run marks the file; a run on a rig of the other kind is refused.

use super::error::{Doing, HistoryError, Result};
use super::store::source;
use super::{Archive, Filter, Store};
use rusqlite::{Connection, OptionalExtension};
use std::path::Path;

/// Marks the file as belonging to a real or to the simulated rig. Fails when the file belongs to the other kind.
pub(super) fn claim(connection: &Connection, path: &Path, simulated: bool) -> Result<()> {
    const DOING: &str = "marking the history with its rig";
    let mark = "INSERT INTO rig (id, source) VALUES (1, ?1) ON CONFLICT DO NOTHING";
    let marked = connection.execute(mark, [source(simulated)]).doing(DOING)?;
    match marked {
        0 => check(connection, path, simulated),
        _ => Ok(()),
    }
}

fn check(connection: &Connection, path: &Path, simulated: bool) -> Result<()> {
    let holds: Option<bool> = connection
        .query_row("SELECT source = 'simulated' FROM rig", [], |row| row.get(0))
        .optional()
        .doing("reading the rig of the history")?;
    match holds {
        Some(holds) if holds != simulated => Err(HistoryError::OtherRig {
            path: path.to_owned(),
            holds: name(holds),
            found: name(simulated),
        }),
        Some(_) | None => Ok(()),
    }
}

const fn name(simulated: bool) -> &'static str {
    match simulated {
        true => "the simulated rig",
        false => "a real rig",
    }
}

/// Checks, before anything moves, that a rig of this kind may write the file; a missing file belongs to no rig yet.
///
/// # Errors
/// Fails when the file belongs to a rig of the other kind, or is no history.
pub fn check_rig(path: &Path, simulated: bool) -> Result<()> {
    match path.exists() {
        true => check(Archive::open(path)?.source.file()?, path, simulated),
        false => Ok(()),
    }
}

impl Store {
    /// Marks the file as belonging to a real or to the simulated rig.
    ///
    /// # Errors
    /// Fails when the file belongs to the other kind.
    pub fn claim(&mut self, simulated: bool) -> Result<()> {
        claim(self.connection(), &self.path, simulated)
    }
}

impl Archive {
    /// Returns true when one of the selected runs (lot, recipe, run) was on the simulated rig.
    pub fn is_simulated(&self, filter: &Filter) -> Result<bool> {
        let mut runs = filter.runs();
        runs.sql.push_str(" AND run.source = 'simulated'");
        runs.exists(&self.source)
            .doing("looking for simulated runs")
    }
}
