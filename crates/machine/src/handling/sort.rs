//! Sort: carry the part to its bin, let it go, see it pass the beam, come back over the nest.
//!
//! ```text
//! returning -> over nest -> lowering -> at part -> (nest closes fingers, lifts) -> carrying
//!           -> over bin -> letting go -> opening -> returning
//! ```
//! Open fingers that still show a part do not go back: it would be set down on the next one.
//!
//! A part is let go only when its rows are durable and the part before has passed its beam. z comes
//! down early, during the test, once the pusher is back.

use super::ledger::Ledger;
use super::moves::Move;
use super::place::Place;
use super::trouble::Trouble;
use super::turn::Turn;
use super::wants::Landed;
use crate::rig::axis::{AxisStation, AxisTable};
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

/// From the opening of the gripper to the beam at the latest.
const FALL: Span = Span::ms(1500);

/// A part that the open fingers still show so long after they began to open sticks to them.
const STICKS: Span = Span::ms(500);

/// A second body that clings to the part follows it through the beam within this time.
const SECOND_BODY: Span = Span::ms(80);

/// Where the sorter stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// Axis on its way back to the nest, fingers open, z up.
    Returning,
    /// Over the nest, z up.
    OverNest,
    /// z goes down over the clamped part.
    Lowering,
    /// Down with open fingers around the part; the nest commands from here until the part is up.
    AtPart,
    /// The part is up, the axis is to take it to its bin.
    Loaded,
    /// Axis on its way to the bin.
    Carrying(Bin),
    /// Over the bin since this instant.
    OverBin(Bin, RigTime),
    /// The fingers are to open; the part is theirs until the motion is driven. With the count of the beam before.
    LettingGo(Bin, u32),
    /// Fingers open.
    Opening,
}

impl Sort {
    /// One turn. `test_running`: the nest holds a clamped part, so z may come down.
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

    /// True when the open fingers stand around the part.
    pub fn is_at_part(&self, turn: &Turn) -> bool {
        *self == Sort::AtPart && turn.arrived(Move::SortDown) && turn.arrived(Move::GripperOpen)
    }

    /// A motion was cleared and driven: fingers that open let their part go.
    pub fn driven(self, movement: Move, ledger: &mut Ledger, now: RigTime) -> Sort {
        match (self, movement) {
            (Sort::LettingGo(bin, before), Move::GripperOpen) => {
                ledger.drop_over(bin, now, before);
                Sort::Opening
            }
            (other, _) => other,
        }
    }

    /// The nest has handed its part over and z is up.
    pub fn carry(&mut self) {
        *self = Sort::Loaded;
    }
}

/// Lets the part go once its rows are durable and the beam's count before is known.
fn over_bin(turn: &mut Turn, table: &AxisTable, bin: Bin, since: RigTime) -> Sort {
    assert!(since <= turn.now, "over the bin in the future");
    let stay = Sort::OverBin(bin, since);
    let beam = table.beam(bin);
    // A beam that stays dark is a full chute.
    if turn.ledger.fall().is_some() || turn.seen(beam, true) {
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

/// Open fingers go back empty only.
fn opened(turn: &mut Turn) -> Sort {
    if turn.seen(DigitalIn::GripperPart, false) {
        turn.drive(Move::AxisTo(AxisStation::Nest));
        return Sort::Returning;
    }
    let falling = turn.ledger.fall();
    let sticks = falling.is_some_and(|it| it.seen.is_none() && turn.now.since(it.since) > STICKS);
    if sticks && turn.seen(DigitalIn::GripperPart, true) {
        turn.ledger.keep_hold();
        turn.tell(Trouble::Sticks);
    }
    Sort::Opening
}

/// Watches the beam of the part that is falling; goes on whatever else has stopped.
pub fn confirm(turn: &mut Turn, table: &AxisTable) {
    let now = turn.now;
    let seen_empty = turn.seen(DigitalIn::GripperPart, false);
    let Some(falling) = turn.ledger.fall_mut() else {
        return;
    };
    falling.has_left |= seen_empty;
    let (bin, since, before) = (falling.bin, falling.since, falling.beam_before);
    assert!(since <= now, "let go in the future");
    let beam = table.beam(bin);
    turn.rig.beam = Some(beam);
    let count = turn
        .image
        .events(beam)
        .filter(|count| count.origin.at > since)
        .map(|count| (count.origin.at, count.count));
    match count.map(|(at, count)| (at, count.wrapping_sub(before) & 0xFFFF)) {
        // An older count knows nothing of what came after it.
        Some((at, 1)) if at.since(*falling.seen.get_or_insert(at)) >= SECOND_BODY => {
            landed(turn, bin);
        }
        Some((_, 1)) => {}
        Some((_, several)) if several > 1 => {
            turn.tell(Trouble::Beam(bin, several));
            landed(turn, bin);
        }
        Some(_) | None if now.since(since) > FALL => overdue(turn, bin),
        Some(_) | None => {}
    }
}

/// The beam has seen nothing: what has left the fingers is lost, what they still show was never let go. Who cannot
/// see them waits until they can be seen.
fn overdue(turn: &mut Turn, bin: Bin) {
    let falling = turn.ledger.fall();
    if falling.is_some_and(|it| it.has_left) {
        turn.ledger.lose(Place::Falling);
        turn.tell(Trouble::Beam(bin, 0));
    } else if turn.seen(DigitalIn::GripperPart, true)
        && !turn.mechanism.is_moving(Move::GripperOpen)
    {
        turn.ledger.keep_hold();
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
