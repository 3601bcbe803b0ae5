//! The sorter: carries the part to its bin, releases it, waits for the beam, returns over the nest.
//!
//! ```text
//! returning -> over nest -> lowering -> at part -> (nest closes fingers, lifts) -> carrying
//!           -> over bin -> letting go -> opening -> returning
//! ```
//! The sorter does not return while its open fingers still hold a part, because they would drop this part on the next
//! one.
//!
//! It releases a part only when the part's rows are safely on the disk and the previous part has passed its beam. z
//! comes down early, during the test, once the pusher has returned. Fingers also open before they close once more on a
//! part that they missed (`mechanism.rs`), in homing (`recovery.rs`) and by hand (`crate::station::answers`).

use super::ledger::Ledger;
use super::moves::Move;
use super::output::Landed;
use super::place::Place;
use super::trouble::Trouble;
use super::turn::Turn;
use crate::rig::axis::{AxisStation, AxisTable};
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

/// Longest time that a part takes from the opening of the gripper to the beam.
const FALL: Span = Span::ms(1500);

/// Time after the opening of the fingers from which a part that their sensor still shows counts as sticking.
const STICKS: Span = Span::ms(500);

/// Longest time between the counts of a part and of a second body that clings to it, both at the same beam.
const SECOND_BODY: Span = Span::ms(80);

/// State of the sorter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// The axis returns to the nest, fingers open, z up.
    Returning,
    /// Over the nest, z up.
    OverNest,
    /// z goes down over the part in the nest.
    Lowering,
    /// Down, with open fingers around the part; the nest moves the gripper from here until the part is up.
    AtPart,
    /// The part is up, ready for its way to the bin.
    Loaded,
    /// The axis travels to the bin.
    Carrying(Bin),
    /// Over the bin since this time.
    OverBin(Bin, RigTime),
    /// The opening of the fingers is requested; the fingers still own the part until the rig drives that opening. Holds
    /// the bin, and the count of its beam before the opening.
    LettingGo(Bin, u32),
    /// The fingers open.
    Opening,
}

impl Sort {
    /// Steps the sorter once. `test_running`: the nest holds the part, so z may come down.
    pub fn step(self, turn: &mut Turn, table: &AxisTable, test_running: bool) -> Sort {
        match self {
            Sort::Returning if turn.arrived(Move::AxisTo(AxisStation::Nest)) => Sort::OverNest,
            Sort::Returning => Sort::Returning,
            Sort::OverNest
                if test_running
                    && !turn.resting
                    && turn.arrived(Move::PusherRetract)
                    && turn.arrived(Move::GripperOpen) =>
            {
                turn.drive(Move::SortDown);
                Sort::Lowering
            }
            Sort::OverNest => Sort::OverNest,
            Sort::Lowering if turn.arrived(Move::SortDown) => Sort::AtPart,
            Sort::Lowering => Sort::Lowering,
            Sort::AtPart => Sort::AtPart,
            Sort::Loaded => {
                let bin = turn
                    .ledger
                    .part(Place::Gripper)
                    .and_then(|part| part.bin)
                    .unwrap_or(Bin::RETEST);
                turn.drive(Move::AxisTo(AxisStation::Bin(bin)));
                Sort::Carrying(bin)
            }
            Sort::Carrying(bin) if turn.arrived(Move::AxisTo(AxisStation::Bin(bin))) => {
                Sort::OverBin(bin, turn.now)
            }
            Sort::Carrying(bin) => Sort::Carrying(bin),
            Sort::OverBin(bin, since) => over_bin(turn, table, bin, since),
            Sort::LettingGo(bin, before) => {
                turn.rig.beam = Some(table.beam(bin));
                Sort::LettingGo(bin, before)
            }
            Sort::Opening if turn.arrived(Move::GripperOpen) => opened(turn),
            Sort::Opening => Sort::Opening,
        }
    }

    /// Returns true when the open fingers are around the part.
    pub fn is_at_part(&self, turn: &Turn) -> bool {
        *self == Sort::AtPart && turn.arrived(Move::SortDown) && turn.arrived(Move::GripperOpen)
    }

    /// Records that a cleared motion was driven; fingers that open release their part.
    pub fn driven(self, movement: Move, ledger: &mut Ledger, now: RigTime) -> Sort {
        match (self, movement) {
            (Sort::LettingGo(bin, before), Move::GripperOpen) => {
                ledger.drop_over(bin, now, before);
                Sort::Opening
            }
            (other, _) => other,
        }
    }

    /// Takes over the part from the nest, with z up.
    pub fn carry(&mut self) {
        *self = Sort::Loaded;
    }
}

/// Releases the part once its rows are safely on the disk and the beam's count is known.
fn over_bin(turn: &mut Turn, table: &AxisTable, bin: Bin, since: RigTime) -> Sort {
    assert!(since <= turn.now, "over the bin in the future");
    let stay = Sort::OverBin(bin, since);
    let beam = table.beam(bin);
    // A beam that stays dark (interrupted) shows a full chute.
    if turn.ledger.fall().is_some() || turn.shows(beam, true) {
        return stay;
    }
    turn.rig.beam = Some(beam);
    let durable = turn
        .ledger
        .part(Place::Gripper)
        .is_some_and(|part| part.ordinal <= turn.recorded);
    let before = turn
        .image
        .events(beam)
        .filter(|count| count.origin.at > since);
    let (true, Some(before)) = (durable, before) else {
        return stay;
    };
    let before = before.count;
    turn.drive(Move::GripperOpen);
    Sort::LettingGo(bin, before)
}

/// Returns over the nest once the fingers are open and empty.
fn opened(turn: &mut Turn) -> Sort {
    if turn.shows(DigitalIn::GripperPart, false) {
        turn.drive(Move::AxisTo(AxisStation::Nest));
        return Sort::Returning;
    }
    let falling = turn.ledger.fall();
    let sticks = falling.is_some_and(|it| it.seen.is_none() && turn.now.since(it.since) > STICKS);
    if sticks && turn.shows(DigitalIn::GripperPart, true) {
        turn.ledger.return_to_gripper();
        turn.report(Trouble::Sticks);
    }
    Sort::Opening
}

/// Looks for the falling part at the beam, even while the sequence is stopped.
pub fn confirm(turn: &mut Turn, table: &AxisTable) {
    let now = turn.now;
    let seen_empty = turn.shows(DigitalIn::GripperPart, false);
    let Some(falling) = turn.ledger.fall_mut() else {
        return;
    };
    falling.has_left |= seen_empty;
    let (bin, since, before) = (falling.bin, falling.since, falling.beam_before);
    assert!(since <= now, "released in the future");
    let beam = table.beam(bin);
    turn.rig.beam = Some(beam);
    let count = turn
        .image
        .events(beam)
        .filter(|count| count.origin.at > since)
        .map(|count| (count.origin.at, count.count));
    match count.map(|(at, count)| (at, count.wrapping_sub(before) & 0xFFFF)) {
        // A count of 1 excludes a second body only if it was read at least this long after the first count.
        Some((at, 1)) if at.since(*falling.seen.get_or_insert(at)) >= SECOND_BODY => {
            landed(turn, bin);
        }
        Some((_, 1)) => {}
        Some((_, several)) if several > 1 => {
            turn.report(Trouble::Beam(bin, several));
            landed(turn, bin);
        }
        Some(_) | None if now.since(since) > FALL => overdue(turn, bin),
        Some(_) | None => {}
    }
}

/// Handles a part that the beam has not counted in time: the part is lost if it has left the fingers, and still held if
/// the sensor shows it. Waits while that sensor is unknown.
fn overdue(turn: &mut Turn, bin: Bin) {
    let falling = turn.ledger.fall();
    if falling.is_some_and(|it| it.has_left) {
        turn.ledger.lose(Place::Falling);
        turn.report(Trouble::Beam(bin, 0));
    } else if turn.shows(DigitalIn::GripperPart, true)
        && !turn.mechanism.is_moving(Move::GripperOpen)
    {
        turn.ledger.return_to_gripper();
    }
}

fn landed(turn: &mut Turn, bin: Bin) {
    if let Some(part) = turn.ledger.land() {
        turn.parts.landed.push(Landed {
            part,
            bin,
            at: turn.now,
        });
    }
}
