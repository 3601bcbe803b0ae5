//! Homing and recovery from any position: after power-up, a crash, a jam, an emergency stop.
//!
//! 1. The drive of the axis is reset and its servo switched on; nothing has moved yet.
//! 2. z up, before anything else moves near the nest.
//! 3. The ledger is compared with what the sensors show: parts are where they are seen. A part that the
//!    ledger does not know is *found*, one that nobody sees is *lost*; both are told. So is one that a run
//!    before [left inside](super::inside).
//! 4. Every other actuator goes to its rest end, one at a time. A motion that the guard refuses waits
//!    until the others are home; when all that are left are refused, that is an alarm. Fingers that hold
//!    a part stay closed.
//! 5. What was inside is discharged to retest by the ordinary sequence (feed, clamp without a test, sort).
//!
//! Never a move from an assumed position: safe outputs made the station forget where the axis stood, and
//! an actuator without an end sensor on occupies its whole stroke for the guard.

use super::ledger::Ledger;
use super::moves::Move;
use super::place::{NestId, Place};
use super::trouble::Trouble;
use super::turn::Turn;
use crate::rig::axis::AxisStation;
use crate::rig::point::{DigitalIn, DigitalOut};
use std::collections::VecDeque;
use units::{RigTime, Span};

/// After z.
const ORDER: [Move; 6] = [
    Move::ProbesDown,
    Move::PusherRetract,
    Move::EscapementHold,
    Move::ClampOpen,
    Move::GripperOpen,
    Move::AxisTo(AxisStation::Nest),
];

/// The drive takes its reset within this time.
const DRIVE_RESET: Span = Span::ms(50);

/// How far it has come.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Stage {
    /// Sensors of the parts are not all read yet.
    Looking,
    /// Reset of the drive since then.
    Drive(RigTime),
    Up,
    Home,
}

/// Homing under way.
#[derive(Debug, Clone)]
pub struct Recovery {
    stage: Stage,
    left: VecDeque<Move>,
    asked: Option<Move>,
    refused: usize,
}

impl Default for Recovery {
    fn default() -> Self {
        Self {
            stage: Stage::Looking,
            left: ORDER.into(),
            asked: None,
            refused: 0,
        }
    }
}

impl Recovery {
    /// One turn; true when everything is home. `releasing`: the escapement may have let a part through.
    pub fn step(&mut self, turn: &mut Turn, releasing: bool) -> bool {
        match self.stage {
            Stage::Looking => {
                if Seen::of(turn).is_some() {
                    turn.rig.outputs.push((DigitalOut::AxisReset, true));
                    self.stage = Stage::Drive(turn.now);
                }
            }
            Stage::Drive(since) => self.drive(turn, since),
            Stage::Up if !turn.arrived(Move::SortUp) => self.ask(turn, Move::SortUp),
            Stage::Up => {
                if let Some(seen) = Seen::of(turn) {
                    pushed(turn, &seen);
                    reconcile(turn.ledger, &seen, releasing, turn.trouble);
                    self.leave_gripped(turn.ledger);
                    (self.stage, self.asked) = (Stage::Home, None);
                }
            }
            Stage::Home => return self.home(turn),
        }
        false
    }

    /// The reset of the drive ends in this turn.
    pub fn drive_reset(&self, now: RigTime) -> bool {
        matches!(self.stage, Stage::Drive(since) if now.since(since) >= DRIVE_RESET)
    }

    /// The guard refused what was asked for; false when there is nothing else to try first.
    pub fn refused(&mut self, movement: Move) -> bool {
        if self.asked != Some(movement) || self.stage != Stage::Home {
            return false;
        }
        let first = self.left.front();
        assert_eq!(first, Some(&movement), "homing asked for another one");
        self.asked = None;
        self.refused += 1;
        self.left.rotate_left(1);
        self.refused < self.left.len()
    }

    /// A drive that has not taken its reset is told again: the axis would not move.
    fn drive(&mut self, turn: &mut Turn, since: RigTime) {
        let taken = since + DRIVE_RESET;
        let looked = turn.image.input_at(DigitalIn::AxisAlarm) >= Some(taken);
        if turn.now < taken {
            turn.rig.wake_at = Some(taken);
        } else if looked && turn.seen(DigitalIn::AxisAlarm, true) {
            turn.tell(Trouble::AxisDrive);
        } else if looked {
            turn.rig.outputs.push((DigitalOut::AxisReset, false));
            turn.rig.outputs.push((DigitalOut::AxisServoOn, true));
            self.stage = Stage::Up;
        }
    }

    fn ask(&mut self, turn: &mut Turn, movement: Move) {
        if self.asked != Some(movement) {
            turn.drive(movement);
            self.asked = Some(movement);
        }
    }

    /// Fingers that hold a part stay closed, and the axis takes it to its bin from where it stands.
    fn leave_gripped(&mut self, ledger: &Ledger) {
        if ledger.holds(Place::Gripper) {
            self.left
                .retain(|one| !matches!(one, Move::GripperOpen | Move::AxisTo(_)));
        }
    }

    fn home(&mut self, turn: &mut Turn) -> bool {
        let Some(movement) = self.left.front().copied() else {
            return true;
        };
        if turn.arrived(movement) {
            self.left.pop_front();
            (self.asked, self.refused) = (None, 0);
        } else {
            self.ask(turn, movement);
        }
        self.left.is_empty()
    }
}

/// Where parts are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seen {
    /// In the pocket.
    pub pocket: bool,
    /// In the nest.
    pub nest: bool,
    /// Between the fingers.
    pub gripper: bool,
}

impl Seen {
    fn of(turn: &Turn) -> Option<Self> {
        Some(Self {
            pocket: turn.input(DigitalIn::PocketPresent)?,
            nest: turn.input(DigitalIn::NestPresent)?,
            gripper: turn.input(DigitalIn::GripperPart)?,
        })
    }
}

/// The pusher had brought the part of the pocket when the sequence was cut off: it is the one in the nest, and not
/// the one that the fingers have lost.
fn pushed(turn: &mut Turn, seen: &Seen) {
    let gone = turn.ledger.holds(Place::Pocket) && !seen.pocket;
    if gone && !turn.ledger.holds(Place::NEST) && seen.nest {
        let golden = match turn.ledger.is_pocket_found() {
            true => None,
            false => turn.next_golden(),
        };
        turn.ledger.enter_nest(NestId::FIRST, golden);
    }
}

/// Brings the ledger to what is seen, z being up. Parts in nest and gripper are interrupted by this.
pub fn reconcile(ledger: &mut Ledger, seen: &Seen, releasing: bool, trouble: &mut Vec<Trouble>) {
    trouble.extend(std::mem::take(&mut ledger.left).missing(seen));
    hand_over(ledger, seen);
    let places = [
        (Place::Gripper, seen.gripper),
        (Place::NEST, seen.nest),
        (Place::Pocket, seen.pocket),
    ];
    for (place, is_seen) in places {
        match (ledger.holds(place), is_seen) {
            (true, false) => {
                ledger.lose(place);
                trouble.push(Trouble::Lost(place));
            }
            (false, true) if releasing && place == Place::Pocket => ledger.enter_pocket(),
            (false, true) => {
                ledger.find(place);
                trouble.push(Trouble::Found(place));
            }
            (true, true) | (false, false) => {}
        }
        assert_eq!(ledger.holds(place), is_seen, "not what is seen");
    }
}

/// Parts that had moved on when the sequence was cut off, were set down again, or never let go.
fn hand_over(ledger: &mut Ledger, seen: &Seen) {
    let may_be_held = ledger.fall().is_some_and(|it| !it.has_left);
    if may_be_held && seen.gripper {
        ledger.keep_hold();
    }
    let (nest, gripper) = (ledger.holds(Place::NEST), ledger.holds(Place::Gripper));
    if nest && !gripper && !seen.nest && seen.gripper {
        ledger.lift(NestId::FIRST);
    } else if gripper && !nest && !seen.gripper && seen.nest {
        ledger.set_down(NestId::FIRST);
    }
}
