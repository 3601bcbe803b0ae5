//! Homing and recovery from any position: after power-up, crash, jam or emergency stop.
//!
//! 1. Resets the drive of the axis and switches its servo on, before any motion.
//! 2. Raises z, before anything else moves near the nest.
//! 3. Compares the ledger with the sensors, which decide where parts are. Reports a part unknown to the ledger as
//!    *found*, a part that no sensor shows as *lost*, and a missing part that an earlier run
//!    [left inside](super::inside) as *gone*.
//! 4. Brings every other actuator to rest, one at a time. A motion that the guard refuses waits until the others are
//!    home; an alarm follows when only refused motions remain. Fingers that hold a part stay closed.
//! 5. The ordinary sequence (feed, nest without a test, sort) then discharges the parts inside to retest.
//!
//! Homing never moves from an assumed position: safe outputs invalidate the position of the axis, and for the guard an
//! actuator without an active end sensor occupies its whole stroke.

use super::ledger::Ledger;
use super::moves::Move;
use super::place::{NestId, Place};
use super::trouble::Trouble;
use super::turn::Turn;
use crate::rig::axis::AxisStation;
use crate::rig::point::{DigitalIn, DigitalOut};
use std::collections::VecDeque;
use units::{RigTime, Span};

const ORDER: [Move; 6] = [
    Move::ProbesDown,
    Move::PusherRetract,
    Move::EscapementHold,
    Move::ClampOpen,
    Move::GripperOpen,
    Move::AxisTo(AxisStation::Nest),
];

/// Time for the drive to accept its reset.
const DRIVE_RESET: Span = Span::ms(50);

/// Progress of homing.
#[derive(Debug, Clone, PartialEq, Eq)]
enum HomingStep {
    /// Waiting for the first values of all part sensors.
    Looking,
    /// Resetting the drive, since this time.
    Drive(RigTime),
    Up,
    Home,
}

/// State of homing.
#[derive(Debug, Clone)]
pub struct Recovery {
    stage: HomingStep,
    left: VecDeque<Move>,
    requested: Option<Move>,
    refused: usize,
}

impl Default for Recovery {
    fn default() -> Self {
        Self {
            stage: HomingStep::Looking,
            left: ORDER.into(),
            requested: None,
            refused: 0,
        }
    }
}

impl Recovery {
    /// Steps homing once; returns true when everything is home. `releasing`: the escapement may have let a part through
    /// before the cut-off.
    pub fn step(&mut self, turn: &mut Turn, releasing: bool) -> bool {
        match self.stage {
            HomingStep::Looking => {
                if SensedParts::of(turn).is_some() {
                    turn.rig.outputs.push((DigitalOut::AxisReset, true));
                    self.stage = HomingStep::Drive(turn.now);
                }
            }
            HomingStep::Drive(since) => self.drive(turn, since),
            HomingStep::Up if !turn.arrived(Move::SortUp) => self.request(turn, Move::SortUp),
            HomingStep::Up => {
                if let Some(seen) = SensedParts::of(turn) {
                    pushed(turn, &seen);
                    reconcile(turn, &seen, releasing);
                    self.leave_gripped(turn.ledger);
                    (self.stage, self.requested) = (HomingStep::Home, None);
                }
            }
            HomingStep::Home => return self.home(turn),
        }
        false
    }

    /// Returns true when the reset of the drive ends in this turn.
    pub fn drive_reset(&self, now: RigTime) -> bool {
        matches!(self.stage, HomingStep::Drive(since) if now.since(since) >= DRIVE_RESET)
    }

    /// Moves a motion that the guard refused to the end of the list; returns false when every remaining motion has been
    /// refused.
    pub fn refused(&mut self, movement: Move) -> bool {
        if self.requested != Some(movement) || self.stage != HomingStep::Home {
            return false;
        }
        let first = self.left.front();
        assert_eq!(first, Some(&movement), "homing requested another motion");
        self.requested = None;
        self.refused += 1;
        self.left.rotate_left(1);
        self.refused < self.left.len()
    }

    /// Waits for the end of the drive's reset, then switches the servo on; reports the drive if its alarm is still on.
    /// The axis does not move before.
    fn drive(&mut self, turn: &mut Turn, since: RigTime) {
        let taken = since + DRIVE_RESET;
        let looked = turn.image.input_at(DigitalIn::AxisAlarm) >= Some(taken);
        if turn.now < taken {
            turn.rig.wake_at = Some(taken);
        } else if looked && turn.shows(DigitalIn::AxisAlarm, true) {
            turn.report(Trouble::AxisDrive);
        } else if looked {
            turn.rig.outputs.push((DigitalOut::AxisReset, false));
            turn.rig.outputs.push((DigitalOut::AxisServoOn, true));
            self.stage = HomingStep::Up;
        }
    }

    fn request(&mut self, turn: &mut Turn, movement: Move) {
        if self.requested != Some(movement) {
            turn.drive(movement);
            self.requested = Some(movement);
        }
    }

    /// Keeps fingers that hold a part closed; the axis stays where it is until it carries the part to its bin.
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
            (self.requested, self.refused) = (None, 0);
        } else {
            self.request(turn, movement);
        }
        self.left.is_empty()
    }
}

/// Places in which sensors show a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SensedParts {
    /// In the pocket.
    pub pocket: bool,
    /// In the nest.
    pub nest: bool,
    /// Between the fingers.
    pub gripper: bool,
}

impl SensedParts {
    fn of(turn: &Turn) -> Option<Self> {
        Some(Self {
            pocket: turn.input(DigitalIn::PocketPresent)?,
            nest: turn.input(DigitalIn::NestPresent)?,
            gripper: turn.input(DigitalIn::GripperPart)?,
        })
    }
}

/// Moves a part in the ledger from the pocket to the nest if the pusher had delivered it before the cut-off, so that
/// the nest sensor is not taken to show a part that slid from the fingers.
fn pushed(turn: &mut Turn, seen: &SensedParts) {
    let gone = turn.ledger.holds(Place::Pocket) && !seen.pocket;
    if gone && !turn.ledger.holds(Place::NEST) && seen.nest {
        turn.enter_nest(NestId::FIRST);
    }
}

/// Brings the ledger in line with the sensors, with z up; reports parts that are found or missing.
fn reconcile(turn: &mut Turn, seen: &SensedParts, releasing: bool) {
    let missing = std::mem::take(&mut turn.ledger.left).missing(seen);
    turn.trouble.extend(missing);
    hand_over(turn.ledger, seen);
    let places = [
        (Place::Gripper, seen.gripper),
        (Place::NEST, seen.nest),
        (Place::Pocket, seen.pocket),
    ];
    for (place, is_seen) in places {
        match (turn.ledger.holds(place), is_seen) {
            (true, false) => {
                turn.ledger.lose(place);
                turn.report(Trouble::Lost(place));
            }
            (false, true) if releasing && place == Place::Pocket => turn.enter_pocket(),
            (false, true) => turn.find(place),
            (true, true) | (false, false) => {}
        }
        assert_eq!(
            turn.ledger.holds(place),
            is_seen,
            "the ledger differs from the sensors"
        );
    }
}

/// Moves parts in the ledger that advanced before the cut-off, were set down again, or never left the fingers.
fn hand_over(ledger: &mut Ledger, seen: &SensedParts) {
    let may_be_held = ledger.fall().is_some_and(|it| !it.has_left);
    if may_be_held && seen.gripper {
        ledger.return_to_gripper();
    }
    let (nest, gripper) = (ledger.holds(Place::NEST), ledger.holds(Place::Gripper));
    if nest && !gripper && !seen.nest && seen.gripper {
        ledger.lift(NestId::FIRST);
    } else if gripper && !nest && !seen.gripper && seen.nest {
        ledger.set_down(NestId::FIRST);
    }
}
