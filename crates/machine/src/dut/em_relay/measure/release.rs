//! Release voltage: from a sealed armature the supply falls until NO breaks, on a coarse ramp, then on a fine one.
//!
//! The armature is sealed at 0.95 of nominal: enough to saturate it, and below nominal voltage, so that the timed
//! operation remains the last one at nominal.

use super::board::{Armature, BoardState, SentRamp};
use super::contact::{self, SOURCE_SETTLES, drop_of};
use super::indication::gate0;
use super::operate::{SETTLES, TURNS, release_start};
use super::ramp::{Expected, JUMP, after_coarse};
use super::search::Search;
use super::state::TestState;
use super::timing::SOURCE_FLOWS;
use super::{Context, INTERLOCK, Ramp, Stage, set};
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::contact::ContactDrop;
use crate::dut::em_relay::finding::Contact;
use crate::dut::em_relay::points::DigitalIn;
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::supply::RAMP_MARGIN;
use crate::dut::em_relay::threshold::{Direction, WINDOW, indicated};
use units::{Span, Volt};

/// Fraction of nominal at which the armature is sealed.
pub const SEAL: f64 = 0.95;
/// Last part of a ramp, in refresh intervals of the output. The output may have stopped already during this part, so an
/// event there gives no estimate.
const LAST_REFRESHES: f64 = 1.5;
/// Time for operation, bounce and flux to settle.
const SEAL_TIME: Span = Span::ms(25);
/// Time for the seal's flux to decay to a few percent before a fine ramp. The model of the coarse overshoot includes
/// the flux that remains after [`SETTLES`].
const FINE_SETTLES: Span = Span::ms(35);
/// Time after the end of a ramp up to which a break still counts.
const LATE: Span = Span::ms(12);

/// Seals the armature, steps to the start of the falling ramp and arms the board. Does not first release an operated
/// armature, and seals it until the running ramp has ended. With `source` the reversed source stays on, for a reading of
/// the closed contact.
fn seal(context: &Context, board: BoardState, start: Volt, source: bool) -> (Vec<Act>, BoardState) {
    let mut supply = board.supply;
    let seal = supply.step_to(Volt(SEAL * context.relay.part.nominal_v));
    let falling = [
        (SourceOn, source),
        (SourceReverse, source),
        (RampMode, true),
        (SelectNo, true),
        (EventNoBreak, true),
        (Arm, false),
    ];
    let mut acts = Vec::new();
    if board.armature == Armature::Operated {
        acts.extend([seal, set(&falling)]);
    } else {
        acts.extend([
            set(&[
                (CoilDrive, false),
                (SourceOn, false),
                (SourceReverse, false),
            ]),
            Act::Wait(INTERLOCK),
            set(&falling),
            seal,
            set(&[(CoilDrive, true)]),
            Act::Mark,
        ]);
    }
    acts.extend([
        Act::RampSinceMark(SEAL_TIME.max(board.still_ramping)),
        supply.step_to(start),
        Act::Mark,
        set(&[(Arm, true)]),
    ]);
    let sealed = BoardState {
        supply,
        armature: Armature::Operated,
        still_ramping: Span(0),
        ..board
    };
    (acts, sealed)
}

/// Reads the counters, takes ARM off so that the next stage can raise it again, and waits for flux and armature to
/// settle after the step. `read` comes before the source goes off, so that the contact breaks without load.
fn settled(within: Span, read: &[Act]) -> Vec<Act> {
    let mut acts = vec![Act::Read(Read::Gates)];
    acts.extend_from_slice(read);
    acts.extend([
        set(&[(Arm, false), (SourceOn, false), (SourceReverse, false)]),
        Act::WaitSinceMark(within),
    ]);
    acts
}

/// Reads the drop of NO on the closure of the ramps. The mark lies at least [`SEAL_TIME`] after the closure.
fn drop_of_ramps(context: &Context) -> [Act; 2] {
    let flows = SOURCE_FLOWS + SOURCE_SETTLES + context.fresh(1);
    [
        Act::ConvertSinceMark(Span(flows.0.saturating_sub(SEAL_TIME.0))),
        Act::Read(Read::Drop),
    ]
}

/// Waits for NO to break, then takes the drive off; the armature falls from that event on.
fn until_break(takes: Span) -> [Act; 4] {
    [
        Act::Until {
            point: DigitalIn::Latch,
            within: takes + LATE,
        },
        Act::Mark,
        set(&[(CoilDrive, false), (EventNoBreak, false)]),
        Act::Read(Read::Gate),
    ]
}

/// Ramps down until NO breaks. The closure of a coarse operate ramp right before it (`after_coarse`) carries the reversed
/// source under `alternating`; a fine ramp before it is stopped.
pub(super) fn acts_coarse(
    context: &Context,
    mut board: BoardState,
    after_coarse: bool,
) -> (Vec<Act>, BoardState) {
    let mut acts = Vec::new();
    let operated = board.armature == Armature::Operated;
    if operated && !after_coarse {
        let (ramp, takes) = stopped_above(context, &mut board, Volt(0.0));
        board.still_ramping = takes;
        acts.push(ramp);
    }
    if board.supply.coarse() != release_start(context) {
        let (ramp, takes) = board.supply.ramp_coarse(release_start(context));
        acts.extend([ramp, Act::Wait(takes)]);
    }
    let start = board.supply.coarse() + board.supply.fine();
    let source = context.alternates() && operated && after_coarse;
    let (sealing, mut board) = seal(context, board, start, source);
    let (start, span) = (board.supply.total(), board.supply.coarse());
    acts.extend(sealing);
    let read = match source {
        true => drop_of_ramps(context).to_vec(),
        false => Vec::new(),
    };
    acts.extend(settled(SETTLES, &read));
    let (ramp, takes) = board.supply.ramp_coarse(Volt(0.0));
    acts.push(ramp);
    acts.extend(until_break(takes));
    board.armature = Armature::Released;
    board.ramp = Some(SentRamp { start, span, takes });
    (acts, board)
}

pub(super) fn conclude_coarse(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
) -> Option<Stage> {
    if let Some(read) = readings.drops.first() {
        match drop_of(Some(read), false) {
            Ok(drop) => {
                let drop = ContactDrop::single(drop, true, context.reading_u_v());
                contact::add(context, (Contact::No, drop), &readings.drops, state);
            }
            Err(unread) => state.record.stop(unread.of(Contact::No)),
        }
    }
    let (SentRamp { start, span, .. }, test) = (state.board.sent(), &context.relay.test);
    let coarse_v_per_s = context.calibration.coarse_v_per_s.value;
    let seen = readings.seen.first() == Some(&true);
    let floor_v = coarse_v_per_s * LAST_REFRESHES * context.accuracy.ao_refresh_ms * 1e-3;
    let gate =
        gate0(context, readings).filter(|gate| seen && coarse_v_per_s * gate.0 < span.0 - floor_v);
    let (plan, record) = (&mut state.plan, &mut state.record);
    let Some(gate) = gate else {
        // The threshold lies below the coarse ramp, far from the threshold that the lot expects, so a wide search must
        // place the fine ramp.
        let expected = Expected::new(Volt(test.expected_release_v), test.expected_release_sd_v);
        plan.expect(Direction::Falling, expected);
        plan.search = Some(Search::placing(context, record, Direction::Falling));
        return Some(Stage::Search(Direction::Falling));
    };
    let window = context.scale().of_range(WINDOW);
    let coarse = indicated((start, window), coarse_v_per_s, gate, Direction::Falling);
    let shown = record.coarse_results(coarse, Direction::Falling);
    record.own.release = Some(Ramp::coarse_only(shown));
    after_coarse(context, readings, state, (shown, Direction::Falling))
        .then_some(Stage::ReleaseFine(0))
}

/// Stops the rising fine ramp as soon as it can serve as the start of a falling one of the length `way`. Returns the act,
/// and the time from the mark until the output rests.
fn stopped_above(context: &Context, board: &mut BoardState, way: Volt) -> (Act, Span) {
    let per_s = context.calibration.fine_v_per_s.value;
    let rises = Span(board.still_ramping.0.saturating_sub(RAMP_MARGIN.0));
    let at_event = board.supply.fine() - Volt(per_s * rises.as_seconds());
    let end = way.0.max(at_event.0 + per_s * TURNS.as_seconds());
    let (ramp, _) = board.supply.ramp_fine(Volt(end));
    let takes = Span::seconds((end - at_event.0) / per_s) + RAMP_MARGIN;
    (ramp, takes)
}

pub(super) fn acts_fine(
    context: &Context,
    mut board: BoardState,
    searched: Expected,
) -> (Vec<Act>, BoardState) {
    let (placed, jump) = (
        searched.falling(context.scale()),
        context.scale().of_range(JUMP),
    );
    let way = placed.span - jump;
    let mut acts = Vec::new();
    if board.armature == Armature::Operated && board.still_ramping > Span(0) {
        let (ramp, takes) = stopped_above(context, &mut board, way);
        board.still_ramping = takes;
        acts.push(ramp);
    } else if board.supply.fine() < way {
        let (fine, takes) = board.supply.ramp_fine(way);
        // After a missed ramp the output still falls. If it is below `way` now, it rises by no more than the act says; if
        // it is above, it falls only as far as `way`. Both count from the mark of the seal, which follows this act.
        let falls = board.still_ramping.0.saturating_sub(takes.0);
        board.still_ramping = takes.max(Span(falls) + RAMP_MARGIN);
        acts.push(fine);
    }
    let least = board.supply.coarse() + board.supply.fine() + jump;
    let top = Volt(placed.start.0.max(least.0));
    let (sealing, mut board) = seal(context, board, top, false);
    let (start, span) = (board.supply.total(), placed.span);
    acts.extend(sealing);
    acts.push(board.supply.step_to(top - jump));
    acts.extend(settled(FINE_SETTLES, &[]));
    let (ramp, takes) = board.supply.ramp_fine(board.supply.fine() - way);
    acts.push(ramp);
    acts.extend(until_break(takes));
    board.armature = Armature::Released;
    board.ramp = Some(SentRamp { start, span, takes });
    (acts, board)
}
