//! A made-up history as large as a plant fills in weeks, for trying queries and reports.
//!
//! Parts follow the lot of the default world (means, scatter, 4 % defects), are judged by the recipe with
//! the very rules of a run, and come in lots of [`LOT`], at the pace of the rig, ending at [`Wanted::until`]. Five
//! of a hundred values took a second attempt. Rejects carry raw replies, good parts do not: a rig keeps
//! about thirty replies per part, which would make the file three times as large and no query slower.
//! Runs are marked as simulated. The same seed gives the same values.

mod made_up;

use config::load_recipe;
use history::{Identity, LotRecord, Moment, Row, Store};
use made_up::Line;
use std::path::Path;
use std::time::{Duration, Instant};

/// Parts of a lot: four hours of the line.
const LOT: u64 = 10_000;
/// Parts of one transaction.
pub const BATCH: u64 = 1_000;
/// Between two parts: 2,500 parts an hour.
const CYCLE_US: i64 = 1_440_000;

/// What is to be made up.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// How many parts.
    pub parts: u64,
    /// Seed of all values.
    pub seed: u64,
    /// Recipe that the parts are judged by.
    pub recipe: String,
    /// Instant of the last part; none: now.
    pub until: Option<Moment>,
}

/// What was written, and how fast.
#[derive(Debug, Clone, Copy)]
pub struct Generated {
    /// Parts.
    pub parts: u64,
    /// Measurement rows.
    pub measurements: u64,
    /// Wall time of the transactions, disk flushes included; making the values up is not counted.
    pub writing: Duration,
}

/// Writes the parts into `db`, which may hold others already; `done_so_far` hears how many there are.
///
/// # Errors
/// A recipe that is refused, or a history that cannot be written.
pub fn generate(
    config: &Path,
    db: &Path,
    wanted: &Wanted,
    mut done_so_far: impl FnMut(u64),
) -> anyhow::Result<Generated> {
    let recipe = load_recipe(config, &wanted.recipe)?;
    let mut store = Store::open(db, &Identity::of_this_program())?;
    let until = wanted
        .until
        .map_or_else(|| jiff::Timestamp::now().as_microsecond(), |until| until.0);
    let begin = until - CYCLE_US * i64::try_from(wanted.parts)?;
    let mut line = Line::new(&recipe, wanted.seed);
    let mut done = Generated {
        parts: 0,
        measurements: 0,
        writing: Duration::ZERO,
    };
    while done.parts < wanted.parts {
        let name = format!("G{}-{:05}", wanted.seed, done.parts / LOT + 1);
        let opened_at_us = begin + CYCLE_US * i64::try_from(done.parts)?;
        store.begin_lot(&LotRecord {
            lot: name.clone(),
            recipe: recipe.name.clone(),
            recipe_snapshot: recipe.source_text.clone(),
            recipe_hash: recipe.hash.clone(),
            calibration_hash: None,
            opened_at_us,
            simulated: true,
            seed: Some(wanted.seed),
            retest: None,
        })?;
        let of_lot = LOT.min(wanted.parts - done.parts);
        let mut seq = 0;
        while seq < of_lot {
            let rows: Vec<Row> = (0..BATCH.min(of_lot - seq))
                .map(|n| line.part(&name, seq + n + 1, opened_at_us, CYCLE_US))
                .inspect(|part| done.measurements += part.measurements.len() as u64)
                .map(Row::Part)
                .collect();
            let from = Instant::now();
            store.record(&rows)?;
            done.writing += from.elapsed();
            seq += rows.len() as u64;
            done_so_far(done.parts + seq);
        }
        done.parts += of_lot;
        let from = Instant::now();
        store.close_lot(&name, opened_at_us + CYCLE_US * i64::try_from(of_lot)?)?;
        done.writing += from.elapsed();
    }
    Ok(done)
}
