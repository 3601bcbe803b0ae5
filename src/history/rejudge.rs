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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::config::load_recipe;
    use std::path::Path;

    fn recipe() -> Recipe {
        let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config");
        load_recipe(&config, "jzc-22f-012").unwrap()
    }

    /// A part in the middle of every limit but for its operate voltage.
    fn part(operate_v: f64, verdict: &str, reasons: &[&str]) -> Part {
        let mut part = Part::of_paper("A", 1, verdict);
        for (key, value) in [
            ("coil_resistance_ohm", 400.0),
            ("operate_voltage_v", operate_v),
            ("release_voltage_v", 2.3),
            ("operate_time_ms", 4.7),
            ("release_time_ms", 2.9),
            ("operate_bounce_ms", 0.4),
            ("release_bounce_ms", 0.5),
            ("contact_resistance_no_mohm", 18.0),
            ("contact_resistance_nc_mohm", 22.0),
        ] {
            part.values.insert(key.into(), value.into());
            part.uncertainty.insert(key.into(), 0.02.into());
        }
        part.reasons = reasons.iter().map(|it| (*it).to_owned()).collect();
        part
    }

    #[test]
    fn the_limits_of_the_other_recipe_decide_with_the_stored_uncertainty() {
        let recipe = recipe();
        assert_eq!(
            rejudged(&part(8.9, "fail", &["operate_voltage_v high"]), &recipe),
            Verdict::Pass
        );
        let bad = rejudged(&part(9.1, "pass", &[]), &recipe);
        assert_eq!(
            (bad.bin(), bad.reasons()),
            (Bin::Voltage, vec!["operate_voltage_v high".to_owned()])
        );
        let doubtful = rejudged(&part(8.99, "pass", &[]), &recipe);
        assert_eq!(doubtful.reasons(), ["operate_voltage_v high not proven"]);
    }

    #[test]
    fn what_no_value_says_stays() {
        let recipe = recipe();
        let mut open = part(8.0, "fail", &["coil open"]);
        open.bin = Some("coil".into());
        let again = rejudged(&open, &recipe);
        assert_eq!(
            (again.bin(), again.reasons()),
            (Bin::Coil, vec!["coil open".to_owned()])
        );
        let void = rejudged(&part(8.0, "void", &["reply refused"]), &recipe);
        assert_eq!(void, Verdict::Void(vec!["reply refused".into()]));
    }

    #[test]
    fn a_value_that_was_never_had_is_void_and_never_passes() {
        let mut part = part(8.0, "pass", &[]);
        part.values.remove("operate_time_ms");
        let again = rejudged(&part, &recipe());
        assert_eq!(
            again,
            Verdict::Void(vec!["operate_time_ms not measured".into()])
        );
    }
}
