//! Copies of the history on the disk, noted for the retention: only what was copied whole may be deleted.

use history::{Archive, Filter, Identity, Store};
use std::fs::File;
use std::path::Path;

/// Copies the history into a new file and returns its size in bytes.
///
/// # Errors
/// The file exists, cannot be written, or holds another content than the history.
pub fn backup(db: &Path, file: &Path) -> anyhow::Result<u64> {
    let bytes = Archive::open(db)?.backup(file)?;
    note(db, &Filter::default(), file)?;
    Ok(bytes)
}

/// Notes an export that is written, if its filter takes runs whole.
///
/// # Errors
/// The disk does not take the file, or the history not the note.
pub fn exported(db: &Path, filter: &Filter, file: &Path) -> anyhow::Result<()> {
    if !filter.takes_whole_runs() {
        return Ok(());
    }
    File::open(file)?.sync_all()?;
    note(db, filter, file)
}

fn note(db: &Path, filter: &Filter, file: &Path) -> anyhow::Result<()> {
    let mut store = Store::open(db, &Identity::of_this_program())?;
    let file = std::path::absolute(file)?;
    let now_us = jiff::Timestamp::now().as_microsecond();
    store.record_export(filter, &file.to_string_lossy(), now_us)?;
    Ok(())
}
