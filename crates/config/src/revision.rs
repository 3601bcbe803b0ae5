//! Revisions of a recipe: the newest is `recipes/NAME.toml`, earlier ones lie in `recipes/revisions/NAME/`, numbered
//! from 1.
//!
//! - A new recipe starts as a copy of another one, with a name and values of its own; its text is revision 1.
//! - A revision changes values of the newest text; comments and order of the file stay.
//! - A revision passes the same checks as a recipe before a run; these include what the modules of the plant can
//!   measure. A refused revision changes no file.
//! - A change names, by hash, the text that it is based on. The change is refused when that text is no longer the
//!   newest.
//! - The program stores the old text first, then a rename puts the new one in its place. After a crash between these
//!   two steps the newest text is stored twice, under one number.
//! - The folder is locked while files change, so that two programs cannot interfere.
//!
//! A run reads its recipe once, before it begins, so a revision never changes a lot under way.

use super::check::File;
use super::edit::edited;
use super::error::ConfigError;
use super::folder::Folder;
use super::plant::Plant;
use super::recipes::{check_new_name, parse_recipe, read_recipe, recipe_file, sha256_hex};
use super::sheet::{Field, fields};
use machine::form::KeyChange;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// A revision as the page shows it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
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
    /// Keys that differ from the revision before, in the order of the file; none in the first revision.
    pub changes: Vec<KeyChange>,
    /// All keys with their values.
    pub fields: Vec<Field>,
}

/// Requested change of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Name of the recipe.
    #[schema(example = "jzc-22f-012")]
    pub name: String,
    /// Hash of the text that the change starts from: `hash` of `GET /api/recipes/show`.
    pub from: String,
    /// Why the values change; not blank.
    #[schema(example = "the customer tightened the limit")]
    pub reason: String,
    /// Name of a new recipe to make from `name` with these values; `name` itself does not change. When absent, the
    /// values make the next revision of `name`.
    #[serde(default)]
    #[schema(example = "jzc-22f-012-special")]
    pub save_as: Option<String>,
    /// New values, each by the path of its key; null removes the key.
    #[schema(example = json!({"decision.slow_repeats": 4}))]
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
    let earlier = number.checked_sub(1).filter(|it| kept.contains(it));
    let before = earlier.map(|it| folder.file(&revision_file(name, it), "a recipe"));
    let before = before.transpose()?.map(|file| fields(&file)).transpose()?;
    let fields = fields(&file)?;
    Ok(Revision {
        changes: before.map_or_else(Vec::new, |before| changes(&before, &fields)),
        name: name.to_owned(),
        number,
        newest,
        saved_at_us,
        kept: matches!(folder, Folder::Directory(_)),
        fields,
        hash: parse_recipe(file, name)?.hash,
    })
}

/// Returns the keys whose values differ.
fn changes(before: &[Field], after: &[Field]) -> Vec<KeyChange> {
    let value = |fields: &[Field], path: &str| {
        let found = fields.iter().find(|it| it.path == path);
        found.map_or(Value::Null, |it| it.value.clone())
    };
    let gone = before
        .iter()
        .filter(|it| after.iter().all(|now| now.path != it.path));
    let all = after.iter().chain(gone).map(|it| KeyChange {
        old: value(before, &it.path),
        new: value(after, &it.path),
        unit: it.entry.unit().to_owned(),
        key: it.path.clone(),
    });
    all.filter(|it| it.old != it.new).collect()
}

impl Change {
    /// Returns the name of the recipe that the change writes.
    fn target(&self) -> &str {
        self.save_as.as_ref().unwrap_or(&self.name)
    }

    /// Returns the change as the audit of orders keeps it; `saved` is the new revision, `None` for a refused change.
    pub fn audit(&self, saved: Option<&Revision>) -> Value {
        let new = self.save_as.as_ref();
        json!({
            "order": if new.is_some() { "new_recipe" } else { "revise" },
            "recipe": new.unwrap_or(&self.name),
            "old_recipe": new.map(|_| &self.name),
            "revision": saved.map(|it| it.number),
            "hash": saved.map(|it| &it.hash),
            "reason": self.reason,
            "changes": saved.map(|it| &it.changes),
            "from": self.from,
            "values": self.values,
        })
    }
}

/// Writes the next revision of a recipe of `plant`, or a new recipe.
///
/// # Errors
/// Fails when a value or the name of the new recipe is refused, when `change` is not based on the newest revision, or
/// when a file cannot be written.
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
    if let Some(new) = &change.save_as {
        (folder.replace(&recipe_file(new), &text)).map_err(unwritten)?;
        let saved = revision(folder, new, None)?;
        return Ok(Revision {
            changes: changes(&fields(&old)?, &saved.fields),
            ..saved
        });
    }
    if kept.last() != Some(&number) {
        let earlier = revision_file(name, number);
        folder.replace(&earlier, &old.text).map_err(unwritten)?;
    }
    let newest = recipe_file(name);
    folder.replace(&newest, &text).map_err(unwritten)?;
    revision(folder, name, None)
}

fn unwritten(plant: &Plant, change: &Change, source: std::io::Error) -> ConfigError {
    let file = plant.folder.path(&recipe_file(change.target()));
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
    if change.reason.trim().is_empty() {
        return Err(ConfigError::NoReason);
    }
    if sha256_hex(old.text.as_bytes()) != change.from {
        return Err(ConfigError::NotNewest {
            name: name.clone(),
            newest,
        });
    }
    let mut values = change.values.clone();
    if let Some(new) = &change.save_as {
        check_new_name(&plant.folder, new)?;
        values.insert("name".to_owned(), json!(new));
    }
    let text = edited(old, &values)?;
    if text == old.text {
        let file = old.path.clone();
        return Err(ConfigError::NothingChanged { file });
    }
    let path = plant.folder.path(&recipe_file(change.target()));
    let recipe = parse_recipe(File::parse(path, text.clone())?, change.target())?;
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

/// Returns the number of the newest revision, whose text is `text`; `kept` are the numbers of the stored earlier
/// revisions.
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
