//! Pins and short check: the probes are up, both probes of each pin touch it, and the output is not shorted.

use super::board::{self, Position, RELAY};
use super::discharge;
use super::given::Given;
use super::state::{Next, State};
use crate::dut::record::TestRecord;
use crate::dut::ssr::Finding;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{DigitalIn, DigitalOut, Points};
use crate::instrument::act::{Act, Read};
use std::sync::Arc;

/// Inputs of the Kelvin test, each with the name of its pin.
const PINS: [(DigitalIn, &str); 4] = [
    (DigitalIn::KelvinInPlus, "in+"),
    (DigitalIn::KelvinInMinus, "in-"),
    (DigitalIn::KelvinOut1, "out1"),
    (DigitalIn::KelvinOut2, "out2"),
];

/// Sets the outputs that are on, waits for the relays, reads every input.
pub fn look(points: &Points, on: &[DigitalOut]) -> [Act; 3] {
    [
        Act::Set(points.outputs(on)),
        Act::Wait(RELAY),
        Act::Read(Read::Word(Arc::clone(&points.fixture))),
    ]
}

/// Returns the acts of the Kelvin test. They switch the sources off first, because the test before may have ended
/// without proof that they are off.
pub fn acts(state: &mut State, points: &Points) -> Vec<Act> {
    let mut acts = discharge::off_acts(state, points);
    acts.extend(look(points, &[DigitalOut::KelvinTest]));
    acts
}

/// Returns the acts of the short check: as the part lies, then reversed. Its relays open while the input is measured,
/// which needs none of them.
pub fn short_acts(points: &Points) -> Vec<Act> {
    let (check, reversed) = (DigitalOut::ShortCheck, DigitalOut::OutputPolarity);
    let mut acts = look(points, &[check]).to_vec();
    acts.extend(look(points, &[check, reversed]));
    acts.push(Act::Set(points.outputs(&[])));
    acts
}

/// Concludes the Kelvin test.
pub fn conclude(record: &mut TestRecord, given: &Given) -> Next {
    let is_on = |point| given.readings.states(given.points.input(point)).last() == Some(true);
    let open = PINS.into_iter().filter(|(point, _)| !is_on(*point));
    let open: Vec<&str> = open.map(|(_, pin)| pin).collect();
    if !is_on(DigitalIn::ProbeChain) {
        record.stop(Finding::ProbeChainOpen);
    } else if !open.is_empty() {
        record.stop(Finding::PinOpen.with(open.join(" ")));
    }
    Next::Planned
}

/// Concludes the short check. A body diode conducts in the reversed polarity.
pub fn conclude_short(record: &mut TestRecord, plan: &Plan, given: &Given) -> Next {
    let point = given.points.input(DigitalIn::ShortSeen);
    let mut seen = given.readings.states(point);
    let (forward, reversed) = (seen.next() == Some(true), seen.next() == Some(true));
    let has_diode = plan.dc().is_some_and(|dc| dc.body_diode);
    if forward || (reversed && !has_diode) {
        record.stop(Finding::Shorted);
    }
    Next::Planned
}

/// Returns the acts that look once more whether the output conducts, while no source is on.
pub fn stuck_acts(state: &mut State, points: &Points) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Isolated);
    state.position = Position::Isolated;
    acts.extend(look(points, &[DigitalOut::ShortCheck]));
    acts.push(Act::Set(points.outputs(&[])));
    acts.push(Act::Wait(RELAY));
    acts
}

/// Concludes whether an output without bounds to its leakage conducts for ever; it did not before the control was on.
pub fn conclude_stuck(state: &mut State, given: &Given) -> Next {
    let point = given.points.input(DigitalIn::ShortSeen);
    if given.readings.states(point).last() == Some(true) {
        state.record.stop(Finding::StuckOn);
    } else if let Some(finding) = state.suspected {
        state.record.stop(finding);
    }
    Next::Planned
}
