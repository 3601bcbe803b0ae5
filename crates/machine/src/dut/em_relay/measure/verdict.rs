//! Judgements from the record of a test.

use super::{Context, TestRecord};
use crate::dut::em_relay::Parameter;
use crate::gauge::Judgement;

/// Returns the judgement of each result against its limit, then those of limits that were proven without a value.
pub(super) fn judged(context: &Context, record: &TestRecord) -> Vec<(Parameter, Judgement)> {
    let mut judged = record.judged(&context.recipe, Parameter::ALL);
    let unmeasured = |(parameter, _): &(Parameter, Judgement)| record.attempts(*parameter) == 0;
    judged.extend(record.own.proven.iter().copied().filter(unmeasured));
    judged
}
