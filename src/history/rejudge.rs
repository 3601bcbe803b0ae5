//! Stored values and curves held against another recipe. Nothing is written: the old verdict stays what it was.
//!
//! - What the values say is judged as in a run, with their stored uncertainty; a value within U of a limit
//!   is `not proven`, for it cannot be measured again.
//! - Coil resistance and thresholds are stored at the reference temperature of their recipe; they are
//!   brought to the one of the other recipe.
//! - A parameter without a value may still be proven too great by what was seen of the part (`evidence.rs`).
//! - What neither says (an open coil, a refused reply) is not the recipe's business and stays.
//! - Thresholds and times are those of one nominal voltage: a recipe with another one cannot judge them
//!   ([`Basis::fits`]).

use super::evidence::{above, at_least};
use super::{Curve, Part};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::coil::to_reference;
use crate::dut::verdict::{Reason, Side, failed_with, judge, of_part};
use crate::dut::{Bin, Judgement, Recipe, Verdict};
use crate::gauge::{Budget, Reading};
use crate::units::Celsius;

/// What the stored values refer to: of the recipe that was in force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Basis {
    /// Coil voltage of timed operations, V.
    pub nominal_v: f64,
    /// Temperature that coil resistance and thresholds are brought to.
    pub reference: Celsius,
}

impl Basis {
    /// From the stored text of a recipe; none when it does not say.
    pub fn of(recipe: &str) -> Option<Self> {
        let recipe: toml::Table = recipe.parse().ok()?;
        let part = recipe.get("part")?;
        let number = |key: &str| {
            let value = part.get(key)?;
            value.as_float().or(value.as_integer().map(|it| it as f64))
        };
        Some(Self {
            nominal_v: number("nominal_v")?,
            reference: Celsius(number("reference_temperature_c")?),
        })
    }

    /// Of a recipe that is loaded.
    pub fn of_recipe(recipe: &Recipe) -> Self {
        Self {
            nominal_v: recipe.part.nominal_v,
            reference: Celsius(recipe.part.reference_temperature_c),
        }
    }

    /// Whether values on this basis can be judged by `recipe`.
    pub fn fits(&self, recipe: &Recipe) -> bool {
        (self.nominal_v - recipe.part.nominal_v).abs() < 1e-6 * self.nominal_v
    }

    /// Factor from a stored value to the one that `recipe` would have stored.
    fn factor(&self, parameter: Parameter, recipe: &Recipe) -> f64 {
        match parameter {
            Parameter::CoilResistance | Parameter::OperateVoltage | Parameter::ReleaseVoltage => {
                let wanted = Celsius(recipe.part.reference_temperature_c);
                to_reference(self.reference, wanted)
            }
            Parameter::OperateTime
            | Parameter::ReleaseTime
            | Parameter::OperateBounce
            | Parameter::ReleaseBounce
            | Parameter::ContactResistanceNo
            | Parameter::ContactResistanceNc => 1.0,
        }
    }
}

/// The verdict of `recipe` over what was measured on `part` under a recipe of `basis`, and seen of it.
pub fn rejudged(part: &Part, curves: &[Curve], basis: Basis, recipe: &Recipe) -> Verdict {
    let judged: Vec<(Parameter, Judgement)> = recipe
        .limits
        .iter()
        .map(|(parameter, limit)| {
            let reading = stored(part, parameter, basis.factor(parameter, recipe));
            let seen = |high| above(curves, parameter, high, recipe.part.nominal_v);
            let judgement = match judge(&reading, &limit, recipe.decision.rule) {
                Judgement::Void if limit.high.is_some_and(seen) => Judgement::Fail(Side::High),
                judgement => judgement,
            };
            (parameter, judgement)
        })
        .collect();
    let by_values = of_part(&judged);
    let seen = |parameter| at_least(curves, parameter, recipe.part.nominal_v).is_some();
    let others: Vec<&String> = part
        .reasons
        .iter()
        .filter(|it| !of_a_limit(it, seen))
        .collect();
    match (part.verdict.as_str(), others.as_slice()) {
        ("fail", [first, ..]) => {
            let bin = part.bin.as_deref().and_then(Bin::from_name);
            let reason = Reason {
                text: (*first).clone(),
                bin: bin.unwrap_or(Bin::RETEST),
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

/// Value and uncertainty as they were stored, at the other reference; without either it is no number.
fn stored(part: &Part, parameter: Parameter, factor: f64) -> Reading {
    let number = |map: &serde_json::Map<String, serde_json::Value>| {
        let number = map
            .get(parameter.name())
            .and_then(serde_json::Value::as_f64);
        number.map_or(f64::NAN, |number| factor * number)
    };
    let expanded = number(&part.uncertainty);
    Reading {
        value: number(&part.values),
        budget: Budget::default().with("stored", expanded / 2.0),
    }
}

/// Reasons that [`of_part`] gives: they are about a limit, or about a value that is missing. A test that
/// ended because the contact did not move says so after a colon; that is about a limit too, where it was `seen`.
fn of_a_limit(reason: &str, seen: impl Fn(Parameter) -> bool) -> bool {
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
    let parameter = Parameter::from_name(key);
    parameter.is_some_and(|it| said.contains(&rest) || rest.starts_with("high: ") && seen(it))
}
