//! What a step machine sees of one turn, and what it may ask for.

use super::ledger::Ledger;
use super::mechanism::{Mechanism, SENSOR_AGE};
use super::moves::Move;
use super::place::{NestId, Place};
use super::trouble::Trouble;
use super::wants::{Commands, PartEvents};
use crate::rig::image::Image;
use crate::rig::point::{DigitalIn, DigitalInput};
use std::collections::VecDeque;
use units::RigTime;

/// One turn of the feeder.
pub struct Turn<'a> {
    /// Time of this turn.
    pub now: RigTime,
    /// Process image.
    pub image: &'a Image,
    /// Sensors and motions.
    pub mechanism: &'a Mechanism,
    /// Where the parts are.
    pub ledger: &'a mut Ledger,
    /// What this turn asks of the rig.
    pub rig: &'a mut Commands,
    /// What has happened to parts in this turn.
    pub parts: &'a mut PartEvents,
    /// Trouble seen in this turn.
    pub trouble: &'a mut Vec<Trouble>,
    /// Golden parts still to come, in the order of the magazine.
    pub golden: &'a mut VecDeque<String>,
    /// Ordinal up to which parts are durably recorded.
    pub recorded: u64,
    /// The sequence goes to rest: nothing new begins.
    pub resting: bool,
}

impl Turn<'_> {
    /// Asks for a motion.
    pub fn drive(&mut self, movement: Move) {
        self.rig.motions.push(movement);
    }

    /// Tells of trouble.
    pub fn tell(&mut self, trouble: Trouble) {
        self.trouble.push(trouble);
    }

    /// True when the sensors show the end of the motion, nothing of it is under way or asked for.
    pub fn arrived(&self, movement: Move) -> bool {
        self.mechanism.has_arrived(movement, self.now, self.image)
    }

    /// A sensor, when it is fresh enough to be believed.
    pub fn input(&self, point: impl Into<DigitalInput>) -> Option<bool> {
        self.image.input(point, self.now, SENSOR_AGE)
    }

    /// True when the sensor is fresh and in this state.
    pub fn seen(&self, point: impl Into<DigitalInput>, state: bool) -> bool {
        self.input(point) == Some(state)
    }

    /// True when a part may be pushed into the nest.
    pub fn nest_is_free(&self, nest: NestId) -> bool {
        !self.ledger.holds(Place::Nest(nest))
            && self.seen(DigitalIn::NestPresent, false)
            && self.arrived(Move::ClampOpen)
            && self.arrived(Move::ProbesDown)
            && self.arrived(Move::SortUp)
            && self.arrived(Move::EscapementHold)
    }

    /// Serial of the next part when it is a golden one.
    pub fn next_golden(&mut self) -> Option<String> {
        self.golden.pop_front()
    }
}
