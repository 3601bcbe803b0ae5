//! Checks that every value belongs to the body of its row and that the verdict agrees with the truth. Only complete
//! tests count: an interrupted one has no verdict.

use super::Case;
use super::bodies::owners;
use crate::bins::bin_of;
use history::Part;
use machine::dut::Characteristic;
use machine::rig::bin::Bin;
use rigsim::truth::PartTruth;
use serde_json::Value;

/// Distance from the truth, in expanded uncertainties (k = 2), beyond which a value must belong to another body: eight
/// standard deviations, which a normal error exceeds once in 8 * 10^14 values.
const FOREIGN_K: f64 = 4.0;
/// Distance from a limit, in expanded uncertainties (k = 2), beyond which a true value is clearly inside or outside.
const CLEAR_K: f64 = 2.0;

pub fn violations(case: &Case) -> Vec<String> {
    let mut violations = Vec::new();
    for (row, number) in owners(case).0 {
        let body = &case.bodies[number];
        if body.is_reference || !matches!(row.verdict.as_str(), "pass" | "fail") {
            continue;
        }
        let truth = serde_json::to_value(&body.part).unwrap_or_default();
        let readings: Vec<Reading> = case
            .limits
            .iter()
            .filter_map(|(of, _)| Reading::of(*of, row, &truth))
            .collect();
        let found = foreign_value(&readings, &body.part)
            .into_iter()
            .chain(misjudged(case, row, &readings, &body.part));
        violations.extend(found.map(|what| format!("part {} of {}: {what}", row.seq, row.lot)));
    }
    violations
}

/// A measured value and its truth.
struct Reading {
    of: Characteristic,
    value: f64,
    expanded: f64,
    truth: f64,
}

impl Reading {
    fn of(of: Characteristic, row: &Part, truth: &Value) -> Option<Self> {
        let key = of.key();
        Some(Self {
            of,
            value: row.values.get(key)?.as_f64()?,
            expanded: row.uncertainty.get(key)?.as_f64()?,
            truth: truth[key].as_f64()?,
        })
    }

    /// Returns the bin for parts that fail this characteristic.
    fn bin(&self) -> Bin {
        self.of.bin()
    }
}

fn foreign_value(readings: &[Reading], part: &PartTruth) -> Option<String> {
    let far = |it: &&Reading| {
        let defined = part.defect.is_none_or(|defect| has_truth(defect, it));
        defined && (it.value - it.truth).abs() > FOREIGN_K * it.expanded
    };
    let it = readings.iter().find(far)?;
    let (key, value, truth, u) = (it.of.key(), it.value, it.truth, it.expanded);
    Some(format!(
        "{key} {value} +- {u} cannot be of a part with {truth}"
    ))
}

/// Returns true when a characteristic of a part with this defect has a single true value.
fn has_truth(defect: &str, reading: &Reading) -> bool {
    match defect {
        // The resistance differs at every closure.
        "unstable_contact" => reading.bin().name() != "contact",
        // It depends on the phase of the line at which the control comes.
        "no_zero_cross" => !["t_on_us", "v_zc_v"].contains(&reading.of.key()),
        // It doubles every ten kelvins, and the part cools before the reading.
        "leaky_junction" | "thermal" => reading.of.key() != "i_leak_hot_ua",
        // It turns on later than a search waits near the threshold, and is hardly on when a pulse ends.
        "slow_turn_on" => !["v_on_v", "v_off_v", "t_off_us"].contains(&reading.of.key()),
        "slow_turn_off" => reading.of.key() != "v_off_v",
        _one => true,
    }
}

fn misjudged(case: &Case, row: &Part, readings: &[Reading], part: &PartTruth) -> Option<String> {
    // Distance of the truth from the nearer limit; positive inside the range.
    let inside = |it: &Reading| {
        let own = case.limits.iter().find(|(known, _)| *known == it.of);
        own.map_or(f64::INFINITY, |(_, range)| {
            (it.truth - range.start()).min(range.end() - it.truth)
        })
    };
    let clear = |it: &Reading| inside(it) > CLEAR_K * it.expanded;
    let beyond = |it: &&Reading| -inside(it) > CLEAR_K * it.expanded;
    match (row.verdict.as_str(), part.defect) {
        ("pass", Some(defect)) => Some(format!("passed with {defect}")),
        ("pass", None) => readings
            .iter()
            .find(beyond)
            .map(|it| format!("passed with a true {} of {}", it.of.key(), it.truth)),
        (_, Some(defect)) => {
            let right = bin_of(defect).unwrap_or("");
            let named = row.bin.as_deref().unwrap_or("");
            let near = readings.iter().any(|it| !clear(it) && !beyond(&it));
            let also_beyond = || {
                readings
                    .iter()
                    .filter(beyond)
                    .any(|it| it.bin().name() == named)
            };
            (named != right && !near && !also_beyond())
                .then(|| format!("{defect} belongs to {right}, its row says {named}"))
        }
        (_, None) => readings
            .iter()
            .all(clear)
            .then(|| format!("a good part failed: {:?}", row.reasons)),
    }
}
