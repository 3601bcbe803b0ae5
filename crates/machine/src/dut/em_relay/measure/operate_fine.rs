//! Operate voltage on the fine ramp, around the estimate of the coarse ramp.
//!
//! The relay releases between the two ramps. The approach has two steps (0.93 of the start, then the start): after a
//! single step from zero the armature swings and operates some 30 mV below the quasi-static threshold.

use super::board::{Armature, BoardState, SentRamp, drive_off};
use super::operate::LATE;
use super::pace::Pace;
use super::ramp::{Expected, JUMP};
use super::{Context, OFF, set};
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::points::DigitalIn;
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::supply::Supply;
use units::{Span, Volt};

/// First step of the approach, as a fraction of the start of the fine ramp.
pub(super) const APPROACH: f64 = 0.93;
/// Highest voltage of the fine output that the stage leaves in place instead of taking it to 0, which takes 0.7 s a volt.
const LEFT: Volt = Volt(0.5);
/// Least voltage that the level output contributes to the first step of the approach; the coarse output contributes at
/// most the remainder.
const ROOM: Volt = Volt(0.3);
/// Largest excess of the coarse output over its share of the first step that the stage leaves in place.
const CLOSE: Volt = Volt(0.05);

pub(super) fn acts(
    context: &Context,
    board: BoardState,
    searched: Expected,
    pace: Pace,
) -> (Vec<Act>, BoardState) {
    let (scale, run_up) = (
        context.scale(),
        pace.run_up(context.calibration.fine_v_per_s.value),
    );
    let (placed, jump) = (searched.rising(run_up, scale), scale.of_range(JUMP));
    let (mut supply, moves) = (board.supply, board.still_ramping);
    let mut acts = drive_off(board.armature);
    acts.extend(make_room(context, &mut supply, moves, placed.start));
    acts.extend([
        supply.step_to(placed.start * APPROACH),
        // The supply may still move during the first step.
        Act::WaitSinceMark(OFF.max(Span(moves.0.saturating_sub(pace.approaches().0)))),
        set(&[
            (SourceOn, false),
            (SourceReverse, false),
            (RampMode, true),
            (SelectNo, true),
            (EventNoBreak, false),
            (CoilDrive, true),
        ]),
        Act::Wait(pace.approaches()),
        supply.step_to(placed.start),
        Act::Mark,
        set(&[(Arm, true)]),
    ]);
    let start = supply.total();
    acts.extend([
        supply.step_to(placed.start + jump),
        Act::Read(Read::Gates),
        Act::WaitSinceMark(pace.settles()),
    ]);
    let (ramp, takes) = supply.ramp_fine(supply.fine() + placed.span - jump);
    acts.extend([
        ramp,
        Act::Until {
            point: DigitalIn::Latch,
            within: takes + LATE,
        },
        Act::Mark,
        Act::Read(Read::Gate),
    ]);
    let left = BoardState {
        supply,
        armature: Armature::Unknown,
        ramp: Some(SentRamp {
            start,
            span: placed.span,
            takes,
        }),
        still_ramping: Span(0),
    };
    (acts, left)
}

/// Lowers the coarse output to the share that the approach leaves it, and a high fine output to 0. The previous ramp
/// still moves until `moves` after the last mark.
fn make_room(context: &Context, supply: &mut Supply, moves: Span, start: Volt) -> Vec<Act> {
    let (mut acts, scale) = (Vec::new(), context.scale());
    let mut wait = Span(0);
    if supply.fine() > scale.of_range(LEFT) {
        let (fine, takes) = supply.ramp_fine(Volt(0.0));
        acts.push(fine);
        wait = moves + takes;
    }
    let room =
        (start.0 * APPROACH - scale.of_range(ROOM).0).clamp(0.0, context.relay.test.coarse_span_v);
    if supply.coarse() > Volt(room) + scale.of_range(CLOSE) {
        let (coarse, takes) = supply.ramp_coarse(Volt(room));
        acts.push(coarse);
        wait = wait.max(takes);
    }
    if wait > Span(0) {
        acts.push(Act::Wait(wait));
    }
    acts
}
