//! Conclusion of a fine ramp: the threshold, or the next stage when the ramp has missed the event.

use super::board::Armature;
use super::indication::{fine_reading, gate0};
use super::pace::Pace;
use super::ramp::{JUMP, SETTLED_DOWN, stopped_at};
use super::search::{AFTER_SEARCH, Search, parameter};
use super::state::TestState;
use super::{Context, Ramp, Stage};
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::threshold::{Direction, WINDOW, indicated};
use units::{Second, Span, Volt};

/// Number of fine ramps that may miss the threshold before the test is void.
const ATTEMPTS: u8 = 5;

enum Outcome {
    /// Indicated voltage at the contact event, and the time for which gate 0 was open.
    Found(Volt, Second),
    /// Event missed; the plan holds the interval for the next ramp.
    Repeat,
}

pub(super) fn conclude(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
    (direction, attempt): (Direction, u8),
) -> Option<Stage> {
    let (seen, gate) = match evaluate(context, readings, state, (direction, attempt))? {
        Outcome::Found(seen, gate) => (seen, gate),
        Outcome::Repeat => return Some(repeat(context, state, (direction, attempt))),
    };
    if direction == Direction::Rising {
        state.board.armature = Armature::Operated;
    }
    let (record, parameter) = (&mut state.record, parameter(direction));
    let part = record.own.track?;
    let known = record.ramp(direction);
    let ramp = Ramp {
        fine: Some(seen),
        ..known.unwrap_or(Ramp::fine_only(seen))
    };
    // Models and overshoots learn from the first fine ramp only: repeats find a warmer coil, and most parts have no
    // repeat.
    let first = known.and_then(|ramp| ramp.fine);
    if first.is_none() {
        record.forget(parameter);
        record.keep_ramp(direction, ramp);
    }
    let scale = context.scale();
    state
        .plan
        .expect_again(direction, first.unwrap_or(seen), scale);
    let reading = fine_reading(context, (ramp, gate), part, direction);
    record.found(parameter, reading, readings.gates.iter().flatten());
    None
}

/// Evaluates a fine ramp: the event found, or a repeat; `None` when the test ends.
fn evaluate(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
    (direction, attempt): (Direction, u8),
) -> Option<Outcome> {
    let TestState {
        board,
        plan,
        record,
    } = state;
    let (sent, searched) = (board.sent(), plan.interval(direction));
    let (Some(gate), Some(_)) = (gate0(context, readings), record.own.track) else {
        record.stop(Finding::GatesNotRead);
        return None;
    };
    let (v_per_s, scale) = (context.calibration.fine_v_per_s.value, context.scale());
    let seen = indicated(
        (sent.start, scale.of_range(WINDOW)),
        v_per_s,
        gate,
        direction,
    );
    let met = readings.seen.first() == Some(&true);
    let stopped = stopped_at(sent.start, sent.span, seen);
    let left = sent.takes.0.saturating_sub(Span::seconds(gate.0).0);
    board.still_ramping = Span(if met { left } else { 0 });
    // An event before the interval comes from the swing after the approach, not from the ramp.
    let settled = match direction {
        Direction::Rising => Pace::of(record).run_up(v_per_s),
        Direction::Falling => scale.of_range(SETTLED_DOWN),
    };
    let premature = met && (seen - sent.start).abs() < scale.of_range(JUMP) + settled;
    if met && stopped.is_none() && !premature {
        return Some(Outcome::Found(seen, gate));
    }
    let operated = direction == Direction::Rising;
    let inputs = readings.boards.last();
    let early = inputs.is_some_and(|it| it.no_closed == operated);
    let next = match stopped {
        Some(end) if met => searched.around(end),
        Some(_) | None => searched.next(direction, early || premature),
    };
    plan.expect(direction, next);
    if attempt + 1 < ATTEMPTS {
        return Some(Outcome::Repeat);
    }
    record.stop(Finding::ThresholdNotFound(direction).with(ATTEMPTS.to_string()));
    None
}

/// Returns the stage after a miss: a ramp over the neighbouring interval; after the second miss, or when that interval
/// is wide, a search by halves.
fn repeat(
    context: &Context,
    state: &mut TestState,
    (direction, attempt): (Direction, u8),
) -> Stage {
    let expected = state.plan.expected(direction);
    let wide = expected.is_some_and(|interval| interval.is_wide(context.scale()));
    if attempt + 1 == AFTER_SEARCH || attempt + 1 < AFTER_SEARCH && wide {
        let search = Search::placing(context, &state.record, direction);
        state.plan.search = Some(search);
        return Stage::Search(direction);
    }
    match direction {
        Direction::Rising => Stage::OperateFine(attempt + 1),
        Direction::Falling => Stage::ReleaseFine(attempt + 1),
    }
}
