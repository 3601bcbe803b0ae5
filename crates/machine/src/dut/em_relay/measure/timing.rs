//! Timed operation at nominal voltage and timed release into the recipe's coil suppression, each with bounce and
//! contact resistance of its closure.

use super::board::{Armature, BoardState, drive_off, select_diode};
use super::coil::rest;
use super::contact::{self, SOURCE_SETTLES, closure, drop_of, reversed};
use super::state::TestState;
use super::{Context, OFF, Stage, TestRecord, set};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::contact::ContactDrop;
use crate::dut::em_relay::finding::{Contact, Finding};
use crate::dut::em_relay::points::DigitalIn;
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::timing::{bounce_ms, counts, gate_ms};
use units::{Span, Volt};

/// Slowest operation or release that the stage waits for.
pub const LONGEST_OPERATION: Span = Span::ms(60);
/// Time after the latch during which gate 1 counts bounce; the board closes the window at its end.
pub const BOUNCE_WINDOW: Span = Span::ms(20);
/// Time from the latch until the window has closed for certain.
const WINDOW_AFTER_LATCH: Span = Span::ms(21);
/// Greatest difference between the delays of the two gates, in counts. Nominally gate 1 is open whenever gate 0 is.
const GATE_SKEW: u32 = 4;
/// Time from the latch until the source drives its current: bounce ends within 6 ms (twice the specified class), and
/// the source requires 5 ms of closed contact.
pub(super) const SOURCE_FLOWS: Span = Span::ms(11);

/// Operates the relay at nominal voltage. Reads the counters after ARM unless the NC stage has read them, because ARM
/// closes a window that an interrupted test left open.
pub(super) fn acts_operate(context: &Context, board: BoardState) -> (Vec<Act>, BoardState) {
    let mut supply = board.supply;
    let mut acts = drive_off(board.armature);
    acts.extend([set(&[
        (SourceOn, false),
        (SourceReverse, false),
        (RampMode, false),
        (SelectNo, true),
        (EventNoBreak, false),
        (Arm, true),
    ])]);
    if board.armature != Armature::ReadyForTiming {
        acts.extend([
            supply.step_to(Volt(context.relay.part.nominal_v)),
            Act::Read(Read::Gates),
        ]);
    }
    acts.extend([
        Act::RampSinceMark(OFF.max(board.still_ramping)),
        set(&[(CoilDrive, true), (SourceOn, true)]),
    ]);
    acts.extend(until_made());
    acts.extend(drop_of_closure(context));
    acts.extend(reversed(context));
    let left = BoardState {
        supply,
        armature: Armature::Unknown,
        still_ramping: Span(0),
        ..board
    };
    (acts, left)
}

/// Takes the drive off and times the make of NC. The counter readings of a timed operation remain valid, because the
/// latch shuts both gates until ARM. A release into the diode first operates the relay anew, since the board selects
/// the diode only without coil current.
pub(super) fn acts_release(context: &Context, board: BoardState) -> (Vec<Act>, BoardState) {
    let diode = select_diode(context, true);
    let counted = board.armature == Armature::Operated && diode.is_none();
    let (mut acts, mut board) = match counted {
        true => (Vec::new(), board),
        false => operated(context, board, diode),
    };
    assert_eq!(board.armature, Armature::Operated, "nothing to release");
    acts.extend([set(&[
        (SourceOn, false),
        (SourceReverse, false),
        (SelectNo, false),
        (Arm, true),
    ])]);
    acts.extend((!counted).then_some(Act::Read(Read::Gates)));
    acts.push(set(&[(CoilDrive, false), (SourceOn, true)]));
    acts.extend(until_made());
    // Supply and bus are free until the window closes.
    acts.extend(rest(context, &mut board.supply));
    acts.extend(drop_of_closure(context));
    acts.extend(select_diode(context, false));
    board.armature = Armature::Rested;
    (acts, board)
}

/// Operates the armature at nominal voltage without contact load, because the test does not read this closure.
fn operated(
    context: &Context,
    mut board: BoardState,
    diode: Option<Act>,
) -> (Vec<Act>, BoardState) {
    let mut acts = drive_off(board.armature);
    if let Some(diode) = diode {
        acts.extend([Act::WaitSinceMark(OFF), diode]);
    }
    acts.extend([
        set(&[(RampMode, false), (EventNoBreak, false), (SourceOn, false)]),
        board.supply.step_to(Volt(context.relay.part.nominal_v)),
        set(&[(CoilDrive, true), (SelectNo, true)]),
        Act::Wait(Span::ms(40)),
    ]);
    board.armature = Armature::Operated;
    (acts, board)
}

// ARM rises in the same write as the selection: it clears window and latch, so that the selection triggers neither.

/// Waits for the contact event and marks it; bounce, window and source settle after that mark.
fn until_made() -> [Act; 2] {
    [
        Act::Until {
            point: DigitalIn::Latch,
            within: LONGEST_OPERATION,
        },
        Act::Mark,
    ]
}

/// Reads the gates after the window has closed, then the drop with the source forward. The source is switched on before
/// the contact makes; it drives current only after 5 ms of closure, in the direction of the contact monitor, so that
/// gate 1 counts no opening.
fn drop_of_closure(context: &Context) -> [Act; 6] {
    [
        Act::WaitSinceMark(WINDOW_AFTER_LATCH),
        Act::Read(Read::Gates),
        Act::Read(Read::Board),
        set(&[(Arm, false)]),
        Act::ConvertSinceMark(SOURCE_FLOWS + SOURCE_SETTLES + context.fresh(1)),
        Act::Read(Read::Drop),
    ]
}

/// Records time and bounce from both gates of a stage; ends the test when the counts are implausible.
fn time_and_bounce(
    context: &Context,
    readings: &Readings,
    time: Parameter,
    bounce: Parameter,
    record: &mut TestRecord,
) {
    let [.., before, after] = readings.gates.as_slice() else {
        record.stop(Finding::GatesNotRead);
        return;
    };
    let gate0 = counts(before[0].count, after[0].count);
    let gate1 = counts(before[1].count, after[1].count);
    let longest = (LONGEST_OPERATION + WINDOW_AFTER_LATCH).as_seconds() * context.clock().hz;
    // No contact moves within one count, so a gate without counts means that the counter has restarted.
    let still = gate0 == 0;
    if still || f64::from(gate0.max(gate1)) > longest || gate1 + GATE_SKEW < gate0 {
        let detail = format!("{gate0} and {gate1} counts");
        record.stop(Finding::GatesImplausible.with(detail));
        return;
    }
    let samples: Vec<_> = before.iter().chain(after).collect();
    let delay = context.calibration.gate_delay_us;
    record.found(
        time,
        gate_ms(gate0, delay[0], context.clock()),
        samples.clone(),
    );
    record.found(
        bounce,
        bounce_ms(gate0, gate1, delay, context.clock()),
        samples,
    );
}

pub(super) fn conclude_operate(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
) -> Option<Stage> {
    if readings.seen.first() != Some(&true) {
        return not_made(readings, state);
    }
    let record = &mut state.record;
    time_and_bounce(
        context,
        readings,
        Parameter::OperateTime,
        Parameter::OperateBounce,
        record,
    );
    state.board.armature = Armature::Operated;
    let u_v = context.reading_u_v();
    match closure(context, readings) {
        Ok(closure) => {
            let drop = match context.alternates() {
                true => ContactDrop::single(closure.drop, false, u_v),
                false => ContactDrop::reversed(closure, u_v),
            };
            contact::add(context, (Contact::No, drop), &readings.drops, state);
        }
        Err(unread) => record.stop(unread.of(Contact::No)),
    }
    None
}

/// Concludes a timed operation in which NO did not make in time: the relay is late, or a contact does not move. For a
/// contact that does not move, returns the coil stage, because the coil may be the cause.
fn not_made(readings: &Readings, state: &mut TestState) -> Option<Stage> {
    let TestState { plan, record, .. } = state;
    plan.unmoved = match readings.boards.last() {
        Some(board) if board.no_closed => {
            record.stop(Finding::OperatesTooLate);
            None
        }
        Some(board) if board.nc_closed => Some(Finding::NcDoesNotOpen),
        Some(_) => Some(Finding::NoDoesNotMake),
        None => {
            record.stop(Finding::BoardNotRead);
            None
        }
    };
    plan.unmoved.map(|_| Stage::Coil)
}

pub(super) fn conclude_release(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
) -> Option<Stage> {
    let record = &mut state.record;
    if readings.seen.first() != Some(&true) {
        state.board.armature = Armature::Unknown;
        record.stop(Finding::ReleasesTooLate);
        return None;
    }
    time_and_bounce(
        context,
        readings,
        Parameter::ReleaseTime,
        Parameter::ReleaseBounce,
        record,
    );
    let compliance = readings.boards.iter().any(|board| board.compliance);
    match drop_of(readings.drops.first(), compliance) {
        Ok(drop) => {
            let drop = ContactDrop::single(drop, false, context.reading_u_v());
            contact::add(context, (Contact::Nc, drop), &readings.drops, state);
        }
        Err(unread) => record.stop(unread.of(Contact::Nc)),
    }
    None
}
