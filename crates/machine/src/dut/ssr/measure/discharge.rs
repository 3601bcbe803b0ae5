//! End of every test: sources off, everything disconnected, the socket discharged and proven to be below 30 V.

use super::board::Position;
use super::given::Given;
use super::line::Level;
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::ssr::points::{Device, DigitalIn, Points};
use crate::instrument::act::{Act, Read};
use crate::rig::point::Point;
use std::sync::Arc;
use units::Span;

/// Inputs that show a safe socket: its voltage detector, and the mirror contacts of both contactors.
const SAFE: [DigitalIn; 3] = [
    DigitalIn::OutputSafe,
    DigitalIn::LineOpen,
    DigitalIn::LoopOpen,
];
/// Longest time until the inputs [`SAFE`] show a safe socket.
const WITHIN: Span = Span::ms(500);
/// Number of readings after which a socket that is not safe counts as live: the first one may be older than the
/// discharge.
const LOOKS: u32 = 3;
/// Time of two conversions of the slowest converter, which has all its channels enabled.
const CONVERSIONS: Span = Span::ms(220);
/// Time of one conversion of a converter with one channel in its fast mode.
const LATEST: Span = Span::ms(14);
/// Time of two conversions of a converter with one channel in its fast mode.
const FRESH: Span = Span::ms(30);
/// Voltage at the socket below which the jaws may open, V.
pub const SAFE_V: f64 = 30.0;

/// Returns the acts that switch off both SMUs, and the pulse source if this test has switched it on: the fixture
/// connects that source only for its stage.
pub fn off_acts(state: &mut State, points: &Points) -> Vec<Act> {
    let mut queries = [Device::SmuIn, Device::SmuOut]
        .map(|it| points.off(it))
        .to_vec();
    queries.extend(state.end_pulses(points));
    vec![Act::Query(queries)]
}

/// Returns the acts that disconnect the socket, discharge it and check its voltage by detector and converter; from the
/// second check on after two full conversions.
pub fn acts(state: &mut State, points: &Points) -> Vec<Act> {
    state.position = Position::Isolated;
    let is_first = state.looks == 0;
    // The mains moves within a conversion: the first look of an AC part waits for a conversion of its own, that of a DC
    // part for the end of one, which saw the socket discharged for most of its time.
    let fresh = match (is_first, state.level) {
        (true, Level::Unknown) => LATEST,
        (true, Level::Line | Level::Loop | Level::LoopProven) => FRESH,
        (false, _) => CONVERSIONS,
    };
    state.looks += 1;
    vec![
        Act::Set(points.outputs(&[])),
        Act::Agree {
            expected: SAFE.map(|it| (points.input(it), true)).to_vec(),
            word: Arc::clone(&points.fixture),
            within: WITHIN,
        },
        Act::Wait(fresh),
        Act::Read(Read::points([Point::Analog(points.residual)])),
    ]
}

/// Concludes whether the socket is safe: detector and converter must both say so, and both contactors must be open.
pub fn conclude(state: &mut State, given: &Given) -> Next {
    let residual = given.readings.analog(given.points.residual).last();
    let residual_v = residual.and_then(|it| it.good());
    let is_detected = SAFE.iter().all(|it| given.is_on(*it));
    let is_low = residual_v.is_some_and(|volts| volts.abs() < SAFE_V);
    state.is_discharged = is_detected && is_low;
    match state.is_discharged || state.looks >= LOOKS {
        true => Next::Planned,
        false => Next::Insert(Stage::Discharge),
    }
}
