//! Runs a lot of temperature relays by the whole program on the simulated rig, in virtual time, inside this process.

use crate::dice::Dice;
use crate::storm::life::{End, Runner};
use crate::storm::scenario::Life;
use anyhow::Context;
use config::{Folder, Plant, load_recipe};
use history::{Archive, Filter, Part};
use rigsim::Options;
use rigsim::journal::Entry;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use tempfile::TempDir;

/// Rig time after which a lot that has not ended counts as hung, s.
const LONGEST_S: u64 = 6 * 3600;
const SECOND_US: u64 = 1_000_000;

/// A change of the configuration: another text in place of one that a file must contain.
#[derive(Debug, Clone)]
pub struct Change {
    /// Name of the file in the folder of the rig.
    pub file: &'static str,
    /// Text in that file.
    pub from: &'static str,
    /// Text in its place.
    pub to: String,
}

/// A lot to run.
#[derive(Debug, Clone)]
pub struct Lot {
    /// Recipe of the parts.
    pub recipe: &'static str,
    /// Number of parts.
    pub parts: u64,
    /// Seed of rig and parts.
    pub seed: u64,
    /// Faults, as `--fault` takes them.
    pub faults: Vec<String>,
    /// What differs from the configuration that comes with the program.
    pub changes: Vec<Change>,
}

/// A lot that has run.
#[derive(Debug)]
pub struct Ran {
    /// How the program ended; [`End::Killed`] when the study killed it because it did not end in time.
    pub end: End,
    /// Rows of the parts.
    pub parts: Vec<Part>,
    /// Truth about the parts.
    pub truth: Vec<Value>,
    /// Changes of outputs, in order of time.
    pub journal: Vec<Entry>,
    /// Writes to the EEPROM of any module during the lot.
    pub eeprom_writes: u64,
    /// Rig time of the lot, min.
    pub minutes: f64,
    /// Wall time of the lot, s.
    pub wall_s: f64,
}

/// Runs a lot.
///
/// # Errors
/// Fails when the configuration does not load, a change does not fit, or the rig cannot be built.
pub fn run(lot: &Lot) -> anyhow::Result<Ran> {
    let place = TempDir::new()?;
    let folder = folder(place.path(), &lot.changes)?;
    let (plant, recipe) = (Plant::load(&folder)?, load_recipe(&folder, lot.recipe)?);
    let rig = rigsim::build(&Options {
        files: app::simulated::files(&folder),
        world: None,
        seed: lot.seed,
        recipe: lot.recipe.into(),
        parts: Some(lot.parts),
        reference_parts: false,
        faults: lot.faults.clone(),
    })?;
    let (journal, writes) = (rig.journal(), rig.eeprom_writes());
    let db = place.path().join("history.db");
    let runner = Runner {
        plant: &plant,
        recipe: &Arc::new(recipe),
        db: &db,
        rig: &rig,
    };
    let life = Life {
        killed_after_us: Some(LONGEST_S * SECOND_US),
        ..Life::calm(lot.parts, SECOND_US)
    };
    let from = Instant::now();
    let life = runner.run_life("A", &life, None, Dice::new(0))?;
    let wall_s = from.elapsed().as_secs_f64();
    let archive = Archive::open(&db)?;
    Ok(Ran {
        end: life.end,
        parts: archive.query(&Filter::default())?,
        truth: rig.truth(),
        journal: journal.try_iter().collect(),
        eeprom_writes: rig.eeprom_writes() - writes,
        minutes: (life.ended_us - life.began_us) as f64 / SECOND_US as f64 / 60.0,
        wall_s,
    })
}

/// Returns the configuration of the rig that comes with the program, with these changes; `place` takes the changed files.
///
/// # Errors
/// Fails when a change does not fit, or a file cannot be written.
pub fn folder(place: &Path, changes: &[Change]) -> anyhow::Result<Folder> {
    let built_in =
        Folder::built_in_rig("thermostat").context("a rig that comes with the program")?;
    let Folder::Memory(memory) = &built_in else {
        return Ok(built_in);
    };
    if changes.is_empty() {
        return Ok(built_in);
    }
    let mut texts = memory.texts();
    for Change { file, from, to } in changes {
        let text = texts
            .get_mut(*file)
            .with_context(|| format!("no file {file}"))?;
        anyhow::ensure!(text.contains(from), "{file} does not hold {from:?}");
        *text = text.replacen(from, to, 1);
    }
    let dir = place.join("config");
    for (name, text) in &texts {
        let path = dir.join(name);
        let parent = path.parent().context("a file in a folder")?;
        std::fs::create_dir_all(parent)?;
        std::fs::write(&path, text)?;
    }
    Ok(Folder::from(dir.as_path()))
}

impl Ran {
    /// Returns the truth about a part.
    pub fn truth_of(&self, part: &Part) -> Option<&Value> {
        self.truth.iter().find(|it| it["seq"] == part.seq)
    }

    /// Returns whether a part has no defect.
    pub fn is_good(&self, part: &Part) -> bool {
        self.truth_of(part).is_some_and(|it| it["defect"].is_null())
    }
}
