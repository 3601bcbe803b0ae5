//! The storm over batches: each seed draws a rig, a lot of a few parts, faults of chamber and line at random instants, and
//! perhaps a kill of the program. A second start looks at what the first life has left. `judge` lists the broken rules.
//!
//! | file | has |
//! |---|---|
//! | `scenario` | what a seed draws |
//! | `judge` | the rules |

mod judge;
mod scenario;

use super::kill::rack_c;
use super::program::{Change, folder};
use crate::dice::Dice;
use crate::figure::Figure;
use crate::pool::{self, LOTS_AT_ONCE};
use crate::storm::life::{EndedLife, Runner};
use crate::storm::scenario::Life;
use config::{Folder, Plant, load_recipe};
use history::{Archive, Filter, Part};
use judge::Rule;
use rigsim::Options;
use rigsim::journal::Entry;
use scenario::Scenario;
use serde_json::Value;
use std::sync::Arc;
use tempfile::TempDir;
use tracing::subscriber::{NoSubscriber, with_default};

const RECIPE: &str = "thermostat-ksd9700";
/// Rig time after which a life that has not ended counts as hung, s.
const LONGEST_S: u64 = 6 * 3_600;
/// Life of the second start, s.
const LOOK_S: u64 = 30;
const SECOND_US: u64 = 1_000_000;

/// Everything that a seed has left.
pub struct Case {
    scenario: Scenario,
    /// The first life, and the second start.
    lives: [EndedLife; 2],
    /// Time of the host watchdogs, microseconds.
    watchdog_us: u64,
    /// Temperature of the rack below which the door may be unlocked, C.
    unlock_below_c: f64,
    /// Temperature of the rack as its module reports it, before and after the second start, C; `None` without an answer.
    rack_c: [Option<f64>; 2],
    /// Rows of the first life.
    rows: Vec<Part>,
    truth: Vec<Value>,
    journal: Vec<Entry>,
    /// Writes to the EEPROM of any module in the first life.
    eeprom_writes: u64,
}

/// A broken rule of a seed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Broken {
    /// The rule.
    pub rule: Rule,
    /// Seed, faults and what was found.
    pub text: String,
}

/// Runs the seeds; returns the broken rules.
///
/// # Errors
/// Fails when the configuration does not load, or a rig cannot be built.
pub fn storms(seeds: impl Iterator<Item = u64>) -> anyhow::Result<Vec<Broken>> {
    let place = TempDir::new()?;
    let folder = folder(place.path(), &quick())?;
    let plant = Plant::load(&folder)?;
    let seeds: Vec<u64> = seeds.collect();
    let found = pool::map(&seeds, LOTS_AT_ONCE, |seed| {
        // A log line for each alarm would bury the report.
        let case = with_default(NoSubscriber::new(), || case(&folder, &plant, *seed))?;
        let broken = case.broken().into_iter();
        let of = |(rule, what): (Rule, String)| Broken {
            rule,
            text: format!("seed {seed}, {}: {what}", case.scenario),
        };
        Ok(broken.map(of).collect::<Vec<Broken>>())
    })?;
    Ok(found.into_iter().flatten().collect())
}

/// Returns the figures of `count` seeds, and a line for each broken rule.
///
/// # Errors
/// Fails as [`storms`] does.
pub fn figures(count: u64) -> anyhow::Result<(Vec<Figure>, Vec<String>)> {
    let broken = storms(1..=count)?;
    let figure = |rule: &Rule| {
        let times = broken.iter().filter(|it| it.rule == *rule).count();
        Figure::none(format!("storm, {}", rule.text()), count, times as u64)
    };
    let figures = Rule::ALL.iter().map(figure).collect();
    Ok((figures, broken.into_iter().map(|it| it.text).collect()))
}

/// Returns the changes that keep a batch short: two passes, or one.
fn quick() -> Vec<Change> {
    let change = |from, to: &str| Change {
        file: "recipes/thermostat-ksd9700.toml",
        from,
        to: to.to_owned(),
    };
    vec![
        change("scatter_passes = 3 ", "scatter_passes = 0 "),
        change("repeatability_k = { high = 1.0 }", "repeatability_k = {  }"),
    ]
}

fn case(folder: &Folder, plant: &Plant, seed: u64) -> anyhow::Result<Case> {
    let scenario = Scenario::of(seed, &plant.wiring);
    let rig = rigsim::build(&Options {
        files: app::simulated::files(folder),
        world: None,
        seed,
        recipe: RECIPE.into(),
        parts: Some(scenario.parts),
        reference_parts: false,
        faults: scenario.faults(),
    })?;
    let (journal, writes) = (rig.journal(), rig.eeprom_writes());
    let place = TempDir::new()?;
    let db = place.path().join("history.db");
    let runner = Runner {
        plant,
        recipe: &Arc::new(load_recipe(folder, RECIPE)?),
        db: &db,
        rig: &rig,
    };
    let live = |lot: &str, seconds: u64| {
        let life = Life {
            killed_after_us: Some(seconds * SECOND_US),
            ..Life::calm(scenario.parts, SECOND_US)
        };
        runner.run_life(lot, &life, None, Dice::new(0))
    };
    let first = live("A", scenario.killed_after_s.unwrap_or(LONGEST_S))?;
    // The second start may write: it clears and sets the watchdogs that the end of the first one let expire.
    let eeprom_writes = rig.eeprom_writes() - writes;
    let watchdog_us = (plant.wiring.bus.host_watchdog_ms * 1e3) as u64;
    rig.advance(rig.now_us() + watchdog_us + SECOND_US);
    let before = rack_c(&rig).ok();
    let second = live("B", LOOK_S)?;
    let rack_c = [before, rack_c(&rig).ok()];
    let rows = Archive::open(&db)?.query(&Filter {
        lot: Some("A".into()),
        ..Filter::default()
    })?;
    Ok(Case {
        lives: [first, second],
        rack_c,
        watchdog_us,
        unlock_below_c: plant.wiring.rack().map_or(0.0, |it| it.unlock_below.0),
        rows,
        truth: rig.truth(),
        journal: journal.try_iter().collect(),
        eeprom_writes,
        scenario,
    })
}
