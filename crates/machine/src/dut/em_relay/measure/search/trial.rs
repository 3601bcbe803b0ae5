//! Acts of one trial: from rest or from a sealed armature to a level, then a reading of the contacts.

use super::{REACH, Search};
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::measure::board::{Armature, BoardState, drive_off};
use crate::dut::em_relay::measure::operate_fine::APPROACH;
use crate::dut::em_relay::measure::pace::Pace;
use crate::dut::em_relay::measure::release::SEAL;
use crate::dut::em_relay::measure::{Context, INTERLOCK, OFF, TestRecord, set};
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::supply::Supply;
use crate::dut::em_relay::threshold::Direction;
use units::{Span, Volt};

/// Settling time of flux and armature between two levels of a sealed armature.
const SEALS: Span = Span::ms(25);

pub(in crate::dut::em_relay::measure) fn acts(
    context: &Context,
    board: BoardState,
    record: &TestRecord,
    search: Search,
) -> (Vec<Act>, BoardState) {
    let pace = Pace::of(record);
    let (mut acts, mut board) = match (search.begins_anew(), search.direction) {
        (true, Direction::Rising) => from_rest(board, pace, search.at),
        (true, Direction::Falling) => {
            let ramped = record.own.operate.is_some() && search.trials == 0;
            from_sealed(context, board, ramped)
        }
        (false, Direction::Rising | Direction::Falling) => (Vec::new(), board),
    };
    assert_eq!(board.armature, Armature::Unknown, "a trial is driven");
    acts.extend([
        board.supply.step_to(search.at),
        Act::Wait(search.dwell(pace)),
        Act::Read(Read::Board),
        Act::Mark,
    ]);
    (acts, board)
}

/// Takes the drive off until the armature rests and both ramps are down, then steps twice towards `at`: after a single
/// step from zero the relay operates some 30 mV below the threshold.
fn from_rest(board: BoardState, pace: Pace, at: Volt) -> (Vec<Act>, BoardState) {
    let mut supply = board.supply;
    let mut acts = drive_off(board.armature);
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    acts.extend([
        coarse,
        Act::Wait(takes),
        Act::RampSinceMark(OFF.max(pace.approaches()).max(board.still_ramping)),
        supply.step_to(at * APPROACH),
        set(&[
            (RampMode, false),
            (SelectNo, true),
            (EventNoBreak, false),
            (CoilDrive, true),
        ]),
        Act::Wait(pace.approaches()),
    ]);
    (acts, driven(board, supply))
}

/// Operates the armature, seals it at 0.95 of nominal, then steps to the near end of the interval. If `ramped`, first
/// takes the coarse output down.
fn from_sealed(context: &Context, board: BoardState, ramped: bool) -> (Vec<Act>, BoardState) {
    let (mut supply, test) = (board.supply, &context.relay.test);
    let near = Volt(test.expected_release_v + REACH * test.expected_release_sd_v);
    let mut acts = Vec::new();
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    if ramped {
        acts.extend([coarse, Act::Wait(takes)]);
    }
    acts.extend([
        // While a ramp still falls, the seal would exceed nominal voltage.
        Act::Wait(board.still_ramping),
        supply.step_to(Volt(SEAL * context.relay.part.nominal_v)),
        set(&[
            (SourceOn, false),
            (SourceReverse, false),
            (RampMode, true),
            (SelectNo, true),
            (Arm, false),
            (CoilDrive, true),
        ]),
        Act::Wait(INTERLOCK + SEALS),
        // The flux of a sealed armature falls slowly, so the step to the level comes last and is short.
        supply.step_to(near),
        Act::Wait(SEALS),
    ]);
    (acts, driven(board, supply))
}

/// Returns the board with the drive on; the state of the armature is unknown until the trial reads the contacts.
fn driven(board: BoardState, supply: Supply) -> BoardState {
    BoardState {
        supply,
        armature: Armature::Unknown,
        still_ramping: Span(0),
        ..board
    }
}
