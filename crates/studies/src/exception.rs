//! Parts worth a look behind a figure, each with the seed and the part number that reproduce it.

use super::bins::bin_of;
use super::lot::{Lot, Part};

/// Largest number of parts that a report names; the figures count all of them.
const SHOWN: usize = 20;

/// Lists good parts that did not pass, out-of-limits and defective parts that passed, defects in the bin of another
/// cause, and rows that name another bin than the one where the part lies.
pub fn outcome(lots: &[Lot]) -> Vec<String> {
    listed(lots, |part| {
        let right = match part.defect() {
            None if part.is_out_of_limits => !part.has_passed(),
            None => part.is_good() && part.verdict == "pass",
            Some(defect) => bin_of(defect) == Some(part.bin.as_str()) && !part.has_passed(),
        };
        (!right || !part.is_in_named_bin()).then(String::new)
    })
}

/// Lists parts with a test longer than `test_s` or a cycle longer than `cycle_s`, seconds of rig time.
pub fn slow(lots: &[Lot], test_s: f64, cycle_s: f64) -> Vec<String> {
    let over = |time: Option<f64>, bar: f64| time.is_some_and(|time| time > bar);
    let text = |time: Option<f64>| time.map_or_else(|| "-".into(), |time| format!("{time:.3}"));
    listed(lots, |part| {
        (over(part.test_s, test_s) || over(part.cycle_s, cycle_s)).then(|| {
            format!(
                ", test {} s, cycle {} s",
                text(part.test_s),
                text(part.cycle_s)
            )
        })
    })
}

fn listed(lots: &[Lot], why: impl Fn(&Part) -> Option<String>) -> Vec<String> {
    let parts = lots
        .iter()
        .flat_map(|lot| lot.parts.iter().map(|part| (lot.seed, part)));
    let mut found =
        parts.filter_map(|(seed, part)| Some(format!("{}{}", description(seed, part), why(part)?)));
    let mut lines: Vec<String> = found.by_ref().take(SHOWN).collect();
    let more = found.count();
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    lines
}

fn description(seed: u64, part: &Part) -> String {
    let was = match part.defect() {
        Some(defect) => defect,
        None if part.truth.is_none() => "not known to the truth",
        None if part.is_out_of_limits => "beyond a limit",
        None => "good",
    };
    let bin = Some(part.bin.as_str()).filter(|bin| !bin.is_empty());
    let mut text = format!(
        "seed {seed} part {}: {was}, {}, row says {}, lies in {}",
        part.seq,
        part.verdict,
        bin.unwrap_or("nowhere"),
        part.landed_in().unwrap_or("nowhere"),
    );
    if !part.reasons.is_empty() {
        text.push_str(&format!(", because {}", part.reasons.join("; ")));
    }
    text
}
