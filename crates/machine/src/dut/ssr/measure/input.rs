//! Control input: its current, that of the reversed input, and the LED at the wrong pins.

use super::board::{self, Position, RELAY};
use super::given::{Given, NotDelivered};
use super::line;
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::accuracy::{applied, current};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, DigitalOut, Points};
use crate::instrument::act::Act;
use units::Unit;

/// Current below which the LED is open, A.
const OPEN_A: f64 = 10e-6;
/// Least current of an LED at the pins of the output, A.
const LED_A: f64 = 100e-6;
/// Largest reverse current of an LED, as a share of its forward current.
const ONE_WAY: f64 = 0.1;

/// Returns the acts that measure the input while the output is at nothing.
pub fn acts(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Isolated);
    state.position = Position::Isolated;
    let mut queries = vec![
        points.source_and_read(Device::SmuIn, plan.control_v, &plan.input),
        points.source_and_read(Device::SmuIn, -plan.reverse_v, &plan.reverse),
        points.off(Device::SmuIn),
    ];
    // Meanwhile the AC source, still disconnected from the part, goes to its level.
    queries.extend(plan.ac().map(|ac| line::line_level(state, ac, points)));
    acts.push(Act::Query(queries));
    acts
}

/// Concludes both currents. An input that is open or shorted may belong to a turned part.
pub fn conclude(state: &mut State, plan: &Plan, given: &Given) -> Result<Next, NotDelivered> {
    let device = Device::SmuIn;
    let [forward, reversed] = given.numbers(device)?;
    let (forward_a, forward_moved) = Given::settled(device, forward)?;
    let (reverse_a, reverse_moved) = Given::settled(device, reversed)?;
    state.suspected = if forward_a < OPEN_A {
        Some(Finding::InputOpen)
    } else if plan.input.is_limited(forward_a) && plan.bounds(Parameter::InputCurrent) {
        Some(Finding::InputShorted)
    } else if plan.reverse.is_limited(reverse_a) && plan.bounds(Parameter::ReverseCurrent) {
        Some(Finding::InputConductsReversed)
    } else {
        None
    };
    if state.suspected.is_some() {
        return Ok(Next::Insert(Stage::Turned));
    }
    let (input_ma, reverse_ua) = (forward_a / 1e-3, -reverse_a / 1e-6);
    let budget = current(&plan.input, forward_a, forward_moved, 1e-3);
    let budget = applied(budget, &plan.input, plan.control_v, input_ma);
    let reversed = current(&plan.reverse, reverse_a, reverse_moved, 1e-6);
    // A current at the end of its range is no result.
    if !plan.input.is_limited(forward_a) {
        state.found([(Parameter::InputCurrent, input_ma, Unit::Milliampere, budget)]);
    }
    if !plan.reverse.is_limited(reverse_a) {
        let unit = Unit::Microampere;
        state.found([(Parameter::ReverseCurrent, reverse_ua, unit, reversed)]);
    }
    Ok(Next::Planned)
}

/// Returns the acts that look for an LED at the pins of the output, in both polarities.
pub fn turned_acts(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Load);
    state.position = Position::Load;
    let reversed = [Position::Load.outputs(), &[DigitalOut::OutputPolarity]].concat();
    let look = || {
        Act::Query(vec![
            points.source(Device::SmuOut, plan.control_v, &plan.load),
            points.read(Device::SmuOut),
            points.off(Device::SmuOut),
        ])
    };
    acts.extend([
        look(),
        Act::Set(points.outputs(&reversed)),
        Act::Wait(RELAY),
        look(),
        Act::Set(points.outputs(Position::Load.outputs())),
        Act::Wait(RELAY),
    ]);
    acts
}

/// Concludes whether the part lies turned; the finding about its input holds when it does not.
pub fn conclude_turned(state: &mut State, given: &Given) -> Result<Next, NotDelivered> {
    let [one, other] = given.singles(Device::SmuOut)?.map(f64::abs);
    let (most, least) = (one.max(other), one.min(other));
    let is_led = most > LED_A && least < ONE_WAY * most;
    match state.suspected {
        _ if is_led => state.record.stop(Finding::Turned),
        Some(finding) => state.record.stop(finding),
        None => {}
    }
    Ok(Next::Planned)
}
