//! Judgements from the record of a test.

use super::{Context, TestRecord};
use crate::dut::em_relay::Parameter;
use crate::gauge::{Judgement, judge};

/// Returns each result against its limit, then the limits proven without a value.
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
    let proven = record.own.proven.iter().copied().filter(unmeasured);
    measured.chain(proven).collect()
}
