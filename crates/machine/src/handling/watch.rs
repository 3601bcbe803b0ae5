//! Watches resting actuators: each must keep showing its end, and never both ends at once.
//!
//! A deviation shorter than [`DEBOUNCE`] is a bounce, which only increments a count. While it is open whether a
//! deviation is a bounce, no motion begins. An unread sensor is no trouble here; its line reports it. The alarm of the
//! axis drive is watched too, once the drive has been reset.

use super::mechanism::{DEBOUNCE, SENSOR_AGE};
use super::moves::Move;
use super::trouble::Trouble;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use crate::rig::stroke::ActuatorKey;
use units::RigTime;

/// A resting actuator.
#[derive(Debug, Clone, Copy)]
struct Resting {
    movement: Move,
    left_since: Option<RigTime>,
    both_since: Option<RigTime>,
}

/// All resting actuators.
#[derive(Debug, Default)]
pub struct Watch {
    resting: Vec<Resting>,
    bounces: u64,
    /// Time at which the axis drive was reset. Before the reset its alarm is not watched, because homing handles it.
    drive_reset: Option<RigTime>,
}

impl Watch {
    /// Adds an actuator that has reached the end of `movement`.
    pub fn add(&mut self, movement: Move) {
        self.remove(movement.key());
        assert!(
            self.resting.len() < ActuatorKey::COUNT,
            "more resting actuators than actuators"
        );
        self.resting.push(Resting {
            movement,
            left_since: None,
            both_since: None,
        });
    }

    /// Removes an actuator that begins a motion.
    pub fn remove(&mut self, key: ActuatorKey) {
        self.resting.retain(|it| it.movement.key() != key);
    }

    /// Removes all actuators.
    pub fn forget(&mut self) {
        self.resting.clear();
        self.drive_reset = None;
    }

    /// Records the reset of the axis drive and begins to watch the drive.
    pub fn drive_reset(&mut self, at: RigTime) {
        self.drive_reset = Some(at);
    }

    /// Returns true while a deviation may be a fault or a bounce.
    pub fn is_undecided(&self) -> bool {
        let mut resting = self.resting.iter();
        resting.any(|it| it.left_since.is_some() || it.both_since.is_some())
    }

    /// Returns the number of bounces.
    pub fn bounces(&self) -> u64 {
        self.bounces
    }

    /// Checks the sensors once; reports a deviation that has lasted for the debounce time, and stops watching that
    /// actuator.
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
        self.resting.retain_mut(|one| {
            let movement = one.movement;
            let left = movement
                .arrival()
                .iter()
                .any(|(point, state)| seen(*point) == Some(!*state));
            let both = movement
                .other_end()
                .iter()
                .any(|point| seen(*point) == Some(true));
            let (left, both) = (
                lasts(&mut one.left_since, left, now, bounces),
                lasts(&mut one.both_since, both, now, bounces),
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
    if movement == Move::GripperClose {
        return Trouble::Dropped;
    }
    Trouble::LeftEnd(movement)
}

/// Returns true once the state has lasted for the debounce time; counts a bounce when it ended before.
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
