//! `run --study grr`: gauge repeatability and reproducibility of the rig itself, on parts that are fed again.
//!
//! Ten parts go through three times, on three rigs: each "operator" is a rig with errors of its own,
//! calibrated and set by its golden parts as before any lot. The parts are the same ones (fault `parts_seed`
//! of the simulated rig), fed again in the same order (`refeed`), and operate a little differently every
//! time, as real ones do. Each rig's readings stay in the history as a lot of its own.

use super::{Controls, Orders, RunArgs, run_with};
use crate::cli::rig::RigArgs;
use config::load_recipe;
use history::{Archive, Filter};
use machine::dut::Characteristic;
use quality::average_range::average_and_range;
use quality::gauge_rr::{GaugeRr, Reading, anova};
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Rigs that take the place of operators; AIAG's customary number, as the two below.
const OPERATORS: u64 = 3;
/// How often each rig sees each part.
const TRIALS: u64 = 3;
/// Parts of the study unless `--count` says otherwise.
const PARTS: u64 = 10;

/// The rig of one operator: its own errors, the same parts fed again and again.
fn refed(rig: &RigArgs, operator: u64, parts: u64) -> RigArgs {
    let mut refed = rig.clone();
    refed.seed += operator;
    refed.fault.push(format!("refeed={parts}"));
    refed.fault.push(format!("parts_seed={}", rig.seed));
    refed
}

/// Runs the lots and tells the figures of every parameter; the result is the exit status of the last lot
/// that did not end well, else 0.
pub fn run(config: &Path, db: &Path, args: &RunArgs) -> anyhow::Result<i32> {
    let parts = args.count.unwrap_or(PARTS);
    anyhow::ensure!(
        parts >= 2,
        "--count: found {parts}, expected at least 2 parts for a study"
    );
    for operator in 1..=OPERATORS {
        let lot = RunArgs {
            lot: name(args, operator),
            count: Some(parts * TRIALS),
            rig: refed(&args.rig, operator, parts),
            study: None,
            json: false,
            ..args.clone()
        };
        let status = run_with(config, db, &lot, &Controls::new(true), Orders::Nobody)?;
        if status != crate::cli::DONE {
            return Ok(status);
        }
    }
    let measured = load_recipe(config, &args.recipe)?.kind().characteristics();
    tell(&Archive::open(db)?, args, parts, measured)?;
    Ok(crate::cli::DONE)
}

fn name(args: &RunArgs, operator: u64) -> String {
    format!("{}/{operator}", args.lot)
}

/// Readings of one parameter; a part that could not be measured leaves the study incomplete.
fn readings(
    archive: &Archive,
    args: &RunArgs,
    parts: u64,
    characteristic: Characteristic,
) -> anyhow::Result<Vec<Reading>> {
    let mut readings = Vec::new();
    for operator in 1..=OPERATORS {
        let lot = name(args, operator);
        let run = archive.lots(&of(&lot))?.last().map(|it| it.run);
        for part in archive.query(&Filter { run, ..of(&lot) })? {
            let value = part
                .values
                .get(characteristic.key())
                .and_then(serde_json::Value::as_f64);
            let place = part.seq - 1;
            readings.extend(value.map(|value| Reading {
                part: (place % parts + 1).to_string(),
                operator: operator.to_string(),
                trial: (place / parts + 1).to_string(),
                value,
            }));
        }
    }
    Ok(readings)
}

fn of(lot: &str) -> Filter {
    Filter {
        lot: Some(lot.to_owned()),
        ..Filter::default()
    }
}

fn tell(
    archive: &Archive,
    args: &RunArgs,
    parts: u64,
    characteristics: Vec<Characteristic>,
) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    if !args.json {
        writeln!(
            out,
            "{:<28} {:>12} {:>12} {:>12} {:>8} {:>6} {:>10}",
            "parameter", "repeat sd", "rigs sd", "parts sd", "% grr", "ndc", "% by range"
        )?;
    }
    for characteristic in characteristics {
        let readings = readings(archive, args, parts, characteristic)?;
        let (first, second) = (anova(&readings), average_and_range(&readings).ok());
        match (first, args.json) {
            (Ok(it), true) => {
                let it = json!({"type": "grr", "param": characteristic.key(), "anova": it, "average_range": second});
                writeln!(out, "{it}")?;
            }
            (Ok(it), false) => writeln!(out, "{}", line(characteristic, &it, second.as_ref()))?,
            (Err(why), true) => {
                let it = json!({"type": "grr", "param": characteristic.key(), "why_not": why.to_string()});
                writeln!(out, "{it}")?;
            }
            (Err(why), false) => writeln!(out, "{:<28} {why}", characteristic.key())?,
        }
    }
    Ok(())
}

fn line(characteristic: Characteristic, it: &GaugeRr, by_range: Option<&GaugeRr>) -> String {
    let percent = |it: Option<f64>| it.map_or("-".to_owned(), |it| format!("{it:.2}"));
    format!(
        "{:<28} {:>12.6} {:>12.6} {:>12.6} {:>8} {:>6} {:>10}",
        characteristic.key(),
        it.repeatability,
        it.reproducibility,
        it.part,
        percent(it.pct_grr),
        it.ndc.map_or("-".to_owned(), |it| it.to_string()),
        percent(by_range.and_then(|it| it.pct_grr)),
    )
}
