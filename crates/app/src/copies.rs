//! Copies the history while a rig uses it, and deletes old runs. The history notes every copy, because `prune` deletes
//! a run only after the whole run was copied.

use history::{Archive, Filter, HistoryError, Pruned, Store};
use std::fs::File;
use std::path::Path;

/// A day, microseconds.
const DAY_US: i64 = 86_400_000_000;

/// Copies the history into a new file and returns its size in bytes.
///
/// # Errors
/// Fails when `file` exists, cannot be written, or differs from the history after the copy.
pub fn backup(db: &Path, file: &Path) -> anyhow::Result<u64> {
    let bytes = Archive::open(db)?.backup(file)?;
    note(db, &Filter::default(), file)?;
    Ok(bytes)
}

/// Notes in the history that an export was written, if its filter selects whole runs.
///
/// # Errors
/// Fails when the file cannot be flushed to the disk, or the history cannot be written.
pub fn exported(db: &Path, filter: &Filter, file: &Path) -> anyhow::Result<()> {
    if !filter.takes_whole_runs() {
        return Ok(());
    }
    File::open(file)?.sync_all()?;
    note(db, filter, file)
}

fn note(db: &Path, filter: &Filter, file: &Path) -> anyhow::Result<()> {
    let mut store = Store::open(db)?;
    let file = std::path::absolute(file)?;
    let now_us = jiff::Timestamp::now().as_microsecond();
    store.record_export(filter, &file.to_string_lossy(), now_us)?;
    Ok(())
}

/// Runs of a history that were copied whole and ended at least a given number of days ago.
pub struct OldRuns {
    store: Store,
    now_us: i64,
    before_us: i64,
}

impl OldRuns {
    /// Selects the runs that ended at least `days` days before now.
    ///
    /// # Errors
    /// Fails when there is no history at `db`, or when it cannot be opened.
    pub fn open(db: &Path, days: u32) -> anyhow::Result<Self> {
        anyhow::ensure!(db.exists(), "no history at {}", db.display());
        let now_us = jiff::Timestamp::now().as_microsecond();
        Ok(Self {
            store: Store::open(db)?,
            now_us,
            before_us: now_us - DAY_US * i64::from(days),
        })
    }

    /// Returns the runs, oldest first.
    ///
    /// # Errors
    /// Fails when the history cannot be read.
    pub fn list(&self) -> Result<Vec<Pruned>, HistoryError> {
        self.store.prunable(self.before_us)
    }

    /// Deletes the parts of the runs and calls `each` after every run.
    ///
    /// # Errors
    /// Fails when the history cannot be written; runs that are deleted already stay deleted.
    pub fn delete(mut self, mut each: impl FnMut()) -> Result<(), HistoryError> {
        self.store.prune(self.before_us, self.now_us, |_| each())
    }
}
