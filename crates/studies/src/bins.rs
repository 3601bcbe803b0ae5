//! Where the parts of a lot end: good parts rejected, bad parts passed, and rows that name another bin than the one
//! where the part lies; and the study `sorting`, which counts these over many lots.

use super::chart::Chart;
use super::exception;
use super::figure::{Bar, Figure, percent};
use super::lot::{Lot, Part};
use super::order::Order;
use super::output::Report;
use std::collections::BTreeMap;

/// Number of good parts in one lot of the figure `lots of 100 good parts without a reject`, whatever the size of the
/// lots that the study runs.
const GOOD_PARTS_OF_A_LOT: usize = 100;

/// Returns the bin to which a part with this defect belongs; `None` for an unknown defect.
pub fn bin_of(defect: &str) -> Option<&'static str> {
    Some(match defect {
        "open_coil" | "shorted_turns" | "wrong_coil" => "coil",
        "open" | "short" | "wrong_value" => "coil",
        "weak_spring" | "stiff_spring" => "voltage",
        "slow" | "bouncing" => "time",
        "stuck_nc" | "stuck_no" | "high_contact" | "unstable_contact" => "contact",
        "open_led" | "shorted_led" | "wrong_input_current" | "aged_led" => "input",
        "shorted_output" | "high_drop" | "thermal" | "stuck_on" => "output",
        "half_wave" | "half_short" | "no_zero_cross" => "output",
        "slow_turn_on" | "slow_turn_off" => "time",
        "leaky_junction" | "open_snubber" | "wrong_snubber" => "leakage",
        "turned" | "missing_pin" => "retest",
        _ => return None,
    })
}

/// Runs many lots and counts the rejected good parts and, for each defect, the parts that went to the bin of that
/// defect.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let (lots, about) = (order.run_all()?, order.about());
    let defects = defects(&lots);
    let title = format!("defects in the bin of their cause: {about}");
    let chart = Chart::of(title, "%", vec![100.0], &defects);
    let groups = vec![outcome(&lots), defects, machine(&lots)];
    Ok(Report::new("sorting", about, groups, chart).noted(exception::outcome(&lots)))
}

/// Compares verdicts and bins with the truth.
pub fn outcome(lots: &[Lot]) -> Vec<Figure> {
    let (good, beyond): (Vec<&Part>, Vec<&Part>) = lots
        .iter()
        .flat_map(Lot::good)
        .partition(|part| part.is_conforming());
    let all: Vec<&Part> = lots.iter().flat_map(|lot| &lot.parts).collect();
    let rejected: Vec<bool> = good.iter().map(|part| part.verdict == "fail").collect();
    let voids = good.iter().filter(|part| part.verdict == "void").count() as u64;
    let (clean, hundreds) = lots_without_reject(&rejected);
    let count = |is: fn(&Part) -> bool| all.iter().filter(|part| is(part)).count() as u64;
    let (n, n_good) = (all.len() as u64, good.len() as u64);
    let rejects = rejected.iter().filter(|it| **it).count() as u64;
    let unrecorded = lots.iter().map(|lot| lot.unrecorded).sum();
    vec![
        Figure::count("good parts rejected", n_good, Some(rejects)),
        Figure::new(
            "lots of 100 good parts without a reject",
            hundreds,
            percent(clean, hundreds),
            "%",
        )
        .bar(Bar::AtLeast(98.0)),
        Figure::new("voids of good parts", n_good, percent(voids, n_good), "%")
            .bar(Bar::Below(0.5)),
        out_of_limits(&beyond),
        Figure::none(
            "defective parts passed",
            count(|part| !part.is_good()),
            count(|part| !part.is_good() && part.has_passed()),
        ),
        Figure::none(
            "rows whose bin is not where the part is",
            n,
            count(|part| !part.is_in_named_bin()),
        ),
        Figure::none("parts without a row", n, unrecorded),
    ]
}

/// Counts the parts without a defect that have a true value beyond a limit, and how many of these passed.
fn out_of_limits(parts: &[&Part]) -> Figure {
    let passed = parts.iter().filter(|part| part.has_passed()).count();
    let n = parts.len() as u64;
    Figure::count("no defect, but truly beyond a limit", n, Some(n))
        .with("passed", Some(passed as f64))
}

/// Returns figures about the machine: counts of EEPROM writes, alarms and logged errors.
pub fn machine(lots: &[Lot]) -> Vec<Figure> {
    let n = lots.len() as u64;
    let writes: Option<u64> = lots.iter().map(|lot| lot.summary.eeprom_writes).sum();
    vec![
        Figure::count("EEPROM writes during the lots", n, writes).bar(Bar::AtMost(0.0)),
        Figure::none("alarms", n, lots.iter().map(|lot| lot.summary.alarms).sum()),
        Figure::none(
            "errors logged, touching bodies included",
            n,
            lots.iter().map(|lot| lot.errors_logged).sum(),
        ),
    ]
}

/// Returns one figure per defect: the share of its parts that went to the bin of the defect, percent.
pub fn defects(lots: &[Lot]) -> Vec<Figure> {
    let mut seen: BTreeMap<&str, (u64, u64)> = BTreeMap::new();
    for part in lots.iter().flat_map(|lot| &lot.parts) {
        let Some(defect) = part.defect() else {
            continue;
        };
        let (right, all) = seen.entry(defect).or_default();
        *all += 1;
        *right += u64::from(bin_of(defect) == Some(part.bin.as_str()));
    }
    let row = |(defect, (right, all)): (&str, (u64, u64))| {
        let bin = bin_of(defect).unwrap_or("no known bin");
        Figure::new(format!("{defect} in {bin}"), all, percent(right, all), "%")
            .bar(Bar::AtLeast(100.0))
    };
    seen.into_iter().map(row).collect()
}

/// Cuts the parts into lots of 100 in the order of production; returns the number of lots without a reject and the
/// number of lots. A remainder of fewer than 100 parts does not count; fewer than 100 parts in all count as one lot.
pub fn lots_without_reject(rejected: &[bool]) -> (u64, u64) {
    let size = GOOD_PARTS_OF_A_LOT.min(rejected.len()).max(1);
    let lots = rejected.chunks_exact(size);
    let clean = lots.clone().filter(|lot| !lot.contains(&true)).count();
    (clean as u64, lots.len() as u64)
}
