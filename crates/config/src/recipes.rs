//! Loads recipes: `recipes/NAME.toml`.

use super::check::File;
use super::error::ConfigError;
use super::folder::Folder;
use super::keys;
use super::tree::{Node, Value};
use data_encoding::HEXLOWER;
use machine::dut::{Kind, Recipe};
use machine::form::one_of;
use machine::rig::fault::Fault;
use serde::Deserialize;
use sha2::{Digest, Sha256};

/// Reads and checks the recipe `name` of a configuration.
///
/// # Errors
/// Fails when no recipe has this name, or as [`super::Plant::load`] does.
pub fn load_recipe(folder: &Folder, name: &str) -> Result<Recipe, ConfigError> {
    parse_recipe(read_recipe(folder, name)?, name)
}

/// Reads the file of a recipe. Only the name of an existing recipe becomes a path, so `../rig` is refused.
pub(super) fn read_recipe(folder: &Folder, name: &str) -> Result<File, ConfigError> {
    folder.check_exists()?;
    let known = recipe_names(folder);
    if !known.iter().any(|known| known == name) {
        return Err(ConfigError::UnknownRecipe {
            dir: folder.path("recipes"),
            name: name.to_owned(),
            known,
        });
    }
    folder.file(&recipe_file(name), "a recipe")
}

/// Returns the file of a recipe within its configuration.
pub(super) fn recipe_file(name: &str) -> String {
    format!("recipes/{name}.toml")
}

/// Returns the names of all recipes, sorted; none when the folder cannot be read.
pub fn recipe_names(folder: &Folder) -> Vec<String> {
    folder.stems("recipes")
}

/// Section `[recipes]` of `rig.toml`.
#[derive(Deserialize)]
struct RecipeRules {
    #[serde(default)]
    recipes: RecipeRule,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct RecipeRule {
    approval: Approval,
}

/// Number of engineers who must have saved or approved a recipe before a lot may use it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Approval {
    /// No engineer.
    #[default]
    None,
    /// Two engineers: one who saved or approved the text, and a second one who approved the text.
    SecondPerson,
}

/// Reads `[recipes] approval` of `rig.toml`.
///
/// # Errors
/// Fails when `rig.toml` cannot be read or has a faulty key.
pub fn approval(folder: &Folder) -> Result<Approval, ConfigError> {
    let rig = folder.file("rig.toml", "the wiring of the rig")?;
    let rules: RecipeRules = rig.settings(rig.rig_keys())?;
    Ok(rules.recipes.approval)
}

/// Checks that `name` may name a new recipe.
pub(super) fn check_new_name(folder: &Folder, name: &str) -> Result<(), ConfigError> {
    let named = |it: char| it.is_alphanumeric() || "-_.".contains(it);
    let good = (1..=60).contains(&name.chars().count())
        && name.starts_with(char::is_alphanumeric)
        && name.chars().all(named);
    if !good {
        let found = name.chars().take(80).collect();
        return Err(ConfigError::RecipeName { found });
    }
    let same = |it: &String| it.to_lowercase() == name.to_lowercase();
    match recipe_names(folder).into_iter().find(same) {
        Some(name) => Err(ConfigError::RecipeTaken { name }),
        None => Ok(()),
    }
}

pub(super) fn parse_recipe(file: File, name: &str) -> Result<Recipe, ConfigError> {
    let mut recipe: Recipe = file.settings(&keys::recipe::of(kind_of(&file)?))?;
    if recipe.name != name {
        let fault = Fault::new(
            "name",
            format!("\"{}\"", recipe.name),
            format!("\"{name}\", as the file is called"),
        );
        return Err(file.locate(&fault));
    }
    recipe.check().map_err(|fault| file.locate(&fault))?;
    recipe.hash = sha256_hex(file.text.as_bytes());
    recipe.source_text = file.text;
    Ok(recipe)
}

/// Reads the kind of device, which decides which other keys a recipe has.
///
/// # Errors
/// Fails when the key is missing or its value is not a kind.
pub(super) fn kind_of(file: &File) -> Result<Kind, ConfigError> {
    let node = file.root.get("kind");
    let kind = match node.map(|it| &it.value) {
        Some(Value::Text(name)) => Kind::from_name(name),
        Some(_) | None => None,
    };
    kind.ok_or_else(|| {
        let found = node.map_or_else(|| "nothing".to_owned(), Node::describe);
        file.locate(&Fault::new("kind", found, one_of(Kind::NAMES)))
    })
}

pub(super) fn sha256_hex(bytes: &[u8]) -> String {
    HEXLOWER.encode(&Sha256::digest(bytes))
}
