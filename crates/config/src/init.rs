//! Writes the configuration that is compiled into the program as a directory of its own.
//!
//! Writes the files to a hidden directory and moves them from there when all are on the disk, so that no half-written
//! configuration is left. The hidden directory lies beside a target that does not exist yet, but inside an empty
//! target, which may be the working directory or the root of a file system.

use super::built_in::{BUILT_IN, files_of};
use std::collections::BTreeSet;
use std::fs::{self, File, Permissions};
use std::io::{self, ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use thiserror::Error;

/// Error: no configuration was written.
#[derive(Debug, Error)]
pub enum InitError {
    /// The directory has entries and stays unchanged.
    #[error("{}: found a folder that is not empty, expected a new or an empty one; nothing was written", dir.display())]
    NotEmpty {
        /// Path of the directory.
        dir: PathBuf,
    },
    /// No rig of this program has the name.
    #[error("found rig \"{found}\", expected one of {known}", known = super::Folder::built_in_rigs().collect::<Vec<_>>().join(", "))]
    UnknownRig {
        /// Name given.
        found: String,
    },
    /// The directory or a file could not be written.
    #[error("{}: the configuration could not be written", dir.display())]
    Unwritten {
        /// Path of the directory.
        dir: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

/// Name and text of a file.
type Named = (&'static str, &'static str);

/// Writes the files of a built-in rig to `dir`, which must be new or empty, with the instrument profiles and the
/// explanation of the keys. Missing parents are created.
///
/// # Errors
/// Fails when no rig has the name, when `dir` has entries, or when it cannot be written.
pub fn init(dir: &Path, rig: &str) -> Result<(), InitError> {
    let own = files_of(rig).ok_or_else(|| InitError::UnknownRig {
        found: rig.to_owned(),
    })?;
    let shared = |(name, _): &&Named| *name == "README.md" || name.starts_with("instruments/");
    let missing = |(name, _): &&Named| own.iter().all(|(known, _)| known != name);
    let shared = BUILT_IN.iter().filter(shared).filter(missing);
    let files: Vec<Named> = own.iter().chain(shared).copied().collect();
    let written = match fs::read_dir(dir).map(|mut entries| entries.next()) {
        Ok(Some(_)) => {
            let dir = dir.to_owned();
            return Err(InitError::NotEmpty { dir });
        }
        Ok(None) => fill(dir, &files),
        Err(error) if error.kind() == ErrorKind::NotFound => create(dir, &files),
        Err(error) => Err(error),
    };
    written.map_err(|source| InitError::Unwritten {
        dir: dir.to_owned(),
        source,
    })
}

fn create(dir: &Path, files: &[Named]) -> io::Result<()> {
    let parent = match dir.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        Some(_) | None => Path::new("."),
    };
    fs::create_dir_all(parent)?;
    let staged = stage(parent, files)?;
    fs::rename(staged.path(), dir)?;
    File::open(parent)?.sync_all()
}

fn fill(dir: &Path, files: &[Named]) -> io::Result<()> {
    let staged = stage(dir, files)?;
    let first = |(name, _): &Named| name.split('/').next();
    let entries: BTreeSet<&str> = files.iter().filter_map(first).collect();
    for entry in entries {
        fs::rename(staged.path().join(entry), dir.join(entry))?;
    }
    File::open(dir)?.sync_all()
}

/// Writes every file to a hidden directory in `place`, which disappears when the returned value is dropped.
fn stage(place: &Path, files: &[Named]) -> io::Result<TempDir> {
    let mut hidden = tempfile::Builder::new();
    // The permissions of any new directory; without this line only the owner could read it.
    hidden.permissions(Permissions::from_mode(0o777));
    let staged = hidden.prefix(".relayrig-init-").tempdir_in(place)?;
    for (name, text) in files {
        let path = staged.path().join(name);
        fs::create_dir_all(path.parent().unwrap_or(place))?;
        let mut file = File::create(path)?;
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
    }
    Ok(staged)
}
