//! Arranges readings, in any order, as a full table: one reading for each combination of part, operator and trial.

use super::gauge_rr::{GaugeRrError, Reading};
use std::collections::{BTreeMap, BTreeSet};

/// Readings indexed by part, operator, trial.
pub(super) type Cells = Vec<Vec<Vec<f64>>>;

/// Arranges the readings by part, operator and trial. Fails when the study is too small or incomplete, or has a reading
/// twice.
pub(super) fn cells(readings: &[Reading]) -> Result<Cells, GaugeRrError> {
    let names = |of: fn(&Reading) -> &str| readings.iter().map(of).collect::<BTreeSet<&str>>();
    let (parts, operators) = (names(|it| &it.part), names(|it| &it.operator));
    let trials = names(|it| &it.trial);
    if parts.len() < 2 || operators.is_empty() || trials.len() < 2 {
        let (parts, operators, trials) = (parts.len(), operators.len(), trials.len());
        return Err(GaugeRrError::TooSmall {
            parts,
            operators,
            trials,
        });
    }
    let found = found(readings)?;
    let cell = |part: &str, operator: &str| {
        let reading = |trial: &&str| {
            found
                .get(&(part, operator, *trial))
                .copied()
                .ok_or_else(|| GaugeRrError::Missing {
                    part: part.to_owned(),
                    operator: operator.to_owned(),
                    trial: (*trial).to_owned(),
                })
        };
        trials.iter().map(reading).collect::<Result<Vec<f64>, _>>()
    };
    parts
        .iter()
        .map(|part| {
            operators
                .iter()
                .map(|operator| cell(part, operator))
                .collect()
        })
        .collect()
}

/// Largest reading allowed: the squares of such readings, and sums of them, stay finite in f64.
const LARGEST: f64 = 1e150;

fn found(readings: &[Reading]) -> Result<BTreeMap<(&str, &str, &str), f64>, GaugeRrError> {
    let mut found = BTreeMap::new();
    for it in readings {
        let key = (it.part.as_str(), it.operator.as_str(), it.trial.as_str());
        let (part, operator, trial) = (it.part.clone(), it.operator.clone(), it.trial.clone());
        let has_a_square = it.value.abs() < LARGEST;
        if !has_a_square {
            return Err(GaugeRrError::TooLarge {
                part,
                operator,
                trial,
            });
        }
        if found.insert(key, it.value).is_some() {
            return Err(GaugeRrError::Twice {
                part,
                operator,
                trial,
            });
        }
    }
    Ok(found)
}
