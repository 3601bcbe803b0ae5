//! Actuators that stand: each must go on showing the end where it stopped, and never both ends at once.
//!
//! A look that differs for less than [`DEBOUNCE`] is a bounce: counted, not believed; while it is not known which, no
//! motion begins. A sensor that was not read says nothing here; that is trouble of its line. The drive of the axis is
//! watched from its reset on.

use super::mechanism::{DEBOUNCE, SENSOR_AGE};
use super::moves::Move;
use super::trouble::Trouble;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use units::RigTime;

/// Where an actuator stopped.
#[derive(Debug, Clone, Copy)]
struct Stand {
    movement: Move,
    left_since: Option<RigTime>,
    both_since: Option<RigTime>,
}

/// All that stand.
#[derive(Debug, Default)]
pub struct Watch {
    stands: Vec<Stand>,
    bounces: u64,
    /// When the drive of the axis was reset; an alarm that it showed before that is being dealt with.
    drive_reset: Option<RigTime>,
}

impl Watch {
    /// The end of a motion was seen.
    pub fn stands(&mut self, movement: Move) {
        self.left(movement.actuator_key());
        assert!(self.stands.len() < 7, "more stand than there are actuators");
        self.stands.push(Stand {
            movement,
            left_since: None,
            both_since: None,
        });
    }

    /// An actuator is sent somewhere else.
    pub fn left(&mut self, key: &str) {
        self.stands
            .retain(|stand| stand.movement.actuator_key() != key);
    }

    /// Nothing stands.
    pub fn forget(&mut self) {
        self.stands.clear();
        self.drive_reset = None;
    }

    /// The drive of the axis has been reset, and is watched from then on.
    pub fn drive_reset(&mut self, at: RigTime) {
        self.drive_reset = Some(at);
    }

    /// An end sensor differs from where its actuator stands, and it is not known yet whether that is a bounce.
    pub fn is_in_doubt(&self) -> bool {
        let mut stands = self.stands.iter();
        stands.any(|stand| stand.left_since.is_some() || stand.both_since.is_some())
    }

    /// Flickers seen.
    pub fn bounces(&self) -> u64 {
        self.bounces
    }

    /// One look; what has been wrong for long enough is an alarm, and no longer watched.
    pub fn look(&mut self, now: RigTime, image: &Image) -> Vec<Trouble> {
        let seen = |point: DigitalIn| image.input(point, now, SENSOR_AGE);
        let mut trouble = Vec::new();
        let since = self.drive_reset.zip(image.input_at(DigitalIn::AxisAlarm));
        let watched = since.is_some_and(|(reset, read)| read >= reset);
        if watched && seen(DigitalIn::AxisAlarm) == Some(true) {
            self.drive_reset = None;
            trouble.push(Trouble::AxisDrive);
        }
        let bounces = &mut self.bounces;
        self.stands.retain_mut(|stand| {
            let movement = stand.movement;
            let left = movement
                .arrival()
                .iter()
                .any(|(point, state)| seen(*point) == Some(!*state));
            let both = movement
                .other_end()
                .iter()
                .any(|point| seen(*point) == Some(true));
            let (left, both) = (
                lasts(&mut stand.left_since, left, now, bounces),
                lasts(&mut stand.both_since, both, now, bounces),
            );
            match (both, left) {
                (true, _) => trouble.push(Trouble::BothEnds(movement)),
                (false, true) => trouble.push(gone(movement)),
                (false, false) => return true,
            }
            false
        });
        trouble
    }
}

fn gone(movement: Move) -> Trouble {
    match movement {
        Move::GripperClose => Trouble::Dropped,
        Move::EscapementRelease
        | Move::EscapementHold
        | Move::PusherExtend
        | Move::PusherRetract
        | Move::ClampClose
        | Move::ClampOpen
        | Move::ProbesUp
        | Move::ProbesDown
        | Move::AxisTo(_)
        | Move::SortDown
        | Move::SortUp
        | Move::GripperOpen => Trouble::LeftEnd(movement),
    }
}

/// True once something has been so for the whole debounce time.
fn lasts(since: &mut Option<RigTime>, is_so: bool, now: RigTime, bounces: &mut u64) -> bool {
    match (is_so, *since) {
        (true, Some(from)) => now.since(from) >= DEBOUNCE,
        (true, None) => {
            *since = Some(now);
            false
        }
        (false, Some(_)) => {
            *bounces += 1;
            *since = None;
            false
        }
        (false, None) => false,
    }
}
