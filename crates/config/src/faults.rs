//! Every fault of a configuration, file by file.

use super::card::load_card;
use super::check::Faults;
use super::error::ConfigError;
use super::fleet::load_fleet;
use super::folder::Folder;
use super::instruments::{instrument_names, parse_instrument, read_instrument};
use super::keys;
use super::lot::load_lot;
use super::plant::{Plant, load_scene};
use super::recipes::{kind_of, parse_recipe, read_recipe, recipe_names};
use machine::form::Key;
use std::collections::BTreeSet;
use std::fmt;
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

/// Checks all files of `folder`. Compares values with each other only in a file whose keys are right, and a recipe with
/// the rig only when the files of the rig are right.
///
/// # Errors
/// Fails with every fault found.
pub fn check_all(folder: &Folder) -> Result<Plant, ConfigFaults> {
    let mut found = Found::default();
    found.rig(folder);
    for (name, keys) in [
        ("golden.toml", keys::golden::FILE),
        ("rack.toml", keys::golden::CERTIFICATE),
        ("lot.toml", keys::lot::FILE),
        ("card.toml", keys::card::FILE),
        ("fleet.toml", keys::fleet::FILE),
    ] {
        found.keys(folder, name, keys);
    }
    let plant = found.note(Plant::load(folder));
    if plant.as_ref().is_none_or(|plant| plant.scene.is_some()) {
        found.note(load_scene(folder));
    }
    found.note(load_lot(folder));
    found.note(load_card(folder));
    found.note(load_fleet(folder));
    for name in instrument_names(folder) {
        found.instrument(folder, &name);
    }
    for name in recipe_names(folder) {
        found.recipe(folder, plant.as_ref(), &name);
    }
    match plant {
        Some(plant) if found.faults.is_empty() => Ok(plant),
        Some(_) | None => Err(ConfigFaults(found.faults)),
    }
}

/// Faults found so far; a fault that two checks find is kept once.
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

    fn keys(&mut self, folder: &Folder, name: &str, keys: &[Key]) {
        // Loading reports a file that is missing or not TOML.
        if let Ok(file) = folder.file(name, "a file of the configuration") {
            file.faults(keys)
                .into_iter()
                .for_each(|fault| self.add(fault));
        }
    }

    fn rig(&mut self, folder: &Folder) {
        // Loading reports a file that is missing or not TOML.
        if let Ok(file) = folder.file("rig.toml", "the wiring of the rig") {
            let faults = file.faults(file.rig_keys()).into_iter();
            faults.for_each(|fault| self.add(fault));
        }
    }

    fn instrument(&mut self, folder: &Folder, name: &str) {
        let Some(file) = self.note(read_instrument(folder, name)) else {
            return;
        };
        let faults = file.faults(keys::instrument::FILE);
        faults.into_iter().for_each(|fault| self.add(fault));
        self.note(parse_instrument(file, name));
    }

    fn recipe(&mut self, folder: &Folder, plant: Option<&Plant>, name: &str) {
        let Some(file) = self.note(read_recipe(folder, name)) else {
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
