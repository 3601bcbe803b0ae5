//! Conformity: the output blocks at the turn-off voltage and conducts at the turn-on voltage.
//!
//! The applied voltage keeps a guard band from the limit, on the side that is harder for the part. A part that fails
//! there is tried once more a guard band beyond the limit: if it obeys there, the limit is neither proven kept nor
//! proven exceeded.

use super::board::{self, Position};
use super::dc_stage::DcStage;
use super::given::{Given, NotDelivered};
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{DcPlan, LOAD_OHM, LOAD_V, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::gauge::{Judgement, Side};
use crate::instrument::act::Act;
use units::Span;

/// Share of the load current from which the output counts as conducting.
const ON: f64 = 0.9;

/// Returns true when the output conducts this current of the load circuit, A.
pub fn conducts(ampere: f64) -> bool {
    ampere >= ON * LOAD_V / LOAD_OHM
}

/// Returns true when the output blocks: the load current is at most the limit of the leakage plus the error of the
/// meter.
fn blocks(ampere: f64, plan: &Plan, dc: &DcPlan) -> bool {
    let meter = &plan.load.meter;
    let error_a = meter.offset + 3.0 * meter.noise_over(plan.load.periods);
    ampere.abs() <= dc.blocked_a + error_a
}

/// Returns the acts that bring the output to its source behind the load, with the input at its nominal voltage.
pub fn to_load(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Load);
    state.position = Position::Load;
    acts.push(Act::Query(vec![
        points.source(Device::SmuIn, plan.control_v, &plan.input),
        points.source(Device::SmuOut, LOAD_V, &plan.load),
    ]));
    acts
}

fn read(points: &Points, after_s: f64) -> [Act; 2] {
    [
        Act::Wait(Span::seconds(after_s)),
        Act::Query(vec![points.read(Device::SmuOut)]),
    ]
}

/// Returns the acts of the turn-off: on at the nominal voltage, then down to the limit.
pub fn block_acts(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = to_load(state, plan, points);
    acts.extend(read(points, plan.on_s));
    let level_v = plan
        .turn_off_v
        .map_or(0.0, |limit_v| limit_v + plan.guard_v);
    acts.push(Act::Query(vec![points.level(Device::SmuIn, level_v)]));
    acts.extend(read(points, plan.off_s));
    acts
}

/// Concludes the turn-off.
pub fn conclude_blocks(
    state: &mut State,
    plan: &Plan,
    dc: &DcPlan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let [on_a, off_a] = given.singles(Device::SmuOut)?;
    if !conducts(on_a) {
        state.record.stop(Finding::NeverOn);
    } else if blocks(off_a, plan, dc) {
        let proven = (Parameter::TurnOffVoltage, Judgement::Pass);
        state.proven.extend(plan.turn_off_v.map(|_| proven));
    } else if plan.turn_off_v.is_none() {
        state.record.stop(Finding::StuckOn);
    } else {
        return Ok(Next::Insert(Stage::Dc(DcStage::BlocksBeyond)));
    }
    Ok(Next::Planned)
}

/// Returns the acts of the turn-off a guard band beyond the limit, then without control.
pub fn block_beyond_acts(plan: &Plan, points: &Points) -> Vec<Act> {
    let level_v = plan
        .turn_off_v
        .map_or(0.0, |limit_v| limit_v - plan.guard_v);
    let step = points.step(Device::SmuIn, plan.control_v, level_v.max(0.0));
    let mut acts = vec![Act::Query(vec![step])];
    acts.extend(read(points, plan.off_s));
    acts.push(Act::Query(vec![points.level(Device::SmuIn, 0.0)]));
    acts.extend(read(points, plan.off_s));
    acts
}

/// Concludes the second try of the turn-off.
pub fn conclude_blocks_beyond(
    state: &mut State,
    plan: &Plan,
    dc: &DcPlan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let [beyond_a, without_a] = given.singles(Device::SmuOut)?;
    if !blocks(without_a, plan, dc) {
        state.record.stop(Finding::StuckOn);
    } else if blocks(beyond_a, plan, dc) {
        let judgement = Judgement::Conditional(Side::Low);
        state.proven.push((Parameter::TurnOffVoltage, judgement));
    } else {
        state.record.stop(Finding::ConductsBelowTurnOff);
    }
    Ok(Next::Planned)
}

/// Returns the acts of the turn-on at the limit plus `shift_v`, from 0 V.
pub fn conduct_acts(plan: &Plan, points: &Points, shift_v: f64) -> Vec<Act> {
    let level_v = plan.turn_on_v.unwrap_or(plan.control_v) + shift_v;
    let step = points.step(Device::SmuIn, 0.0, level_v);
    let mut acts = vec![Act::Query(vec![step])];
    acts.extend(read(points, plan.on_s));
    acts
}

/// Concludes the turn-on.
pub fn conclude_conducts(state: &mut State, given: &Given) -> Result<Next, NotDelivered> {
    let [on_a] = given.singles(Device::SmuOut)?;
    if !conducts(on_a) {
        return Ok(Next::Insert(Stage::Dc(DcStage::ConductsBeyond)));
    }
    let proven = (Parameter::TurnOnVoltage, Judgement::Pass);
    state.proven.push(proven);
    Ok(Next::Planned)
}

/// Concludes the second try of the turn-on.
pub fn conclude_conducts_beyond(state: &mut State, given: &Given) -> Result<Next, NotDelivered> {
    let [on_a] = given.singles(Device::SmuOut)?;
    if conducts(on_a) {
        let judgement = Judgement::Conditional(Side::High);
        state.proven.push((Parameter::TurnOnVoltage, judgement));
    } else {
        state.record.stop(Finding::BlocksAboveTurnOn);
    }
    Ok(Next::Planned)
}
