//! From the record of a test to its judgements and its verdict.

use super::{Context, Stop, TestRecord};
use crate::dut::em_relay::Parameter;
use crate::dut::{Characteristic, Verdict};
use crate::gauge::{Judgement, judge};

/// Each result against its limit, then what was proven without a value.
pub(super) fn judged(context: &Context, record: &TestRecord) -> Vec<(Parameter, Judgement)> {
    let recipe = &context.recipe;
    let one = |parameter: &Parameter| {
        let reading = record.result(*parameter)?;
        let limit = recipe.limits.of(*parameter);
        let judgement = judge(&reading, &limit, recipe.decision.rule);
        Some((*parameter, judgement))
    };
    let measured = Parameter::ALL.iter().filter_map(one);
    let unmeasured = |(parameter, _): &(Parameter, Judgement)| record.attempts(*parameter) == 0;
    let proven = record.proven.iter().copied().filter(unmeasured);
    measured.chain(proven).collect()
}

/// Verdict of the part. A proven failure outweighs whatever ended the test early, but for trouble of the rig.
pub(super) fn verdict(stop: Option<&Stop>, judged: Vec<(Characteristic, Judgement)>) -> Verdict {
    let expected = Parameter::ALL.map(Characteristic::from);
    let Some(stop) = stop else {
        return Verdict::of(&expected, &judged);
    };
    let proven = |(_, judgement): &(Characteristic, Judgement)| match judgement {
        Judgement::Fail(_) => true,
        Judgement::Pass | Judgement::Conditional(_) | Judgement::Void => false,
    };
    let failed: Vec<_> = judged.into_iter().filter(proven).collect();
    match (stop, Verdict::of(&expected, &failed)) {
        (Stop::Trouble(why), _) => Verdict::Void(vec![why.clone()]),
        (Stop::Fail(reason), Verdict::Fail(reasons)) => Verdict::failed(reason.clone(), reasons),
        (Stop::Fail(reason), Verdict::Pass | Verdict::Void(_)) => {
            Verdict::Fail(vec![reason.clone()])
        }
        (Stop::Void(_), Verdict::Fail(reasons)) => Verdict::Fail(reasons),
        (Stop::Void(why), Verdict::Pass | Verdict::Void(_)) => Verdict::Void(vec![why.clone()]),
    }
}
