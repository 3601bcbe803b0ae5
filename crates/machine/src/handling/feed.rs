//! The feed: moves one part from the magazine track into the pocket, and from there into the nest.
//!
//! ```text
//! empty -> releasing -> holding -> ready -> pushing -> retracting -> empty
//!              \-> closing -> empty (no part came: retry, then the line waits for parts)
//! ```
//! In a lot with a code reader the pusher also waits for the reading of the part ([`super::serial`]).
//! The pocket fills during the test of the previous part. The pusher starts only when the nest is empty, the jaws are
//! open, the probes down and the gripper up; the guard checks the same with the real geometry.

use super::moves::Move;
use super::place::NestId;
use super::trouble::Trouble;
use super::turn::Turn;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

/// Longest time that a part takes from the escapement to the pocket sensor.
const ARRIVES: Span = Span::ms(1500);
/// Escapement strokes without a part after which the magazine counts as empty.
pub const TRIES: u8 = 3;

/// State of the feed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feed {
    /// No part in the pocket.
    Empty,
    /// Escapement open, a part is coming.
    Releasing {
        /// Time at which the escapement opened.
        since: RigTime,
        /// Number of the attempt, from 1.
        attempt: u8,
    },
    /// No part came; the escapement closes before the next attempt.
    Closing {
        /// Number of attempts so far.
        attempts: u8,
    },
    /// The part is in the pocket, the escapement closes.
    Holding,
    /// A part waits in the pocket.
    Ready,
    /// The pusher moves to the nest.
    Pushing,
    /// The part is in the nest; the pusher returns.
    Retracting,
}

impl Feed {
    /// Steps the feed once. `wanted`: another part may enter the pocket; `push`: the part in the pocket may go to
    /// `nest`.
    pub fn step(self, turn: &mut Turn, nest: NestId, wanted: bool, push: bool) -> Feed {
        match self {
            Feed::Empty if wanted && turn.shows(DigitalIn::PocketPresent, true) => {
                // An earlier run left the part, or the part came after its time.
                turn.enter_pocket();
                Feed::Ready
            }
            Feed::Empty if wanted && turn.may_release() && turn.arrived(Move::PusherRetract) => {
                release(turn, 1)
            }
            Feed::Empty => Feed::Empty,
            Feed::Releasing { since, attempt } => releasing(turn, since, attempt),
            Feed::Closing { attempts } if turn.arrived(Move::EscapementHold) => {
                if attempts < TRIES && wanted && !turn.shows(DigitalIn::PocketPresent, true) {
                    release(turn, attempts + 1)
                } else {
                    Feed::Empty
                }
            }
            Feed::Closing { attempts } => Feed::Closing { attempts },
            Feed::Holding if turn.arrived(Move::EscapementHold) => Feed::Ready,
            Feed::Holding => Feed::Holding,
            Feed::Ready
                if turn.nest_is_free(nest)
                    && (push || turn.ledger.is_pocket_found())
                    && turn.is_identified() =>
            {
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
    assert!(
        (1..=TRIES).contains(&attempt),
        "escapement attempt {attempt}"
    );
    turn.drive(Move::EscapementRelease);
    turn.serials.released();
    Feed::Releasing {
        since: turn.now,
        attempt,
    }
}

fn releasing(turn: &mut Turn, since: RigTime, attempt: u8) -> Feed {
    if turn.shows(DigitalIn::PocketPresent, true)
        && turn.image.input_at(DigitalIn::PocketPresent) > Some(since)
    {
        turn.enter_pocket();
        turn.drive(Move::EscapementHold);
        return Feed::Holding;
    }
    if turn.now.since(since) <= ARRIVES {
        return Feed::Releasing { since, attempt };
    }
    turn.drive(Move::EscapementHold);
    turn.report(
        match (attempt < TRIES, turn.shows(DigitalIn::TrackLevel, false)) {
            (true, _) => Trouble::Retried(Move::EscapementRelease, ARRIVES),
            (false, true) => Trouble::MagazineEmpty,
            (false, false) => Trouble::NoPart,
        },
    );
    Feed::Closing { attempts: attempt }
}

fn pushed(turn: &mut Turn, nest: NestId) -> Feed {
    match turn.input(DigitalIn::NestPresent) {
        Some(true) => {
            turn.enter_nest(nest);
            turn.drive(Move::PusherRetract);
            Feed::Retracting
        }
        Some(false) => {
            turn.report(Trouble::NestEmpty);
            Feed::Pushing
        }
        None => Feed::Pushing,
    }
}
