//! Feed: one part from the magazine track into the pocket, and from the pocket into the nest.
//!
//! ```text
//! empty -> releasing -> holding -> ready -> pushing -> retracting -> empty
//! ```
//! The pocket fills while the part before is tested. The pusher starts only when the nest is empty, the
//! jaws are open, the probes down and the gripper up; the guard checks the same in millimetres.

use super::moves::Move;
use super::trouble::Alarm;
use super::turn::Turn;
use crate::rig::point::DigitalIn;
use crate::units::{RigTime, Span};

/// A part needs at most this long from the escapement to the pocket sensor.
const ARRIVES: Span = Span::ms(1500);

/// Where the feed stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feed {
    /// No part in the pocket.
    Empty,
    /// Escapement open, a part is coming.
    Releasing {
        /// When it was opened.
        since: RigTime,
    },
    /// The part is in the pocket, the escapement closes.
    Holding,
    /// A part waits in the pocket.
    Ready,
    /// Pusher on its way to the nest.
    Pushing,
    /// Part delivered, pusher on its way back.
    Retracting,
}

impl Feed {
    /// One turn. `wanted`: a further part may enter the pocket.
    pub fn step(self, turn: &mut Turn, wanted: bool) -> Feed {
        match self {
            Feed::Empty if wanted && turn.seen(DigitalIn::PocketPresent, true) => {
                // Left there by the run before: it is fed like any other.
                turn.ledger.enter_pocket();
                Feed::Ready
            }
            Feed::Empty if wanted && turn.arrived(Move::PusherRetract) => {
                turn.drive(Move::EscapementRelease);
                Feed::Releasing { since: turn.now }
            }
            Feed::Empty => Feed::Empty,
            Feed::Releasing { since } => releasing(turn, since),
            Feed::Holding if turn.arrived(Move::EscapementHold) => Feed::Ready,
            Feed::Holding => Feed::Holding,
            Feed::Ready if turn.nest_is_free() => {
                turn.drive(Move::PusherExtend);
                Feed::Pushing
            }
            Feed::Ready => Feed::Ready,
            Feed::Pushing if turn.arrived(Move::PusherExtend) => pushed(turn),
            Feed::Pushing => Feed::Pushing,
            Feed::Retracting if turn.arrived(Move::PusherRetract) => Feed::Empty,
            Feed::Retracting => Feed::Retracting,
        }
    }
}

fn releasing(turn: &mut Turn, since: RigTime) -> Feed {
    if turn.seen(DigitalIn::PocketPresent, true)
        && turn.image.input_at(DigitalIn::PocketPresent) > Some(since)
    {
        turn.ledger.enter_pocket();
        turn.drive(Move::EscapementHold);
        return Feed::Holding;
    }
    if turn.now.since(since) > ARRIVES {
        turn.alarm(Alarm::no_part());
    }
    Feed::Releasing { since }
}

fn pushed(turn: &mut Turn) -> Feed {
    match turn.input(DigitalIn::NestPresent) {
        Some(true) => {
            let golden = turn.next_golden();
            turn.ledger.enter_nest(golden);
            turn.drive(Move::PusherRetract);
            Feed::Retracting
        }
        Some(false) => {
            turn.alarm(Alarm::nest_empty());
            Feed::Pushing
        }
        None => Feed::Pushing,
    }
}
