//! Inputs and outputs of feed, nests and sorter in one turn.

use super::ledger::Ledger;
use super::mechanism::{Mechanism, SENSOR_AGE};
use super::moves::Move;
use super::output::{Commands, PartEvents};
use super::place::{NestId, Place};
use super::serial::Serials;
use super::trouble::Trouble;
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
    /// End sensors and motions.
    pub mechanism: &'a Mechanism,
    /// Places of the parts.
    pub ledger: &'a mut Ledger,
    /// Commands of this turn to the rig.
    pub rig: &'a mut Commands,
    /// Events of parts in this turn.
    pub parts: &'a mut PartEvents,
    /// Troubles of this turn.
    pub trouble: &'a mut Vec<Trouble>,
    /// Serial numbers of the reference parts to come, in the order of the magazine.
    pub reference_serials: &'a mut VecDeque<String>,
    /// Serial numbers of the parts of the lot.
    pub serials: &'a mut Serials,
    /// Ordinal of the last part whose rows are safely on the disk.
    pub recorded: u64,
    /// True while the sequence goes to rest: no new action begins.
    pub resting: bool,
}

impl Turn<'_> {
    /// Requests a motion.
    pub fn drive(&mut self, movement: Move) {
        self.rig.motions.push(movement);
    }

    /// Reports a trouble.
    pub fn report(&mut self, trouble: Trouble) {
        self.trouble.push(trouble);
    }

    /// Returns true when the sensors show the end of the motion, and it is neither in progress nor requested.
    pub fn arrived(&self, movement: Move) -> bool {
        self.mechanism.has_arrived(movement, self.now, self.image)
    }

    /// Returns the state of a sensor; `None` unless its value is valid.
    pub fn input(&self, point: impl Into<DigitalInput>) -> Option<bool> {
        self.image.input(point, self.now, SENSOR_AGE)
    }

    /// Returns true when the sensor's value is valid and equals `state`.
    pub fn shows(&self, point: impl Into<DigitalInput>, state: bool) -> bool {
        self.input(point) == Some(state)
    }

    /// Returns true when the pusher may push a part into the nest.
    pub fn nest_is_free(&self, nest: NestId) -> bool {
        !self.ledger.holds(Place::Nest(nest))
            && self.shows(DigitalIn::NestPresent, false)
            && self.arrived(Move::ClampOpen)
            && self.arrived(Move::ProbesDown)
            && self.arrived(Move::SortUp)
            && self.arrived(Move::EscapementHold)
    }

    /// Returns true when the pusher is back, or so far on its way back that the probes may rise beside it.
    pub fn probes_may_rise(&self) -> bool {
        self.arrived(Move::PusherRetract) || self.mechanism.pusher_left_the_probes(self.now)
    }

    /// Moves the part from the pocket to the nest. A part of this run becomes the next reference part as long as
    /// reference parts are due.
    pub fn enter_nest(&mut self, nest: NestId) {
        let reference = match self.ledger.is_pocket_found() {
            true => None,
            false => self.reference_serials.pop_front(),
        };
        self.ledger.enter_nest(nest, reference);
        self.serials.assign(self.ledger, Place::Nest(nest));
    }

    /// Adds a part to the empty pocket.
    pub fn enter_pocket(&mut self) {
        self.ledger.enter_pocket();
        self.arrived_in_pocket();
    }

    /// Adds a part of unknown origin to the empty place.
    pub fn find(&mut self, place: Place) {
        self.ledger.find(place);
        self.report(Trouble::Found(place));
        if place == Place::Pocket {
            self.arrived_in_pocket();
        }
    }

    fn arrived_in_pocket(&mut self) {
        let is_of_lot = self.reference_serials.is_empty();
        self.serials.arrived(self.now, is_of_lot);
    }

    /// Returns true when another part may leave the magazine: a reference part is due, or the next part of the lot
    /// needs no scan or has one.
    pub fn may_release(&self) -> bool {
        !self.reference_serials.is_empty() || self.serials.may_release()
    }

    /// Returns true when the part in the pocket needs no further reading.
    pub fn is_identified(&self) -> bool {
        !self.reference_serials.is_empty()
            || self.ledger.is_pocket_found()
            || self.serials.is_settled(self.now)
    }
}
