//! Gauge repeatability and reproducibility of the rig itself, on parts that are fed again.
//!
//! Ten parts go through three times, on three rigs: each "operator" is a rig with errors of its own,
//! calibrated and set by its golden parts as before any lot. The parts are the same ones (fault `parts_seed`
//! of the simulated rig), fed again in the same order (`refeed`), and operate a little differently every
//! time, as real ones do. Each rig's readings stay in the history as a lot of its own.

use super::exit::Exit;
use super::lot::{Purpose, Subscriber};
use super::order::{Files, LotOrder};
use super::source::RigSource;
use config::load_recipe;
use history::{Archive, Filter};
use machine::dut::Characteristic;
use quality::average_range::average_and_range;
use quality::gauge_rr::{GaugeRr, GaugeRrError, Reading, anova};

/// Rigs that take the place of operators; AIAG's customary number, as the two below.
const OPERATORS: u64 = 3;
/// How often each rig sees each part.
const TRIALS: u64 = 3;
/// Parts of the study unless `--count` says otherwise.
const PARTS: u64 = 10;

/// What the gauge adds to one parameter.
#[derive(Debug)]
pub struct Figure {
    /// The parameter.
    pub characteristic: Characteristic,
    /// By analysis of variance, or why there is no answer.
    pub anova: Result<GaugeRr, GaugeRrError>,
    /// By average and range, where that has an answer.
    pub by_range: Option<GaugeRr>,
}

/// The rig of one operator: its own errors, the same parts fed again and again.
fn refed(source: &RigSource, operator: u64, parts: u64) -> RigSource {
    let _ = (operator, parts);
    match source.clone() {
        #[cfg(feature = "sim")]
        RigSource::Simulated(mut rig) => {
            rig.faults.push(format!("refeed={parts}"));
            rig.faults.push(format!("parts_seed={}", rig.seed));
            rig.seed += operator;
            RigSource::Simulated(rig)
        }
        serial @ RigSource::Serial(_) => serial,
    }
}

/// Runs the lots named after `order`, and returns the figures of every parameter, or how the first lot ended that did
/// not end well.
///
/// # Errors
/// Bad input, as of any lot.
pub fn run(
    files: &Files,
    source: &RigSource,
    order: &LotOrder,
    outer: &mut dyn Subscriber,
) -> anyhow::Result<Result<Vec<Figure>, Exit>> {
    let parts = order.count.unwrap_or(PARTS);
    anyhow::ensure!(
        parts >= 2,
        "--count: found {parts}, expected at least 2 parts for a study"
    );
    for operator in 1..=OPERATORS {
        let lot = LotOrder {
            lot: name(order, operator),
            count: Some(parts * TRIALS),
            ..order.clone()
        };
        let source = refed(source, operator, parts);
        match super::run_lot(files, &source, &lot, Purpose::Lot, outer)? {
            Exit::Done => {}
            exit => return Ok(Err(exit)),
        }
    }
    let archive = Archive::open(&files.db)?;
    let measured = load_recipe(&files.config, &order.recipe)?.device.kind();
    let figures = measured.characteristics().into_iter().map(|it| {
        let readings = readings(&archive, order, parts, it)?;
        Ok(Figure {
            characteristic: it,
            anova: anova(&readings),
            by_range: average_and_range(&readings).ok(),
        })
    });
    Ok(Ok(figures.collect::<anyhow::Result<_>>()?))
}

fn name(order: &LotOrder, operator: u64) -> String {
    format!("{}/{operator}", order.lot)
}

/// Readings of one parameter; a part that could not be measured leaves the study incomplete.
fn readings(
    archive: &Archive,
    order: &LotOrder,
    parts: u64,
    characteristic: Characteristic,
) -> anyhow::Result<Vec<Reading>> {
    let mut readings = Vec::new();
    for operator in 1..=OPERATORS {
        let lot = name(order, operator);
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
