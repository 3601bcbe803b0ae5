//! The AC circuits, line and loop: contactors, source, and the records that the stages of an AC part take there.
//!
//! A contactor closes only after the mirror contacts of both have shown them open. A stage goes on only when the mirror
//! contacts show what it has switched; else the runner skips the acts that follow, and [`switched`] ends the test. The
//! loop closes only after the source has been measured at its low voltage.

pub mod conforms;
pub mod leakage;
pub mod looped;
pub mod references;
pub mod stage;
pub mod staircase;
pub mod supply;
pub mod train;

use super::board::{Position, RELAY};
use super::given::Given;
use super::state::{Next, State};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_plan::{AcPlan, LINE_OHM, LOOP_OHM};
use crate::dut::ssr::points::{Device, DigitalIn, Points};
use crate::instrument::act::Act;
use crate::instrument::query::Query;
use std::sync::Arc;
use units::Span;

/// Longest time until the mirror contacts show the new position of a contactor.
const SWITCHED: Span = Span::ms(200);
/// Time from the change of the mirror contact until the main contacts no longer bounce.
const BOUNCED: Span = Span::ms(5);
/// Time after the end of a record until the digitizer has stored it.
pub const STORED: Span = Span::ms(2);
/// Largest deviation of the source from its level, as a share, at which a contactor may close.
const OFF_LEVEL: f64 = 0.1;

/// Voltage to which the AC source is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Level {
    /// Unknown: this test has not set it.
    #[default]
    Unknown,
    /// Voltage of the line.
    Line,
    /// Voltage of the loop, not yet measured.
    Loop,
    /// Voltage of the loop, measured.
    LoopProven,
}

/// Returns the act that waits until the mirror contacts show a position.
fn contacts(points: &Points, position: Position) -> Act {
    let (line, ring) = expected(position);
    let expected = [(DigitalIn::LineOpen, line), (DigitalIn::LoopOpen, ring)];
    Act::Agree {
        expected: expected
            .into_iter()
            .map(|(it, on)| (points.input(it), on))
            .collect(),
        word: Arc::clone(&points.fixture),
        within: SWITCHED,
    }
}

/// Returns whether the line contactor and the loop contactor are open in a position.
const fn expected(position: Position) -> (bool, bool) {
    match position {
        Position::Line | Position::LinePulsed => (false, true),
        Position::Loop => (true, false),
        Position::Isolated | Position::Load | Position::Pulsed | Position::Direct => (true, true),
    }
}

/// Returns the acts that open both contactors and wait until the mirror contacts show it.
pub fn leave(state: &mut State, points: &Points) -> Vec<Act> {
    state.position = Position::Isolated;
    vec![
        Act::Set(points.outputs(&[])),
        contacts(points, Position::Isolated),
    ]
}

/// Returns the query that sets the source to the voltage of the line.
pub fn line_level(state: &mut State, ac: &AcPlan, points: &Points) -> Query {
    let limit_a = ac.limit_a(ac.mains_v, LINE_OHM);
    match std::mem::replace(&mut state.level, Level::Line) {
        Level::Unknown => points.mains(ac, ac.mains_v, limit_a),
        Level::Line | Level::Loop | Level::LoopProven => points.mains_level(ac.mains_v, limit_a),
    }
}

/// Returns the queries that set the source to the voltage of the loop and measure it.
pub fn loop_level(state: &mut State, ac: &AcPlan, points: &Points) -> [Query; 2] {
    let limit_a = ac.limit_a(ac.loop_v(), LOOP_OHM);
    let set = match std::mem::replace(&mut state.level, Level::Loop) {
        Level::Unknown => points.mains(ac, ac.loop_v(), limit_a),
        Level::Line | Level::Loop | Level::LoopProven => points.mains_level(ac.loop_v(), limit_a),
    };
    [set, points.measure_mains()]
}

/// Returns the acts that close the contactor of a position while both control sources are off. Between the two
/// positions of the line only the source of the control input changes.
pub fn close(state: &mut State, to: Position, ac: &AcPlan, points: &Points) -> Vec<Act> {
    if state.position == to {
        return Vec::new();
    }
    let is_beside = expected(state.position) == expected(to) && state.position.is_on_mains();
    let mut queries = vec![points.off(Device::SmuIn)];
    // Between the two positions of the line, the source of DC parts is disconnected already, and the pulse source may
    // already hold its train.
    if !is_beside {
        queries.push(points.off(Device::SmuOut));
    }
    if !is_beside || state.position == Position::LinePulsed {
        queries.extend(state.end_pulses(points));
    }
    let mut acts = Vec::new();
    if !is_beside && state.position.is_on_mains() {
        acts.extend(leave(state, points));
    }
    if to != Position::Loop && state.level != Level::Line {
        queries.push(line_level(state, ac, points));
    }
    acts.push(Act::Query(queries));
    if !is_beside && state.position != Position::Isolated {
        acts.extend(leave(state, points));
    }
    acts.push(Act::Set(points.outputs(to.outputs())));
    acts.push(match is_beside {
        // The train waits longer than the relay needs, from this mark on.
        true if to == Position::LinePulsed => Act::Mark,
        true => Act::Wait(RELAY),
        false => contacts(points, to),
    });
    if !is_beside {
        acts.push(Act::Wait(BOUNCED));
    }
    state.position = to;
    acts
}

/// Fails with the mirror contact that has not shown a position to which the stage has switched.
pub fn switched(given: &Given) -> Result<(), Reason> {
    let own = DigitalIn::ALL.iter();
    let mut wrong = own.filter(|it| given.readings.disagreed == Some(given.points.input(**it)));
    let why = wrong.next().map(|it| Finding::Contactor.with(it.name()));
    why.map_or(Ok(()), Err)
}

/// Concludes whether the source has the voltage of the loop; if not, the test ends with the loop open.
pub fn conclude_ready(state: &mut State, ac: &AcPlan, given: &Given) -> Next {
    if state.level == Level::LoopProven {
        return Next::Planned;
    }
    let delivered = given
        .readings
        .delivered(given.points.instrument(Device::AcSource));
    let measured = delivered.filter(|it| !it.numbers.is_empty()).last();
    let volts = measured.and_then(|it| it.numbers.first().copied());
    let is_near = |volts: f64| (volts / ac.loop_v() - 1.0).abs() < OFF_LEVEL;
    match volts {
        Some(volts) if is_near(volts) => state.level = Level::LoopProven,
        Some(_) | None => state.record.stop(Finding::WrongMains),
    }
    Next::Planned
}

/// Returns the acts that set and measure the source for the loop; empty when that is done already.
pub fn ready_acts(state: &mut State, ac: &AcPlan, points: &Points) -> Vec<Act> {
    if state.level == Level::LoopProven {
        return Vec::new();
    }
    let mut acts = leave(state, points);
    acts.push(Act::Query(loop_level(state, ac, points).to_vec()));
    acts
}
