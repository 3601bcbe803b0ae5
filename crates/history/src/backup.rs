//! Copies the history while it is in use, and checks its integrity. Writers continue during copy and check.

use super::Archive;
use super::error::{Doing, HistoryError, Result};
use super::open::with_end;
use std::fs::{self, File};
use std::path::Path;

const DOING: &str = "checking the history";

impl Archive {
    /// Copies the present state of the history to `target`, which must not exist. The copy is checked before it gets
    /// this name. Returns the size of the copy in bytes.
    pub fn backup(&self, target: &Path) -> Result<u64> {
        if target.exists() {
            return Err(HistoryError::Exists {
                path: target.to_owned(),
            });
        }
        let partial = with_end(target, ".partial");
        let copied = self.copy(&partial, target);
        if copied.is_err() && partial.exists() {
            // The first error is returned; a failed clean-up matters less.
            let _ = fs::remove_file(&partial);
        }
        copied
    }

    fn copy(&self, partial: &Path, target: &Path) -> Result<u64> {
        let place = |source| HistoryError::Place {
            path: target.to_owned(),
            source,
        };
        if partial.exists() {
            fs::remove_file(partial).map_err(place)?;
        }
        // A reader's connection is query-only; the statement that writes the copy is the one exception.
        self.source
            .file()?
            .pragma_update(None, "query_only", false)
            .doing("copying the history")?;
        let name = partial.to_string_lossy().into_owned();
        let copied = self.source.file()?.execute("VACUUM INTO ?1", [name]);
        self.source
            .file()?
            .pragma_update(None, "query_only", true)
            .doing("copying the history")?;
        copied.doing("copying the history")?;
        Self::open_unchanged(partial)?.check()?;
        let file = File::open(partial).map_err(place)?;
        file.sync_all().map_err(place)?;
        // A hard link fails if the name has been taken in the meantime; a rename would overwrite the file.
        fs::hard_link(partial, target).map_err(place)?;
        if partial.exists() {
            fs::remove_file(partial).map_err(place)?;
        }
        Ok(file.metadata().map_err(place)?.len())
    }

    /// Runs SQLite's integrity check and checks the references between tables.
    pub fn check(&self) -> Result<()> {
        self.check_by("PRAGMA integrity_check(1)")?;
        let mut orphans = self
            .source
            .file()?
            .prepare("PRAGMA foreign_key_check")
            .doing(DOING)?;
        let mut rows = orphans.query([]).doing(DOING)?;
        match rows.next().doing(DOING)? {
            None => Ok(()),
            Some(row) => {
                let table: String = row.get(0).doing(DOING)?;
                Err(self.damaged(format!("a row of {table} refers to a missing row")))
            }
        }
    }

    /// Checks every page of the file, but does not compare indexes with their tables; faster than [`Self::check`].
    pub(super) fn quick_check(&self) -> Result<()> {
        self.check_by("PRAGMA quick_check(1)")
    }

    fn check_by(&self, pragma: &str) -> Result<()> {
        let found: rusqlite::Result<String> =
            self.source.file()?.query_row(pragma, [], |row| row.get(0));
        match found.doing(DOING)? {
            finding if finding == "ok" => Ok(()),
            finding => Err(self.damaged(finding)),
        }
    }

    fn damaged(&self, finding: String) -> HistoryError {
        let path = self.path.clone();
        HistoryError::Damaged { path, finding }
    }
}
