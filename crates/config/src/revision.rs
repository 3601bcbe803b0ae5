//! Revisions of a recipe: the newest is `recipes/NAME.toml`, earlier ones lie in `recipes/revisions/NAME/`, numbered
//! from 1.
//!
//! - A revision changes values of the newest text; comments and order of the file stay.
//! - A revision passes the same checks as a recipe before a run; these include what the modules of the plant can
//!   measure. A refused revision changes no file.
//! - A change names, by hash, the text that it is based on. It is refused when another revision has come in between.
//! - The old text is stored first, then a rename puts the new one in its place. After a crash between these two steps
//!   the newest text is stored twice, under one number.
//! - The folder is locked while files change, so that two programs cannot interfere.
//!
//! A run reads its recipe once, before it begins, so a revision never changes a lot under way.

use super::check::File;
use super::edit::edited;
use super::error::ConfigError;
use super::plant::Plant;
use super::recipes::{parse_recipe, recipe_path, sha256_hex};
use super::sheet::{Field, fields};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// A revision as the page shows it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Revision {
    /// Name of the recipe.
    pub name: String,
    /// Number of the revision, from 1.
    pub number: u32,
    /// Number of the newest revision of the recipe.
    pub newest: u32,
    /// SHA-256 of the text; runs store the same hash.
    pub hash: String,
    /// Time at which the file was written, microseconds since 1970 UTC; `None` when the file system does not keep it.
    pub saved_at_us: Option<i64>,
    /// All keys with their values.
    pub fields: Vec<Field>,
}

/// Requested change of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Name of the recipe.
    pub name: String,
    /// Hash of the text that the change is based on.
    pub from: String,
    /// New values, each by the path of its key; null removes the key.
    pub values: BTreeMap<String, serde_json::Value>,
}

/// Returns revision `number` of recipe `name`; without a number, the newest.
///
/// # Errors
/// Fails when the recipe has no revision with this number, or as [`super::load_recipe`] does.
pub fn revision(dir: &Path, name: &str, number: Option<u32>) -> Result<Revision, ConfigError> {
    let file = File::read(recipe_path(dir, name)?, "a recipe")?;
    let kept = earlier_revisions(dir, name);
    let newest = number_of(dir, name, &kept, &file.text);
    let number = number.unwrap_or(newest);
    let file = if number == newest {
        file
    } else if kept.contains(&number) {
        File::read(revision_path(dir, name, number), "a recipe")?
    } else {
        return Err(ConfigError::UnknownRevision {
            name: name.to_owned(),
            number,
            newest,
        });
    };
    Ok(Revision {
        name: name.to_owned(),
        number,
        newest,
        saved_at_us: saved_at_us(&file.path),
        fields: fields(&file)?,
        hash: parse_recipe(file, name)?.hash,
    })
}

/// Writes the next revision of a recipe of `plant`.
///
/// # Errors
/// Fails when a value is refused, when `change` is not based on the newest revision, or when a file cannot be written.
pub fn revise(plant: &Plant, change: &Change) -> Result<Revision, ConfigError> {
    let (dir, name) = (&plant.dir, &change.name);
    let path = recipe_path(dir, name)?;
    let unwritten = |source| ConfigError::Unwritten {
        file: path.clone(),
        source,
    };
    let folder = std::fs::File::open(dir.join("recipes")).map_err(unwritten)?;
    folder.lock().map_err(unwritten)?;
    let old = File::read(path.clone(), "a recipe")?;
    let kept = earlier_revisions(dir, name);
    let number = number_of(dir, name, &kept, &old.text);
    let text = next_text(plant, change, &old, number)?;
    if kept.last() != Some(&number) {
        replace_file(&revision_path(dir, name, number), &old.text).map_err(unwritten)?;
    }
    replace_file(&path, &text).map_err(unwritten)?;
    revision(dir, name, None)
}

/// Applies `change` to `old`, the newest text, and checks the result.
fn next_text(
    plant: &Plant,
    change: &Change,
    old: &File,
    newest: u32,
) -> Result<String, ConfigError> {
    let name = &change.name;
    if sha256_hex(old.text.as_bytes()) != change.from {
        return Err(ConfigError::NotNewest {
            name: name.clone(),
            newest,
        });
    }
    let text = edited(old, &change.values)?;
    if text == old.text {
        let file = old.path.clone();
        return Err(ConfigError::NothingChanged { file });
    }
    let recipe = parse_recipe(File::parse(old.path.clone(), text.clone())?, name)?;
    plant.admit(&recipe)?;
    Ok(text)
}

/// Returns the numbers of the earlier revisions in ascending order.
fn earlier_revisions(dir: &Path, name: &str) -> Vec<u32> {
    let files = std::fs::read_dir(revision_folder(dir, name));
    let number = |file: std::fs::DirEntry| {
        let file = file.file_name();
        file.to_str()?.strip_suffix(".toml")?.parse().ok()
    };
    let files = files.into_iter().flatten().flatten();
    let mut numbers: Vec<u32> = files.filter_map(number).collect();
    numbers.sort_unstable();
    numbers
}

/// Returns the number of the newest revision, whose text is `text`; `kept` are the numbers of the earlier ones.
fn number_of(dir: &Path, name: &str, kept: &[u32], text: &str) -> u32 {
    let Some(last) = kept.last() else {
        return 1;
    };
    match std::fs::read_to_string(revision_path(dir, name, *last)) {
        Ok(kept) if kept == text => *last,
        Ok(_) | Err(_) => last + 1,
    }
}

fn revision_folder(dir: &Path, name: &str) -> PathBuf {
    dir.join("recipes").join("revisions").join(name)
}

fn revision_path(dir: &Path, name: &str, number: u32) -> PathBuf {
    revision_folder(dir, name).join(format!("{number}.toml"))
}

/// Replaces a file atomically: after a crash the file holds either `text` or its old content.
fn replace_file(path: &Path, text: &str) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let beside = path.with_extension("toml.new");
    let mut file = std::fs::File::create(&beside)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()?;
    std::fs::rename(&beside, path)?;
    std::fs::File::open(folder)?.sync_all()
}

fn saved_at_us(path: &Path) -> Option<i64> {
    let written = std::fs::metadata(path).and_then(|it| it.modified()).ok()?;
    let since = written.duration_since(UNIX_EPOCH).ok()?;
    i64::try_from(since.as_micros()).ok()
}
