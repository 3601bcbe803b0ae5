//! Conformity: after a step of the control to the turn-off voltage the output blocks within its turn-off time, and after
//! a step to the turn-on voltage it conducts within its turn-on time.
//!
//! The digitizer records the output from the step on. Blocking also means that the load current is at most the leakage.
//! The applied voltage keeps a guard band from the limit, on the side that is harder for the part. When a part fails
//! there, the test tries once more a guard band beyond the limit: if the part obeys there, the limit is neither proven
//! kept nor proven exceeded. If it obeys there, but too late, the pulse at the nominal voltage shows whether its time
//! is wrong or its voltage.

use super::board::{self, Position};
use super::dc_stage::DcStage;
use super::given::{Given, NotDelivered};
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{DcPlan, LOAD_OHM, LOAD_V, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::ANSWER;
use crate::gauge::{Judgement, Side};
use crate::instrument::act::Act;
use crate::instrument::query::Query;
use units::Span;

/// Share of the load from which the output counts as on.
pub const ON: f64 = 0.9;
/// Share of the load up to which it counts as off.
pub const OFF: f64 = 0.1;
/// Length of the stretch after the time limit whose samples show whether the output has answered in time, as a share of
/// the limit.
const AT: f64 = 0.05;
/// Number of time limits after which an output that has not answered counts as one that never does.
const LATE: f64 = 20.0;
/// Time beyond the length of a record until the digitizer has stored it.
const STORED: Span = Span::ms(2);

/// Returns true when the output is on: the load carries at least 90 % of its current, A.
pub fn is_on(ampere: f64) -> bool {
    ampere >= ON * LOAD_V / LOAD_OHM
}

/// Returns true when the output is off: the load carries at most 10 % of its current, A.
pub fn is_off(ampere: f64) -> bool {
    ampere.abs() <= OFF * LOAD_V / LOAD_OHM
}

/// Returns true when the output blocks: the load current is at most the limit of the leakage plus the error of the
/// meter.
fn blocks(ampere: f64, plan: &Plan, dc: &DcPlan) -> bool {
    let meter = &plan.load.meter;
    let error_a = meter.offset + 3.0 * meter.noise_over(plan.load.periods);
    ampere.abs() <= dc.blocked_a + error_a
}

/// Returns the share of the load voltage that the record of the digitizer shows before the step.
fn load_before(given: &Given) -> Result<f64, NotDelivered> {
    load_between(given, (f64::NEG_INFINITY, 0.0))
}

/// Returns the share of the load voltage that the record of the digitizer shows at the end of a time limit.
fn load_at(given: &Given, limit_s: f64) -> Result<f64, NotDelivered> {
    load_between(given, (limit_s, (1.0 + AT) * limit_s))
}

fn load_between(given: &Given, (from_s, to_s): (f64, f64)) -> Result<f64, NotDelivered> {
    let [output] = given.waveforms()?;
    let index = |at_s: f64| ((at_s - output.start_s) / output.step_s).ceil().max(0.0) as usize;
    let at = index(from_s)..index(to_s);
    let samples = output.volts.get(at).unwrap_or_default();
    let sum: f64 = samples.iter().map(|it| f64::from(*it)).sum();
    let volts = sum / samples.len() as f64;
    let is_usable = !samples.is_empty() && volts.is_finite();
    let share = is_usable.then_some(1.0 - volts / LOAD_V);
    share.ok_or(NotDelivered(Device::Digitizer))
}

/// Returns the acts that bring the output to its source behind the load, with the input at its nominal voltage; `besides`
/// goes to another instrument meanwhile.
pub fn to_load(
    state: &mut State,
    plan: &Plan,
    points: &Points,
    besides: Option<Query>,
) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Load);
    state.position = Position::Load;
    let sources = [
        points.source(Device::SmuIn, plan.control_v, &plan.input),
        points.source(Device::SmuOut, LOAD_V, &plan.load),
    ];
    acts.push(Act::Query(sources.into_iter().chain(besides).collect()));
    acts
}

fn read(points: &Points, after_s: f64) -> [Act; 2] {
    [
        Act::Wait(Span::seconds(after_s)),
        Act::Query(vec![points.read(Device::SmuOut)]),
    ]
}

/// Returns the acts that set the control to a level, on which the digitizer triggers, and read the record of the answer
/// together with the load current.
fn answer(points: &Points, level_v: f64, within_s: f64) -> [Act; 3] {
    [
        Act::Query(vec![points.level(Device::SmuIn, level_v)]),
        Act::Wait(Span::seconds(ANSWER * within_s) + STORED),
        Act::Query(vec![
            points.complete(),
            points.answer(),
            points.read(Device::SmuOut),
        ]),
    ]
}

/// Returns the acts that bring the control to the first of two levels for some time, while the digitizer prepares for the
/// step to the second.
fn prepare(points: &Points, step_v: (f64, f64), (within_s, before_s): (f64, f64)) -> [Act; 2] {
    [
        Act::Query(vec![
            points.level(Device::SmuIn, step_v.0),
            points.capture_answer(step_v, within_s),
        ]),
        Act::Wait(Span::seconds(before_s)),
    ]
}

/// Returns the acts of the turn-off: on at the nominal voltage, then down to the limit.
pub fn block_acts(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    let level_v = plan
        .turn_off_v
        .map_or(0.0, |limit_v| limit_v + plan.guard_v);
    let capture = points.capture_answer((plan.control_v, level_v), plan.off_s);
    let mut acts = to_load(state, plan, points, Some(capture));
    acts.push(Act::Wait(Span::seconds(plan.on_s)));
    acts.extend(answer(points, level_v, plan.off_s));
    acts
}

/// Concludes the turn-off.
pub fn conclude_blocks(
    state: &mut State,
    plan: &Plan,
    dc: &DcPlan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let [off_a] = given.singles(Device::SmuOut)?;
    let is_in_time = load_at(given, plan.off_s)? <= OFF;
    if load_before(given)? < ON {
        state.record.stop(Finding::NeverOn);
    } else if is_in_time && blocks(off_a, plan, dc) {
        let proven = (Parameter::TurnOffVoltage, Judgement::Pass);
        state.proven.extend(plan.turn_off_v.map(|_| proven));
    } else {
        return Ok(Next::Insert(Stage::Dc(DcStage::BlocksBeyond)));
    }
    Ok(Next::Planned)
}

/// Returns the acts of the second try of the turn-off: a step to a guard band below the limit, a reading of the load
/// current 20 time limits later, and one without control voltage.
pub fn block_beyond_acts(plan: &Plan, points: &Points) -> Vec<Act> {
    let level_v = plan
        .turn_off_v
        .map_or(0.0, |limit_v| limit_v - plan.guard_v)
        .max(0.0);
    let mut acts = prepare(points, (plan.control_v, level_v), (plan.off_s, plan.on_s)).to_vec();
    acts.extend(answer(points, level_v, plan.off_s));
    acts.extend(read(points, LATE * plan.off_s));
    acts.push(Act::Query(vec![points.level(Device::SmuIn, 0.0)]));
    acts.extend(read(points, LATE * plan.off_s));
    acts
}

/// Concludes the second try of the turn-off.
pub fn conclude_blocks_beyond(
    state: &mut State,
    plan: &Plan,
    dc: &DcPlan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let [beyond_a, late_a, without_a] = given.singles(Device::SmuOut)?;
    let is_in_time = load_at(given, plan.off_s)? <= OFF;
    let blocks = |ampere| blocks(ampere, plan, dc);
    let is_in_time = is_in_time && blocks(beyond_a);
    if !blocks(without_a) {
        state.record.stop(Finding::StuckOn);
    } else if !blocks(late_a) && plan.turn_off_v.is_some() {
        state.record.stop(Finding::ConductsBelowTurnOff);
    } else if !is_in_time && plan.bounds(Parameter::TurnOffTime) {
        let late = plan.turn_off_v.map(|_| Parameter::TurnOffVoltage);
        state.late.extend(late);
    } else {
        let near = (Parameter::TurnOffVoltage, Judgement::Conditional(Side::Low));
        state.proven.extend(plan.turn_off_v.map(|_| near));
    }
    Ok(Next::Planned)
}

/// Returns the acts of the turn-on at the limit plus `shift_v`, from 0 V.
pub fn conduct_acts(plan: &Plan, points: &Points, shift_v: f64) -> Vec<Act> {
    let level_v = plan.turn_on_v.unwrap_or(plan.control_v) + shift_v;
    let mut acts = prepare(points, (0.0, level_v), (plan.on_s, plan.off_s)).to_vec();
    acts.extend(answer(points, level_v, plan.on_s));
    acts
}

/// Concludes the turn-on.
pub fn conclude_conducts(
    state: &mut State,
    plan: &Plan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let [ampere] = given.singles(Device::SmuOut)?;
    if load_at(given, plan.on_s)? < ON || !is_on(ampere) {
        return Ok(Next::Insert(Stage::Dc(DcStage::ConductsBeyond)));
    }
    let proven = (Parameter::TurnOnVoltage, Judgement::Pass);
    state.proven.push(proven);
    Ok(Next::Planned)
}

/// Returns the acts of the second try of the turn-on: a step to a guard band above the limit, and a reading of the load
/// current once more, 20 time limits later.
pub fn conduct_beyond_acts(plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = conduct_acts(plan, points, plan.guard_v);
    acts.extend(read(points, LATE * plan.on_s));
    acts
}

/// Concludes the second try of the turn-on.
pub fn conclude_conducts_beyond(
    state: &mut State,
    plan: &Plan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let [_, late_a] = given.singles(Device::SmuOut)?;
    let is_in_time = load_at(given, plan.on_s)? >= ON;
    if !is_on(late_a) {
        state.record.stop(Finding::BlocksAboveTurnOn);
    } else if is_in_time || !plan.bounds(Parameter::TurnOnTime) {
        let judgement = Judgement::Conditional(Side::High);
        state.proven.push((Parameter::TurnOnVoltage, judgement));
    } else {
        state.late.push(Parameter::TurnOnVoltage);
    }
    Ok(Next::Planned)
}
