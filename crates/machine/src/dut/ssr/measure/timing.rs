//! Times of one control pulse, recorded by the digitizer.

use super::board::{Position, RELAY};
use super::conformity;
use super::given::{Given, NotDelivered};
use super::state::{Next, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::accuracy;
use crate::dut::ssr::edges::{Crossing, edges};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::{CONTROL_CHANNEL, OUTPUT_CHANNEL};
use crate::instrument::act::Act;
use units::{Span, Unit};

/// Time beyond the length of a record until the digitizer has stored it.
const STORED: Span = Span::ms(2);

/// Returns the acts of one pulse. Both sources at the input are at 0 V while it changes over.
pub fn acts(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = match state.position {
        Position::Load | Position::Pulsed => Vec::new(),
        Position::Isolated | Position::Direct => conformity::to_load(state, plan, points),
    };
    state.position = Position::Pulsed;
    let input_ma = state.record.result(Parameter::InputCurrent);
    let input_a = input_ma.map_or(0.0, |it| it.value / 1e3);
    let record = Span::seconds(plan.record_s());
    acts.extend([
        Act::Query(vec![
            points.off(Device::SmuIn),
            points.train(plan, input_a),
            points.capture(plan),
        ]),
        Act::Set(points.outputs(Position::Pulsed.outputs())),
        Act::Wait(RELAY + record),
        Act::Query(vec![points.start()]),
        Act::Wait(record + STORED),
        Act::Query(vec![
            points.complete(),
            points.waveform(plan, CONTROL_CHANNEL),
            points.waveform(plan, OUTPUT_CHANNEL),
            points.off(Device::PulseSource),
        ]),
    ]);
    acts
}

/// Concludes both times.
pub fn conclude(state: &mut State, plan: &Plan, given: &Given) -> Result<Next, NotDelivered> {
    let [control, output] = given.waveforms()?;
    let Some(edges) = edges(&control, &output) else {
        state.record.stop(Finding::PulseNotRecorded);
        return Ok(Next::Planned);
    };
    let Some(on) = edges.on else {
        state.record.stop(Finding::TurnsOnTooLate);
        return Ok(Next::Planned);
    };
    let between = |of, control: &Crossing, output: &Crossing| {
        let took_us = (output.at_s - control.at_s) * 1e6;
        let budget = accuracy::time(plan, edges.step_s, control, output);
        (of, took_us, Unit::Microsecond, budget)
    };
    state.found([between(Parameter::TurnOnTime, &edges.rise, &on)]);
    match edges.off {
        Some(off) => state.found([between(Parameter::TurnOffTime, &edges.fall, &off)]),
        None => state.record.stop(Finding::TurnsOffTooLate),
    }
    Ok(Next::Planned)
}
