//! Stored values held against another recipe. Nothing is written: the old verdict stays what it was.
//!
//! What the values say is judged as in a run, with their stored uncertainty; a value within U of a limit
//! is `not proven`, for it cannot be measured again. What no value says (an open coil, a contact that did
//! not move, a refused reply) is not the recipe's business and stays.

use super::Part;
use crate::gauge::verdict::{Reason, failed_with, judge, of_part};
use crate::gauge::{Bin, Budget, Judgement, Parameter, Reading, Recipe, Verdict};

/// The verdict of `recipe` over what was measured on `part`.
pub fn rejudged(part: &Part, recipe: &Recipe) -> Verdict {
    let judged: Vec<(Parameter, Judgement)> = recipe
        .limits
        .iter()
        .map(|(parameter, limit)| {
            let reading = stored(part, parameter);
            (parameter, judge(&reading, &limit, recipe.decision.rule))
        })
        .collect();
    let by_values = of_part(&judged);
    let others: Vec<&String> = part.reasons.iter().filter(|it| !of_a_limit(it)).collect();
    match (part.verdict.as_str(), others.as_slice()) {
        ("fail", [first, ..]) => {
            let bin = part.bin.as_deref().and_then(Bin::from_name);
            let reason = Reason {
                text: (*first).clone(),
                bin: bin.unwrap_or(Bin::Retest),
            };
            let limits = match by_values {
                Verdict::Fail(reasons) => reasons,
                Verdict::Pass | Verdict::Void(_) => Vec::new(),
            };
            failed_with(&reason, limits)
        }
        ("void", [_, ..]) => match by_values {
            Verdict::Fail(reasons) => Verdict::Fail(reasons),
            Verdict::Pass | Verdict::Void(_) => {
                Verdict::Void(others.into_iter().cloned().collect())
            }
        },
        _ => by_values,
    }
}

/// Value and uncertainty as they were stored; without either it is no number.
fn stored(part: &Part, parameter: Parameter) -> Reading {
    let number = |map: &serde_json::Map<String, serde_json::Value>| {
        let number = map
            .get(parameter.name())
            .and_then(serde_json::Value::as_f64);
        number.unwrap_or(f64::NAN)
    };
    let expanded = number(&part.uncertainty);
    Reading {
        value: number(&part.values),
        budget: Budget::default().with("stored", expanded / 2.0),
    }
}

/// Reasons that [`of_part`] gives: they are about a limit, or about a value that is missing.
fn of_a_limit(reason: &str) -> bool {
    let Some((key, rest)) = reason.split_once(' ') else {
        return false;
    };
    let said = [
        "low",
        "high",
        "low not proven",
        "high not proven",
        "not measured",
    ];
    Parameter::from_name(key).is_some() && said.contains(&rest)
}
