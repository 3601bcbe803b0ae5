//! Gauge repeatability and reproducibility (AIAG) of the rig itself, on parts that the rig measures several times.
//!
//! Three simulated rigs take the place of the operators: each has errors of its own and is calibrated by its reference
//! parts, as before any lot. Each measures the same ten parts three times. The parts are the same (fault `parts_seed`
//! of the simulated rig), come in the same order (fault `refeed`), and operate a little differently each time, as real
//! parts do. The history keeps the readings of each rig as one lot.

use super::exit::Exit;
use super::lot::{Purpose, Subscriber};
use super::order::{Files, LotOrder};
use super::source::RigSource;
use config::load_recipe;
use history::{Archive, Filter};
use machine::dut::Characteristic;
use quality::average_range::average_and_range;
use quality::gauge_rr::{GaugeRr, GaugeRrError, Reading, anova};

/// Number of rigs, which take the place of operators. AIAG usually takes three operators, three trials and ten parts.
const OPERATORS: u64 = 3;
/// Number of times that each rig measures each part.
const TRIALS: u64 = 3;
/// Number of parts unless `--count` gives another.
const PARTS: u64 = 10;

/// Result of the study for one characteristic.
#[derive(Debug)]
pub struct Figure {
    /// The characteristic.
    pub characteristic: Characteristic,
    /// Result of the analysis of variance, or the reason why there is none.
    pub anova: Result<GaugeRr, GaugeRrError>,
    /// Result of the average and range method; `None` when the method fails.
    pub by_range: Option<GaugeRr>,
}

/// Returns the rig that takes the place of one operator: a rig with errors of its own that feeds the same parts again
/// and again. Returns a real rig unchanged.
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

/// Runs one lot per rig, named after `order`. Returns the figures of every characteristic, or the exit of the first lot
/// that did not complete.
///
/// # Errors
/// Fails on fewer than two parts, and on bad input, as any lot does.
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

/// Returns the readings of one characteristic; a part without a value leaves a gap, which the analysis refuses.
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
