//! Every fault of a configuration, file by file.

use super::card::load_card;
use super::check::{Faults, File};
use super::error::ConfigError;
use super::keys;
use super::lot::load_lot;
use super::plant::{Plant, load_scene};
use super::recipes::{kind_of, parse_recipe, recipe_names};
use machine::form::Key;
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;
use thiserror::Error;

/// The faults of a configuration, at least one. The text has a line for each.
#[derive(Debug, Error)]
pub struct ConfigFaults(Faults);

impl From<ConfigError> for ConfigFaults {
    fn from(fault: ConfigError) -> Self {
        Self(vec![fault])
    }
}

impl fmt::Display for ConfigFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.as_slice() {
            [one] => one.fmt(f),
            all => {
                write!(f, "{} faults", all.len())?;
                all.iter().try_for_each(|fault| write!(f, "\n{fault}"))
            }
        }
    }
}

/// Checks all files of `dir`. Values are compared with each other only in a file whose keys are right, and a recipe is
/// compared with the rig only when the files of the rig are right.
///
/// # Errors
/// Fails with every fault found.
pub fn check_all(dir: &Path) -> Result<Plant, ConfigFaults> {
    let mut found = Found::default();
    for (name, keys) in [
        ("rig.toml", keys::rig::FILE),
        ("golden.toml", keys::golden::FILE),
        ("lot.toml", keys::lot::FILE),
        ("card.toml", keys::card::FILE),
    ] {
        found.keys(dir, name, keys);
    }
    let plant = found.note(Plant::load(dir));
    found.note(load_scene(&dir.join("scene.toml")));
    found.note(load_lot(dir));
    found.note(load_card(dir));
    for name in recipe_names(dir) {
        found.recipe(dir, plant.as_ref(), &name);
    }
    match plant {
        Some(plant) if found.faults.is_empty() => Ok(plant),
        Some(_) | None => Err(ConfigFaults(found.faults)),
    }
}

/// Faults found so far; one that two checks find is kept once.
#[derive(Default)]
struct Found {
    faults: Faults,
    texts: BTreeSet<String>,
}

impl Found {
    fn add(&mut self, fault: ConfigError) {
        if self.texts.insert(fault.to_string()) {
            self.faults.push(fault);
        }
    }

    fn note<T>(&mut self, result: Result<T, ConfigError>) -> Option<T> {
        result.map_err(|fault| self.add(fault)).ok()
    }

    fn keys(&mut self, dir: &Path, name: &str, keys: &[Key]) {
        // Loading reports a file that is missing or not TOML.
        if let Ok(file) = File::read(dir.join(name), "a file of the configuration") {
            file.faults(keys)
                .into_iter()
                .for_each(|fault| self.add(fault));
        }
    }

    fn recipe(&mut self, dir: &Path, plant: Option<&Plant>, name: &str) {
        let path = dir.join("recipes").join(format!("{name}.toml"));
        let Some(file) = self.note(File::read(path, "a recipe")) else {
            return;
        };
        let Some(kind) = self.note(kind_of(&file)) else {
            return;
        };
        let faults = file.faults(&keys::recipe::of(kind));
        faults.into_iter().for_each(|fault| self.add(fault));
        if let Some(recipe) = self.note(parse_recipe(file, name)) {
            let faults = plant.map(|plant| plant.infeasible(&recipe));
            let faults = faults.into_iter().flatten();
            faults.for_each(|fault| self.add(fault));
        }
    }
}
