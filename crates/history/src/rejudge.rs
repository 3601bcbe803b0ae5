//! Judges stored values and curves by another recipe; writes no row.
//!
//! - Judges values as a run does, with their stored uncertainty. A value within its uncertainty of a limit is
//!   `not proven`, because a confirmation measurement is no longer possible.
//! - Converts values at the reference temperature of the first recipe to the reference temperature of the other.
//! - When a characteristic has no value, its curves may prove that it exceeds the upper limit
//!   ([`machine::dut::characteristic::KindCharacteristic`]).
//! - Reasons that depend on no limit (an open circuit, a refused reply) stay.
//! - The other recipe must be for the same kind of part and the same nominal voltage ([`Basis::misfit`]).

use super::Part;
use machine::dut::reason::Code;
use machine::dut::rejudge::Basis;
use machine::dut::{Characteristic, Judgement, Reason, Recipe, Verdict};
use machine::gauge::{Budget, Reading, Side, judge};
use machine::instrument::curve::Curve;

/// Judges a part and its curves by `recipe`; `basis` describes the recipe by which the part was tested.
pub fn rejudged(part: &Part, curves: &[Curve], basis: Basis, recipe: &Recipe) -> Verdict {
    let bound = |it: Characteristic| it.lower_bound(curves, recipe.device.part().nominal_v);
    let judged: Vec<(Characteristic, Judgement)> = recipe
        .limits()
        .map(|(characteristic, limit)| {
            let reading = stored(part, characteristic, basis.factor(characteristic, recipe));
            let seen = |high| bound(characteristic).is_some_and(|bound| bound > high);
            let judgement = match judge(&reading, &limit, recipe.decision.rule) {
                Judgement::Void if limit.high.is_some_and(seen) => Judgement::Fail(Side::High),
                judgement => judgement,
            };
            (characteristic, judgement)
        })
        .collect();
    let by_values = Verdict::of(&recipe.device.kind().characteristics(), &judged);
    let seen = |it| bound(it).is_some();
    let others = part.reason_codes.iter();
    let others: Vec<Reason> = others.filter(|it| !is_limit(it, seen)).cloned().collect();
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

/// Returns stored value and uncertainty, both multiplied by `factor`; NaN for each that is missing.
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

/// Returns true for a reason that judging by the other recipe replaces, because the reason depends on a limit or on a
/// missing value. "The contact did not move" depends on a limit when the curves show, by `seen`, that the upper limit
/// is exceeded.
fn is_limit(reason: &Reason, seen: impl Fn(Characteristic) -> bool) -> bool {
    match reason.code {
        Code::OutsideLimit(_) | Code::NotProven(_) | Code::NotMeasured(_) => true,
        Code::Finding(_) => {
            reason.side == Some(Side::High) && reason.characteristic().is_some_and(seen)
        }
        Code::Interrupted | Code::RigTrouble | Code::Serial(_) | Code::Unclassified => false,
    }
}
