//! Stored values and curves held against another recipe. Nothing is written: the old verdict stays what it was.
//!
//! - What the values say is judged as in a run, with their stored uncertainty; a value within U of a limit
//!   is `not proven`, for it cannot be measured again.
//! - What is stored at the reference temperature of its recipe is brought to the one of the other recipe.
//! - A characteristic without a value may still be proven too great by what was seen of the part ([`above`]).
//! - What neither says (an open circuit, a refused reply) is not the recipe's business and stays.
//! - Results are those of one kind and nominal voltage: a recipe with another one cannot judge them
//!   ([`Basis::misfit`]).

use super::Part;
use machine::dut::reason::Code;
use machine::dut::rejudge::{Basis, above, bounded};
use machine::dut::{Characteristic, Judgement, Reason, Recipe, Verdict};
use machine::gauge::{Budget, Reading, Side, judge};
use machine::instrument::curve::Curve;

/// The verdict of `recipe` over what was measured on `part` under a recipe of `basis`, and seen of it.
pub fn rejudged(part: &Part, curves: &[Curve], basis: Basis, recipe: &Recipe) -> Verdict {
    let judged: Vec<(Characteristic, Judgement)> = recipe
        .limits()
        .map(|(characteristic, limit)| {
            let reading = stored(part, characteristic, basis.factor(characteristic, recipe));
            let seen = |high| above(curves, characteristic, high, recipe);
            let judgement = match judge(&reading, &limit, recipe.decision.rule) {
                Judgement::Void if limit.high.is_some_and(seen) => Judgement::Fail(Side::High),
                judgement => judgement,
            };
            (characteristic, judgement)
        })
        .collect();
    let by_values = Verdict::of(&recipe.kind().characteristics(), &judged);
    let seen = |it| bounded(curves, it, recipe);
    let others = part.reason_codes.iter();
    let others: Vec<Reason> = others.filter(|it| !of_a_limit(it, seen)).cloned().collect();
    match (part.verdict.as_str(), others.as_slice()) {
        ("fail", [first, ..]) => {
            let limits = match by_values {
                Verdict::Fail(reasons) => reasons,
                Verdict::Pass | Verdict::Void(_) => Vec::new(),
            };
            Verdict::failed(first.clone(), limits)
        }
        ("void", [_, ..]) => match by_values {
            Verdict::Fail(reasons) => Verdict::Fail(reasons),
            Verdict::Pass | Verdict::Void(_) => Verdict::Void(others),
        },
        _ => by_values,
    }
}

/// Value and uncertainty as they were stored, at the other reference; without either it is no number.
fn stored(part: &Part, of: Characteristic, factor: f64) -> Reading {
    let number = |map: &serde_json::Map<String, serde_json::Value>| {
        let number = map.get(of.key()).and_then(serde_json::Value::as_f64);
        number.map_or(f64::NAN, |number| factor * number)
    };
    let expanded = number(&part.uncertainty);
    Reading {
        value: number(&part.values),
        unit: of.unit(),
        budget: Budget::default().with("stored", expanded / 2.0),
    }
}

/// Whether a reason speaks of a limit, or of a value that is missing: then the other recipe says it anew. A test that ended
/// because the contact did not move speaks of an upper limit too, where it was `seen`.
fn of_a_limit(reason: &Reason, seen: impl Fn(Characteristic) -> bool) -> bool {
    match reason.code {
        Code::OutsideLimit(_) | Code::NotProven(_) | Code::NotMeasured(_) => true,
        Code::EmRelay(_) | Code::Resistor(_) => {
            reason.side == Some(Side::High) && reason.characteristic().is_some_and(seen)
        }
        Code::Interrupted | Code::RigTrouble | Code::Unclassified => false,
    }
}
