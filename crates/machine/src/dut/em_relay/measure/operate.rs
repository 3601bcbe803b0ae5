//! Operate voltage on the coarse ramp from the pre-bias: an estimate within some 10 mV that places the fine ramp.

use super::board::{Armature, BoardState, SentRamp, drive_off};
use super::indication::gate0;
use super::ramp::{after_coarse, stopped_at};
use super::state::TestState;
use super::{Context, OFF, Ramp, Stage, set};
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::points::DigitalIn;
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::supply::RAMP_MARGIN;
use crate::dut::em_relay::threshold::{Direction, WINDOW, indicated};
use units::{Span, Volt};

/// Distance from the highest threshold of the lot up to the start of the coarse release ramp, volts.
const RELEASE_HEADROOM: Volt = Volt(0.8);
/// Time for flux and armature to reach equilibrium at the start level.
pub(super) const SETTLES: Span = Span::ms(25);
/// Longest time to detect the latch by a poll and to write the reversal of the ramp.
pub(super) const TURNS: Span = Span::ms(10);
/// Time after the end of a ramp up to which a contact event still counts.
pub(super) const LATE: Span = Span::ms(25);

/// Voltage to which the fine output rises while the armature is sealed for the coarse release. From there the fine operate
/// ramp ends high enough for the fine release ramp, which would otherwise wait for the output.
const LIFT: Volt = Volt(0.016);

/// Returns the height of the coarse output at which the release ramp begins.
pub(super) fn release_start(context: &Context) -> Volt {
    let test = &context.relay.test;
    let headroom = context.scale().of_range(RELEASE_HEADROOM);
    let above = test.expected_release_v + 4.0 * test.expected_release_sd_v + headroom.0;
    Volt(above.min(test.coarse_span_v))
}

/// Ramps up until NO makes, then reverses the ramp down to the start of the release ramp; the armature stays operated.
/// The coil stage has already armed the board.
pub(super) fn acts_coarse(context: &Context, board: BoardState) -> (Vec<Act>, BoardState) {
    let (mut acts, mut board) = match board.armature {
        Armature::ReadyForRamp => (Vec::new(), board),
        Armature::Unknown
        | Armature::ReadyForTiming
        | Armature::Operated
        | Armature::Released
        | Armature::Rested => prepared(context, board),
    };
    let top = Volt(context.relay.test.coarse_span_v);
    let (start, span) = (board.supply.total(), top - board.supply.coarse());
    let (ramp, takes) = board.supply.ramp_coarse(top);
    let (turn, _) = board.supply.ramp_coarse(release_start(context));
    let (lift, _) = board.supply.ramp_fine(context.scale().of_range(LIFT));
    acts.extend([
        ramp,
        Act::Until {
            point: DigitalIn::Latch,
            within: takes + LATE,
        },
        Act::Mark,
        turn,
        lift,
        Act::Read(Read::Gate),
    ]);
    board.armature = Armature::Unknown;
    board.ramp = Some(SentRamp { start, span, takes });
    (acts, board)
}

/// Returns the acts from rest to the armed pre-bias, for a coarse ramp that does not follow the coil stage directly.
fn prepared(context: &Context, board: BoardState) -> (Vec<Act>, BoardState) {
    let mut supply = board.supply;
    let mut acts = drive_off(board.armature);
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    acts.extend([
        coarse,
        supply.step_to(Volt(context.relay.test.prebias_v)),
        set(&[
            (SourceOn, context.alternates()),
            (SourceReverse, context.alternates()),
            (RampMode, true),
            (SelectNo, true),
            (EventNoBreak, false),
        ]),
        Act::RampSinceMark(OFF.max(takes.max(board.still_ramping))),
        set(&[(CoilDrive, true)]),
        set(&[(Arm, true)]),
        Act::Read(Read::Gates),
        Act::Wait(SETTLES),
    ]);
    let left = BoardState {
        supply,
        armature: Armature::ReadyForRamp,
        still_ramping: Span(0),
        ..board
    };
    (acts, left)
}

pub(super) fn conclude_coarse(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
) -> Option<Stage> {
    let (board, record) = (&mut state.board, &mut state.record);
    if readings.seen.first() != Some(&true) {
        // The part has operated at nominal voltage, so its threshold must lie above this ramp.
        record.stop(match readings.boards.last() {
            Some(board) if board.no_closed => Finding::MadeOutsideWindow,
            Some(_) => Finding::AboveCoarseRamp,
            None => Finding::BoardNotRead,
        });
        return None;
    }
    let Some(gate) = gate0(context, readings) else {
        record.stop(Finding::GatesNotRead);
        return None;
    };
    let SentRamp { start, span, .. } = board.sent();
    let v_per_s = context.calibration.coarse_v_per_s.value;
    let window = context.scale().of_range(WINDOW);
    let seen = indicated((start, window), v_per_s, gate, Direction::Rising);
    let coarse = stopped_at(start, span, seen).unwrap_or(seen);
    board.armature = Armature::Operated;
    board.still_ramping = turning(context, coarse - start);
    let shown = record.coarse_results(coarse, Direction::Rising);
    record.own.operate = Some(Ramp::coarse_only(shown));
    after_coarse(context, readings, state, (shown, Direction::Rising))
        .then_some(Stage::OperateFine(0))
}

/// Returns the time from the event until the coarse ramp is back at [`release_start`] and the fine output at [`LIFT`].
/// The coarse ramp still rises while a poll detects the event and a write reverses the ramp.
fn turning(context: &Context, climbed: Volt) -> Span {
    let per_s = context.calibration.coarse_v_per_s.value;
    let over = climbed.0 + per_s * TURNS.as_seconds();
    let back = over.min(context.relay.test.coarse_span_v) - release_start(context).0;
    let lift_s = context.scale().of_range(LIFT).0 / context.calibration.fine_v_per_s.value;
    TURNS + Span::seconds(lift_s.max(back.abs() / per_s)) + RAMP_MARGIN
}
