//! End of every test: sources off, everything disconnected, the socket discharged and proven to be below 30 V.

use super::board::Position;
use super::given::Given;
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::ssr::points::{Device, DigitalIn, Points};
use crate::instrument::act::{Act, Read};
use crate::rig::point::Point;
use std::sync::Arc;
use units::Span;

/// Longest time until the detector sees the socket discharged.
const WITHIN: Span = Span::ms(500);
/// Times that the socket is looked at before it counts as live: the first conversion may be older than the discharge.
const LOOKS: u32 = 3;
/// Time of two conversions of the slowest converter, which has all its channels enabled.
const CONVERSIONS: Span = Span::ms(220);
/// Voltage at the socket below which the jaws may open, V.
pub const SAFE_V: f64 = 30.0;

/// Returns the acts that take the sources off.
pub fn off_acts(points: &Points) -> Vec<Act> {
    let sources = [Device::SmuIn, Device::SmuOut, Device::PulseSource];
    vec![Act::Query(sources.map(|it| points.off(it)).to_vec())]
}

/// Returns the acts that disconnect the socket, discharge it and look at its voltage in two ways; from the second look on
/// after a fresh conversion.
pub fn acts(state: &mut State, points: &Points) -> Vec<Act> {
    state.position = Position::Isolated;
    let is_first = state.looks == 0;
    let fresh = if is_first { Span(0) } else { CONVERSIONS };
    state.looks += 1;
    vec![
        Act::Set(points.outputs(&[])),
        Act::Until {
            point: points.input(DigitalIn::OutputSafe),
            word: Arc::clone(&points.fixture),
            within: WITHIN,
        },
        Act::Wait(fresh),
        Act::Read(Read::points([Point::Analog(points.residual)])),
    ]
}

/// Concludes whether the socket is safe: detector and converter must both say so, and both contactors must be open.
pub fn conclude(state: &mut State, given: &Given) -> Next {
    let detected = given.readings.seen.last() == Some(&true);
    let residual = given.readings.analog(given.points.residual).last();
    let residual_v = residual.and_then(|it| it.good());
    let is_on = |point| given.readings.states(given.points.input(point)).last() == Some(true);
    let is_cut_off = is_on(DigitalIn::LineOpen) && is_on(DigitalIn::LoopOpen);
    let is_low = residual_v.is_some_and(|volts| volts.abs() < SAFE_V);
    state.is_discharged = detected && is_cut_off && is_low;
    match state.is_discharged || state.looks >= LOOKS {
        true => Next::Planned,
        false => Next::Insert(Stage::Discharge),
    }
}
