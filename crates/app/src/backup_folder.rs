//! Backs up a whole rig: a dated folder holds history, people and configuration; only the newest folders stay.
//!
//! `prune` deletes only runs of which the history records a copy. The history does not record a backup as a copy,
//! because a later backup deletes the earlier ones. A backup migrates neither history nor people to a newer schema,
//! because an older version of the program may have them open.

use crate::order::Files;
use anyhow::Context;
use config::Folder;
use history::Archive;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp};
use page::access::{Register, access_path};
use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Name of a backup, in UTC.
const NAME: &str = "relayrig-%Y%m%dT%H%M%SZ";
/// Name of a backup that is being made.
const PARTIAL: &str = "relayrig-%Y%m%dT%H%M%SZ.partial";
/// Age from which a partial backup counts as left behind by a killed program: no backup takes this long.
const LEFT: SignedDuration = SignedDuration::from_hours(24);

/// A backup that was made.
#[derive(Debug)]
pub struct Backup {
    /// Folder of the backup.
    pub folder: PathBuf,
    /// Size of the copied history, bytes.
    pub bytes: u64,
    /// Older backups that were deleted.
    pub deleted: Vec<PathBuf>,
}

/// Copies the rig into a new folder inside `into`, then deletes all but the `keep` newest backups.
///
/// # Errors
/// Fails when a file cannot be read or written, when a backup of this second exists, or when the copied history differs
/// from the history. No older backup is deleted then.
pub fn back_up(files: &Files, into: &Path, keep: NonZeroUsize) -> anyhow::Result<Backup> {
    let now = Timestamp::now();
    let folder = into.join(now.strftime(NAME).to_string());
    anyhow::ensure!(!folder.exists(), "{} exists already", folder.display());
    let partial = into.join(now.strftime(PARTIAL).to_string());
    let bytes = copy_rig(files, &partial).inspect_err(|_| {
        // The caller gets the first error; a failed clean-up matters less.
        let _ = fs::remove_dir_all(&partial);
    })?;
    fs::rename(&partial, &folder).with_context(|| folder.display().to_string())?;
    fs::File::open(into)?.sync_all()?;
    let deleted = rotate(into, keep, now)?;
    Ok(Backup {
        folder,
        bytes,
        deleted,
    })
}

/// Returns the backups inside `into` with their times, oldest first; none when there is no such folder.
pub fn backups(into: &Path) -> Vec<(Timestamp, PathBuf)> {
    dated(into, NAME)
}

fn dated(into: &Path, name: &str) -> Vec<(Timestamp, PathBuf)> {
    let time = |entry: fs::DirEntry| {
        let made = DateTime::strptime(name, entry.file_name().to_str()?).ok()?;
        let made = made.to_zoned(TimeZone::UTC).ok()?.timestamp();
        Some((made, entry.path()))
    };
    let entries = fs::read_dir(into).into_iter().flatten().flatten();
    let mut found: Vec<_> = entries.filter_map(time).collect();
    found.sort();
    found
}

/// Deletes all but the `keep` newest backups, and partial ones older than [`LEFT`]; returns the deleted folders.
fn rotate(into: &Path, keep: NonZeroUsize, now: Timestamp) -> anyhow::Result<Vec<PathBuf>> {
    let mut old = backups(into);
    old.truncate(old.len().saturating_sub(keep.get()));
    let partial = dated(into, PARTIAL).into_iter();
    old.extend(partial.filter(|(begun, _)| now.duration_since(*begun) > LEFT));
    let delete = |(_, folder): (Timestamp, PathBuf)| {
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
        Ok(folder)
    };
    old.into_iter().map(delete).collect()
}

/// Copies history, people and configuration into the new folder `to`; returns the size of the history.
fn copy_rig(files: &Files, to: &Path) -> anyhow::Result<u64> {
    let named = || to.display().to_string();
    fs::create_dir_all(to).with_context(named)?;
    let db = to.join(files.db.file_name().unwrap_or("relayrig.db".as_ref()));
    let bytes = Archive::open_unchanged(&files.db)?.backup(&db)?;
    let people = access_path(&files.db);
    if people.exists() {
        Register::open_unchanged(&people)?.copy_to(&access_path(&db))?;
    }
    match &files.config {
        Folder::Directory(dir) => copy_folder(dir, &to.join("config"))?,
        // The built-in configuration is part of the program.
        Folder::Memory(_) => {}
    }
    Ok(bytes)
}

/// Copies a folder with all that it holds; `to` may exist.
///
/// # Errors
/// Fails when a file cannot be read or written.
pub fn copy_folder(from: &Path, to: &Path) -> anyhow::Result<()> {
    let named = || format!("copying {}", from.display());
    fs::create_dir_all(to).with_context(named)?;
    for entry in fs::read_dir(from).with_context(named)? {
        let (path, target) = entry
            .map(|it| (it.path(), to.join(it.file_name())))
            .with_context(named)?;
        match path.is_dir() {
            true => copy_folder(&path, &target)?,
            false => drop(fs::copy(&path, &target).with_context(|| path.display().to_string())?),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn rotation_deletes_old_backups_and_killed_ones() {
        let folder = tempfile::tempdir().unwrap();
        let kept = ["relayrig-20260103T000000Z", "relayrig-20260102T000000Z"];
        let foreign = ["photos", "relayrig-20260103T000000Z.partial", "relayrig-1"];
        let old = [
            "relayrig-20251231T235959Z",
            "relayrig-20260101T235959Z.partial",
        ];
        for name in kept.iter().chain(&foreign).chain(&old) {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        let (keep, now) = (NonZeroUsize::new(2).unwrap(), "2026-01-03T00:00:00Z");
        let deleted = rotate(folder.path(), keep, now.parse().unwrap()).unwrap();
        assert_eq!(deleted, old.map(|it| folder.path().join(it)));
        for name in kept.iter().chain(&foreign) {
            assert!(folder.path().join(name).exists(), "{name}");
        }
    }
}
