//! Restores a rig from a backup: copies and checks history, people and configuration, then puts the copies in place.
//!
//! Replaced files stay beside the restored ones as `NAME.before-TIME`. The restore replaces a file only after it has
//! made and checked all copies.

use crate::backup_folder::{backups, copy_folder};
use crate::order::Files;
use anyhow::Context;
use config::{Folder, overview, recipe_names};
use history::{Archive, Filter, SCHEMA, examine, is_in_use, with_end};
use jiff::Timestamp;
use page::access::{Register, Role, access_path};
use std::fs;
use std::os::unix::fs::{MetadataExt, chown};
use std::path::{Path, PathBuf};

/// Suffix of a replaced file or folder: the time of the restore, UTC.
const REPLACED: &str = ".before-%Y%m%dT%H%M%SZ";
/// Suffix of a copy that is not in place yet.
const STAGED: &str = ".restoring";

/// Kind of an item that a backup may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kept {
    History,
    People,
    Configuration,
}

/// An item to restore, with its path in the backup and its target.
type Item<'a> = (Kept, &'a Path, PathBuf);

/// A backup and its items.
#[derive(Debug)]
pub struct Contents {
    /// Folder of the backup, or its history file.
    pub at: PathBuf,
    history: PathBuf,
    people: Option<PathBuf>,
    config: Option<PathBuf>,
}

impl Contents {
    /// Finds the backup at `at`: a dated folder, a folder of dated folders (finds the newest), or a copied history.
    ///
    /// # Errors
    /// Fails when `at` holds no backup, or when a folder holds several histories.
    pub fn find(at: &Path) -> anyhow::Result<Self> {
        let newest = backups(at).pop().map(|(_, folder)| folder);
        let at = newest.unwrap_or_else(|| at.to_owned());
        let history = match at.is_dir() {
            true => only_history(&at)?,
            false => at.clone(),
        };
        anyhow::ensure!(history.exists(), "no backup at {}", at.display());
        let (people, config) = (access_path(&history), at.join("config"));
        Ok(Self {
            people: people.exists().then_some(people),
            config: config.is_dir().then_some(config),
            history,
            at,
        })
    }

    /// Checks the history, the people and the configuration; returns the name of each with a description, or with the
    /// fault that forbids its restore.
    pub fn check(&self) -> [(&'static str, anyhow::Result<String>); 3] {
        let checked = |kept, path: Option<&PathBuf>| match path {
            Some(path) => check(kept, path),
            None => Ok("none in this backup".to_owned()),
        };
        [
            ("history", checked(Kept::History, Some(&self.history))),
            ("people", checked(Kept::People, self.people.as_ref())),
            (
                "configuration",
                checked(Kept::Configuration, self.config.as_ref()),
            ),
        ]
    }

    /// Restores the items of the backup to `files`; returns the new paths of the files and folders that they replace.
    ///
    /// # Errors
    /// Fails, and replaces nothing, when a target exists and `replace` is false, when another program has a target
    /// open, or when a copy cannot be made or checked. Fails too when a checked copy cannot be moved into place; other
    /// copies may be in place then. No copy stays beside its target.
    pub fn restore(&self, files: &Files, replace: bool) -> anyhow::Result<Vec<PathBuf>> {
        let moves = self.moves(files)?;
        for (kept, _, target) in moves.iter().filter(|(_, _, target)| target.exists()) {
            let name = target.display();
            anyhow::ensure!(
                replace,
                "{name} exists: --replace keeps it beside the restored one"
            );
            let used = *kept != Kept::Configuration && is_in_use(target)?;
            anyhow::ensure!(!used, "{name} is in use: stop the rig first");
        }
        let replaced = exchange(&moves);
        for (.., target) in &moves {
            // The caller gets the result of `exchange`; a failed clean-up matters less.
            let _ = discard(&with_end(target, STAGED));
        }
        replaced
    }

    fn moves(&self, files: &Files) -> anyhow::Result<Vec<Item<'_>>> {
        let db = std::path::absolute(&files.db)?;
        let mut moves = Vec::new();
        if let (Some(from), Folder::Directory(dir)) = (&self.config, &files.config) {
            let to = std::path::absolute(dir)?;
            moves.push((Kept::Configuration, from.as_path(), to));
        }
        if let Some(from) = &self.people {
            moves.push((Kept::People, from, access_path(&db)));
        }
        moves.push((Kept::History, &self.history, db));
        Ok(moves)
    }
}

/// Returns the history in the folder of a backup.
fn only_history(folder: &Path) -> anyhow::Result<PathBuf> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let names = entries.flatten().map(|it| it.path()).filter(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.ends_with(".db") && !name.ends_with("-access.db")
    });
    let found: Vec<PathBuf> = names.collect();
    match found.as_slice() {
        [only] => Ok(only.clone()),
        several => anyhow::bail!(
            "{}: found {} histories, expected one, as `history backup --into` makes it",
            folder.display(),
            several.len()
        ),
    }
}

/// Checks an item and describes it.
fn check(kept: Kept, path: &Path) -> anyhow::Result<String> {
    match kept {
        Kept::History => check_history(path),
        Kept::People => {
            let people = Register::open_unchanged(path)?.checked_people()?;
            let engineers = people.iter().filter(|it| it.role == Role::Engineer);
            let (people, engineers) = (people.len(), engineers.count());
            Ok(format!("{people}, of them engineers {engineers}; whole"))
        }
        Kept::Configuration => {
            let folder = Folder::from(path);
            overview(&folder)?;
            let recipes = recipe_names(&folder).len();
            Ok(format!("{recipes} recipes; `config check` finds no fault"))
        }
    }
}

fn check_history(path: &Path) -> anyhow::Result<String> {
    let archive = Archive::open_unchanged(path)?;
    archive.check()?;
    let schema = examine(path)?.schema;
    let bytes = fs::metadata(path)?.len();
    if schema < SCHEMA {
        return Ok(format!(
            "{bytes} bytes, schema {schema}, which the next start brings to {SCHEMA}; whole"
        ));
    }
    let runs = archive.lots(&Filter::default())?;
    let parts: u64 = runs.iter().map(|it| it.counts.parts).sum();
    let last = runs.iter().map(|it| it.closed.unwrap_or(it.opened)).max();
    let last = last.map_or_else(String::new, |it| {
        format!(", the last one of {}", it.local())
    });
    let runs = runs.len();
    Ok(format!(
        "{bytes} bytes, {runs} runs of lots{last}, {parts} parts; whole"
    ))
}

/// Copies all items beside their targets, then puts the copies in place; returns the new paths of the replaced items.
fn exchange(moves: &[Item<'_>]) -> anyhow::Result<Vec<PathBuf>> {
    for (kept, from, target) in moves {
        let staged = with_end(target, STAGED);
        let done = stage(*kept, from, &staged).and_then(|()| Ok(inherit(&staged, target)?));
        done.with_context(|| format!("copying {}", from.display()))?;
    }
    let end = Timestamp::now().strftime(REPLACED).to_string();
    let mut replaced = Vec::new();
    for (.., target) in moves {
        let name = || format!("putting {} in place", target.display());
        replaced.extend(set_aside(target, &end).with_context(name)?);
        fs::rename(with_end(target, STAGED), target).with_context(name)?;
    }
    Ok(replaced)
}

/// Deletes a file or a folder; does nothing when it is absent.
fn discard(path: &Path) -> std::io::Result<()> {
    match fs::metadata(path) {
        Ok(it) if it.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(_) => Ok(()),
    }
}

/// Copies an item to `staged` and checks the copy; overwrites a copy that a killed restore left there.
fn stage(kept: Kept, from: &Path, staged: &Path) -> anyhow::Result<()> {
    discard(staged)?;
    match kept {
        Kept::History => drop(Archive::open_unchanged(from)?.backup(staged)?),
        Kept::People => Register::open_unchanged(from)?.copy_to(staged)?,
        Kept::Configuration => copy_folder(from, staged)?,
    }
    check(kept, staged).map(drop)
}

/// When root restores, gives `new` the owner of the replaced item `old`, or of the nearest existing folder around
/// `old`.
fn inherit(new: &Path, old: &Path) -> std::io::Result<()> {
    let model = old.ancestors().find_map(|it| fs::metadata(it).ok());
    if let Some(model) = model
        && fs::metadata(new)?.uid() == 0
    {
        chown(new, Some(model.uid()), Some(model.gid()))?;
    }
    if new.is_dir() {
        for entry in fs::read_dir(new)? {
            let entry = entry?;
            inherit(&entry.path(), &old.join(entry.file_name()))?;
        }
    }
    Ok(())
}

/// Renames a folder, or a file with the files that SQLite keeps beside it; returns the new path, `None` when `target`
/// is absent.
fn set_aside(target: &Path, end: &str) -> std::io::Result<Option<PathBuf>> {
    let aside = with_end(target, end);
    for beside in
        ["-wal", "-shm", "-journal"].map(|it| (with_end(target, it), with_end(&aside, it)))
    {
        if beside.0.exists() {
            fs::rename(beside.0, beside.1)?;
        }
    }
    match target.exists() {
        true => fs::rename(target, &aside).map(|()| Some(aside)),
        false => Ok(None),
    }
}
