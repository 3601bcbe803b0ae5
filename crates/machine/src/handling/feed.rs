//! Feed: one part from the magazine track into the pocket, and from the pocket into the nest.
//!
//! ```text
//! empty -> releasing -> holding -> ready -> pushing -> retracting -> empty
//!              \-> closing -> empty (nothing came: tried again, then the line waits for parts)
//! ```
//! The pocket fills while the part before is tested. The pusher starts only when the nest is empty, the
//! jaws are open, the probes down and the gripper up; the guard checks the same in millimetres.

use super::moves::Move;
use super::place::NestId;
use super::trouble::Trouble;
use super::turn::Turn;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

/// A part needs at most this long from the escapement to the pocket sensor.
const ARRIVES: Span = Span::ms(1500);
/// The escapement is worked so often before the magazine counts as empty.
pub const TRIES: u8 = 3;

/// Where the feed stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feed {
    /// No part in the pocket.
    Empty,
    /// Escapement open, a part is coming.
    Releasing {
        /// When it was opened.
        since: RigTime,
        /// 1 for the first time.
        attempt: u8,
    },
    /// Nothing came; the escapement closes before it opens again.
    Closing {
        /// Times it was opened for nothing.
        attempts: u8,
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
    /// One turn. `wanted`: a further part may enter the pocket; `push`: the one that waits there may
    /// go to `nest`.
    pub fn step(self, turn: &mut Turn, nest: NestId, wanted: bool, push: bool) -> Feed {
        match self {
            Feed::Empty if wanted && turn.seen(DigitalIn::PocketPresent, true) => {
                // Left there by the run before: it is fed like any other.
                turn.ledger.enter_pocket();
                Feed::Ready
            }
            Feed::Empty if wanted && turn.arrived(Move::PusherRetract) => release(turn, 1),
            Feed::Empty => Feed::Empty,
            Feed::Releasing { since, attempt } => releasing(turn, since, attempt),
            Feed::Closing { attempts } if turn.arrived(Move::EscapementHold) => {
                if attempts < TRIES && wanted && !turn.seen(DigitalIn::PocketPresent, true) {
                    release(turn, attempts + 1)
                } else {
                    Feed::Empty
                }
            }
            Feed::Closing { attempts } => Feed::Closing { attempts },
            Feed::Holding if turn.arrived(Move::EscapementHold) => Feed::Ready,
            Feed::Holding => Feed::Holding,
            Feed::Ready if turn.nest_is_free(nest) && (push || turn.ledger.is_pocket_found()) => {
                turn.drive(Move::PusherExtend);
                Feed::Pushing
            }
            Feed::Ready => Feed::Ready,
            Feed::Pushing if turn.arrived(Move::PusherExtend) => pushed(turn, nest),
            Feed::Pushing => Feed::Pushing,
            Feed::Retracting if turn.arrived(Move::PusherRetract) => Feed::Empty,
            Feed::Retracting => Feed::Retracting,
        }
    }
}

fn release(turn: &mut Turn, attempt: u8) -> Feed {
    assert!((1..=TRIES).contains(&attempt), "called {attempt} times");
    turn.drive(Move::EscapementRelease);
    Feed::Releasing {
        since: turn.now,
        attempt,
    }
}

fn releasing(turn: &mut Turn, since: RigTime, attempt: u8) -> Feed {
    if turn.seen(DigitalIn::PocketPresent, true)
        && turn.image.input_at(DigitalIn::PocketPresent) > Some(since)
    {
        turn.ledger.enter_pocket();
        turn.drive(Move::EscapementHold);
        return Feed::Holding;
    }
    if turn.now.since(since) <= ARRIVES {
        return Feed::Releasing { since, attempt };
    }
    turn.drive(Move::EscapementHold);
    turn.tell(
        match (attempt < TRIES, turn.seen(DigitalIn::TrackLevel, true)) {
            (true, _) => Trouble::Retried(Move::EscapementRelease, ARRIVES),
            (false, true) => Trouble::NoPart,
            (false, false) => Trouble::MagazineEmpty,
        },
    );
    Feed::Closing { attempts: attempt }
}

fn pushed(turn: &mut Turn, nest: NestId) -> Feed {
    match turn.input(DigitalIn::NestPresent) {
        Some(true) => {
            let golden = if turn.ledger.is_pocket_found() {
                None
            } else {
                turn.next_golden()
            };
            turn.ledger.enter_nest(nest, golden);
            turn.drive(Move::PusherRetract);
            Feed::Retracting
        }
        Some(false) => {
            turn.tell(Trouble::NestEmpty);
            Feed::Pushing
        }
        None => Feed::Pushing,
    }
}
