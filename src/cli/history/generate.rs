//! `history generate`: a made-up history as large as a plant fills in weeks, for trying queries and reports.
//!
//! Parts follow the lot of the default world (means, scatter, 4 % defects), are judged by the recipe with
//! the very rules of a run, and come in lots of [`LOT`], at the pace of the rig, ending at `--until`. Five
//! of a hundred values took a second attempt. Rejects carry raw replies, good parts do not: a rig keeps
//! about thirty replies per part, which would make the file three times as large and no query slower.
//! Runs are marked as simulated. The same seed gives the same values.

mod made_up;

use clap::Args;
use config::load_recipe;
use history::{Identity, LotRecord, Moment, Row, Store};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use made_up::Line;
use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};

/// Parts of a lot: four hours of the line.
const LOT: u64 = 10_000;
/// Parts of one transaction.
const BATCH: u64 = 1_000;
/// Between two parts: 2,500 parts an hour.
const CYCLE_US: i64 = 1_440_000;

/// Arguments of `history generate`, as the study of the history gives them too.
#[derive(Debug, Clone, Args)]
pub struct GenerateArgs {
    /// How many parts
    #[arg(long, value_name = "N", default_value_t = 1_000_000,
        value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    pub parts: u64,
    /// Seed of all values
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Recipe that the parts are judged by
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    pub recipe: String,
    /// Instant of the last part (RFC 3339); now when absent
    #[arg(long, value_name = "TIME")]
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

/// Writes the parts into `db`, which may hold others already.
pub fn generate(config: &Path, db: &Path, args: &GenerateArgs) -> anyhow::Result<Generated> {
    let recipe = load_recipe(config, &args.recipe)?;
    let mut store = Store::open(db, &Identity::of_this_program())?;
    let until = args
        .until
        .map_or_else(|| jiff::Timestamp::now().as_microsecond(), |until| until.0);
    let begin = until - CYCLE_US * i64::try_from(args.parts)?;
    let mut line = Line::new(&recipe, args.seed);
    let bar = progress(args.parts);
    let mut done = Generated {
        parts: 0,
        measurements: 0,
        writing: Duration::ZERO,
    };
    while done.parts < args.parts {
        let name = format!("G{}-{:05}", args.seed, done.parts / LOT + 1);
        let opened_at_us = begin + CYCLE_US * i64::try_from(done.parts)?;
        store.begin_lot(&LotRecord {
            lot: name.clone(),
            recipe: recipe.name.clone(),
            recipe_snapshot: recipe.source_text.clone(),
            recipe_hash: recipe.hash.clone(),
            calibration_hash: None,
            opened_at_us,
            simulated: true,
            seed: Some(args.seed),
            retest: None,
        })?;
        let of_lot = LOT.min(args.parts - done.parts);
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
            bar.set_position(done.parts + seq);
        }
        done.parts += of_lot;
        let from = Instant::now();
        store.close_lot(&name, opened_at_us + CYCLE_US * i64::try_from(of_lot)?)?;
        done.writing += from.elapsed();
    }
    bar.finish_and_clear();
    Ok(done)
}

pub(super) fn run(config: &Path, db: &Path, args: &GenerateArgs) -> anyhow::Result<i32> {
    let done = generate(config, db, args)?;
    eprintln!(
        "{}: {} parts, {} measurements, {:.0} parts/s in transactions of {BATCH}",
        db.display(),
        done.parts,
        done.measurements,
        done.parts as f64 / done.writing.as_secs_f64()
    );
    Ok(0)
}

/// On stderr, and only where somebody looks.
pub fn progress(length: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(
        Some(length),
        if std::io::stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        },
    );
    let template = "{bar:40} {pos}/{len} {per_sec} {eta}";
    bar.with_style(
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
    )
}
