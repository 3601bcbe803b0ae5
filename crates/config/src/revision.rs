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
use super::folder::Folder;
use super::plant::Plant;
use super::recipes::{parse_recipe, read_recipe, recipe_file, sha256_hex};
use super::sheet::{Field, fields};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
    /// Time at which the file was written, microseconds since 1970 UTC; `None` when it is not known.
    pub saved_at_us: Option<i64>,
    /// False when revisions last only until the program ends.
    pub kept: bool,
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
pub fn revision(folder: &Folder, name: &str, number: Option<u32>) -> Result<Revision, ConfigError> {
    let file = read_recipe(folder, name)?;
    let kept = earlier_revisions(folder, name);
    let newest = number_of(folder, name, &kept, &file.text);
    let number = number.unwrap_or(newest);
    let (file, saved_at_us) = if number == newest {
        (file, folder.saved_at_us(&recipe_file(name)))
    } else if kept.contains(&number) {
        let earlier = revision_file(name, number);
        (
            folder.file(&earlier, "a recipe")?,
            folder.saved_at_us(&earlier),
        )
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
        saved_at_us,
        kept: matches!(folder, Folder::Directory(_)),
        fields: fields(&file)?,
        hash: parse_recipe(file, name)?.hash,
    })
}

/// Writes the next revision of a recipe of `plant`.
///
/// # Errors
/// Fails when a value is refused, when `change` is not based on the newest revision, or when a file cannot be written.
pub fn revise(plant: &Plant, change: &Change) -> Result<Revision, ConfigError> {
    let alone = plant.folder.alone(|| write_next(plant, change));
    alone.map_err(|source| unwritten(plant, change, source))?
}

/// Does the work of [`revise`] while no other change runs.
fn write_next(plant: &Plant, change: &Change) -> Result<Revision, ConfigError> {
    let (folder, name) = (&plant.folder, &change.name);
    let unwritten = |source| unwritten(plant, change, source);
    let old = read_recipe(folder, name)?;
    let kept = earlier_revisions(folder, name);
    let number = number_of(folder, name, &kept, &old.text);
    let text = next_text(plant, change, &old, number)?;
    if kept.last() != Some(&number) {
        let earlier = revision_file(name, number);
        folder.replace(&earlier, &old.text).map_err(unwritten)?;
    }
    let newest = recipe_file(name);
    folder.replace(&newest, &text).map_err(unwritten)?;
    revision(folder, name, None)
}

fn unwritten(plant: &Plant, change: &Change, source: std::io::Error) -> ConfigError {
    let file = plant.folder.path(&recipe_file(&change.name));
    ConfigError::Unwritten { file, source }
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
fn earlier_revisions(folder: &Folder, name: &str) -> Vec<u32> {
    let stems = folder.stems(&format!("recipes/revisions/{name}"));
    let numbers = stems.iter().filter_map(|stem| stem.parse().ok());
    let mut numbers: Vec<u32> = numbers.collect();
    numbers.sort_unstable();
    numbers
}

/// Returns the number of the newest revision, whose text is `text`; `kept` are the numbers of the earlier ones.
fn number_of(folder: &Folder, name: &str, kept: &[u32], text: &str) -> u32 {
    let Some(last) = kept.last() else {
        return 1;
    };
    match folder.read(&revision_file(name, *last)) {
        Ok(kept) if kept == text => *last,
        Ok(_) | Err(_) => last + 1,
    }
}

/// Returns the file of an earlier revision within its configuration.
fn revision_file(name: &str, number: u32) -> String {
    format!("recipes/revisions/{name}/{number}.toml")
}
