//! Generates a history as large as weeks of production would make it, for trying queries and reports.
//!
//! The values are distributed as in a lot of the default simulated world (means, scatter, 4 % defects), and the recipe
//! judges them by the rules of a run. The parts come in lots of [`LOT`], one part every [`CYCLE_US`], and end at
//! [`GenerateOptions::until`]. Five per cent of the values have a second attempt. Only rejects carry raw replies: a rig
//! keeps about thirty replies per part, which would make the file three times as large and would slow no query. The
//! history marks the runs as simulated. The same seed gives the same values.

mod parts;

use config::{Folder, load_recipe};
use history::{LotRecord, Moment, Row, Store};
use parts::PartGenerator;
use std::path::Path;
use std::time::{Duration, Instant};

/// Parts per lot: production of four hours.
const LOT: u64 = 10_000;
/// Parts that one database transaction writes.
pub const BATCH: u64 = 1_000;
/// Time between two parts, microseconds: 2,500 parts an hour.
const CYCLE_US: i64 = 1_440_000;

/// Size and seed of the history to generate.
#[derive(Debug, Clone)]
pub struct GenerateOptions {
    /// Number of parts.
    pub parts: u64,
    /// Seed of all values.
    pub seed: u64,
    /// Recipe that judges the parts.
    pub recipe: String,
    /// Instant of the last part; `None`: now.
    pub until: Option<Moment>,
}

/// Number of rows written, and the time that writing took.
#[derive(Debug, Clone, Copy)]
pub struct Generated {
    /// Number of parts.
    pub parts: u64,
    /// Number of measurement rows.
    pub measurements: u64,
    /// Wall time of the database transactions, disk flushes included; drawing the values is not counted.
    pub writing: Duration,
}

/// Writes the parts into `db`, which may already hold others; calls `done_so_far` with the number of parts written.
///
/// # Errors
/// Fails on an invalid recipe, or when the history cannot be written.
pub fn generate(
    config: &Folder,
    db: &Path,
    wanted: &GenerateOptions,
    mut done_so_far: impl FnMut(u64),
) -> anyhow::Result<Generated> {
    let recipe = load_recipe(config, &wanted.recipe)?;
    let mut store = Store::open(db)?;
    let until = wanted
        .until
        .map_or_else(|| jiff::Timestamp::now().as_microsecond(), |until| until.0);
    let begin = until - CYCLE_US * i64::try_from(wanted.parts)?;
    let mut parts = PartGenerator::new(&recipe, wanted.seed);
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
                .map(|n| parts.part(&name, seq + n + 1, opened_at_us, CYCLE_US))
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
