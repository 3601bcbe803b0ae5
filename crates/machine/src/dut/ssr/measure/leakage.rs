//! Leakage of the blocked output at its rated voltage, before and after conduction.

use super::board::{self, Position};
use super::given::{Given, NotDelivered};
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::accuracy::current;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{CurrentRange, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::instrument::act::Act;
use units::Unit;

/// Returns the acts of a leakage. The limit of the current is the end of the meter's range, so a part that conducts
/// takes no more, and the range never overflows. Two readings follow each other: the first also waits for the charge of
/// the output.
pub fn acts(state: &mut State, range: &CurrentRange, plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Direct);
    state.position = Position::Direct;
    acts.push(Act::Query(vec![
        points.off(Device::SmuIn),
        points.source_and_read(Device::SmuOut, plan.rated_v, range),
    ]));
    acts
}

/// Concludes a leakage.
pub fn conclude(
    state: &mut State,
    stage: Stage,
    plan: &Plan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let (of, range, finding) = match stage == Stage::HotLeakage {
        true => (Parameter::LeakageHot, &plan.leakage_hot, Finding::LeaksHot),
        false => (Parameter::LeakageCold, &plan.leakage_cold, Finding::Leaks),
    };
    let [numbers] = given.numbers(Device::SmuOut)?;
    let (ampere, moved) = Given::settled(Device::SmuOut, numbers)?;
    if range.is_limited(ampere) {
        state.suspected = Some(finding);
        return Ok(Next::Insert(Stage::StuckShort));
    }
    let budget = current(range, ampere, moved, 1e-6);
    state.found([(of, ampere / 1e-6, Unit::Microampere, budget)]);
    Ok(Next::Planned)
}
