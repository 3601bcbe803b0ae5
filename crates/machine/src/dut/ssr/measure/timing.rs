//! Times of one control pulse, recorded by the digitizer.

use super::board::{Position, RELAY};
use super::conformity;
use super::given::{Given, NotDelivered};
use super::state::{Next, Pulses, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::accuracy;
use crate::dut::ssr::edges::{Crossing, Edges, pulse};
use crate::dut::ssr::marks;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{LOAD_V, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::{BEFORE, CONTROL_CHANNEL, OUTPUT_CHANNEL};
use crate::instrument::act::Act;
use crate::instrument::conversion::Conversion;
use units::{Span, Unit};

/// Time beyond the length of a record until the digitizer has stored it.
const STORED: Span = Span::ms(2);

/// Returns the acts of one pulse. Both sources at the input are at 0 V while it changes over; all sources go off while the
/// record is read.
pub fn acts(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    let mut acts = match state.position {
        Position::Load | Position::Pulsed => Vec::new(),
        Position::Isolated
        | Position::Direct
        | Position::Line
        | Position::LinePulsed
        | Position::Loop => conformity::to_load(state, plan, points, None),
    };
    let mut queries = vec![points.off(Device::SmuIn), points.capture(plan)];
    // A pulse before this one has left the output without its source.
    let is_again = std::mem::replace(&mut state.position, Position::Pulsed) == Position::Pulsed;
    queries.extend(is_again.then(|| points.source(Device::SmuOut, LOAD_V, &plan.load)));
    queries.extend(state.prepare_pulses(plan, points));
    state.pulses = Pulses::Sent;
    let record = Span::seconds(plan.record_s());
    // The digitizer needs the part of its record before the trigger.
    let before = Span::seconds(2.0 * BEFORE * plan.record_s());
    acts.extend([
        Act::Query(queries),
        Act::Set(points.outputs(Position::Pulsed.outputs())),
        Act::Wait(RELAY.max(before)),
        Act::Query(vec![points.start()]),
        Act::Wait(record + STORED),
    ]);
    let mut reads = vec![
        points.complete(),
        points.waveform(plan, CONTROL_CHANNEL),
        points.waveform(plan, OUTPUT_CHANNEL),
        points.off(Device::SmuOut),
    ];
    reads.extend(state.end_pulses(points));
    acts.extend([Act::Query(reads), Act::Convert(Conversion::new(pulse))]);
    acts
}

/// Concludes both times.
pub fn conclude(state: &mut State, plan: &Plan, given: &Given) -> Result<Next, NotDelivered> {
    let Some(edges) = given.converted::<Option<Edges>>()? else {
        state.record.stop(Finding::PulseNotRecorded);
        return Ok(Next::Planned);
    };
    let trace = &mut state.record.trace;
    edges
        .on
        .iter()
        .for_each(|it| trace.mark(marks::ON, it.at_s));
    edges
        .off
        .iter()
        .for_each(|it| trace.mark(marks::OFF, it.at_s));
    let Some(on) = edges.on else {
        if plan.bounds(Parameter::TurnOnTime) {
            state.record.stop(Finding::TurnsOnTooLate);
        }
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
        None if plan.bounds(Parameter::TurnOffTime) => {
            state.record.stop(Finding::TurnsOffTooLate);
        }
        None => {}
    }
    Ok(Next::Planned)
}
