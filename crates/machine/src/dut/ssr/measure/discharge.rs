//! End of every test: sources off, everything disconnected, the socket discharged and proven to be below 30 V.

use super::board::Position;
use super::given::Given;
use super::state::{Next, State};
use crate::dut::ssr::points::{Device, DigitalIn, Points};
use crate::instrument::act::{Act, Read};
use crate::rig::point::Point;
use std::sync::Arc;
use units::Span;

/// Longest time until the detector sees the socket discharged.
const WITHIN: Span = Span::ms(500);
/// Voltage at the socket below which the jaws may open, V.
pub const SAFE_V: f64 = 30.0;

/// Returns the acts that take the sources off.
pub fn off_acts(points: &Points) -> Vec<Act> {
    let sources = [Device::SmuIn, Device::SmuOut, Device::PulseSource];
    vec![Act::Query(sources.map(|it| points.off(it)).to_vec())]
}

/// Returns the acts that disconnect the socket, discharge it and look at its voltage in two ways.
pub fn acts(state: &mut State, points: &Points) -> Vec<Act> {
    state.position = Position::Isolated;
    vec![
        Act::Set(points.outputs(&[])),
        Act::Until {
            point: points.input(DigitalIn::OutputSafe),
            word: Arc::clone(&points.fixture),
            within: WITHIN,
        },
        Act::Read(Read::points([Point::Analog(points.residual)])),
    ]
}

/// Concludes whether the socket is safe: both the detector and the converter must say so.
pub fn conclude(state: &mut State, given: &Given) -> Next {
    let detected = given.readings.seen.last() == Some(&true);
    let residual = given.readings.analog(given.points.residual).last();
    let residual_v = residual.and_then(|it| it.good());
    state.is_discharged = detected && residual_v.is_some_and(|volts| volts.abs() < SAFE_V);
    Next::Planned
}
