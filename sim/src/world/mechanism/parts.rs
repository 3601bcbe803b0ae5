//! Effects of strokes on the parts, and collisions between parts.

use super::{CylinderId, Mechanism, Scheduled};
use crate::truth::Place;
use crate::world::cylinder::Cylinder;
use crate::world::fault::Fault;
use crate::world::magazine::Part;
use crate::world::signal::In;

/// Moves the part out of `from` and records its arrival at the place `to`.
fn moved(from: &mut Option<Box<Part>>, now_us: u64, to: Place) -> Option<Box<Part>> {
    let mut part = from.take()?;
    part.arrive(now_us, to);
    Some(part)
}

/// Time that the code reader takes for a part, microseconds.
const CODE_READ_US: u64 = 120_000;

impl Mechanism {
    /// Moves parts at the start of a stroke.
    pub(super) fn stroke_began(&mut self, stroke: CylinderId, far: bool, now_us: u64) {
        let share = |percent: u64, of: &Cylinder| now_us + of.stroke_us() * percent / 100;
        match (stroke, far) {
            (CylinderId::Pusher, true) => {
                self.places.pushed = moved(&mut self.places.pocket, now_us, Place::Pusher);
                self.lookout.pulled_back = false;
            }
            (CylinderId::Pusher, false) if self.places.pushed.is_some() => {
                self.places.pocket = moved(&mut self.places.pushed, now_us, Place::Pocket);
                self.lookout.pulled_back = true;
            }
            (CylinderId::SortZ, true) => self.lookout.slides_off = false,
            (CylinderId::SortZ, false) if self.places.gripped => {
                let at = share(25, self.at(CylinderId::SortZ));
                self.scheduled.push((at, Scheduled::LiftOff));
            }
            (CylinderId::Gripper, false) => {
                let at = share(30, self.at(CylinderId::Gripper));
                self.scheduled.push((at, Scheduled::LetGo));
            }
            (_, _) => {}
        }
    }

    /// Moves parts at the end of a stroke.
    pub(super) fn stroke_ended(&mut self, stroke: CylinderId, now_us: u64) {
        if !self.at(stroke).at_far(now_us) {
            self.lookout.pulled_back &= stroke != CylinderId::Pusher;
            return;
        }
        match stroke {
            CylinderId::Escapement => self.drop_into_pocket(now_us),
            CylinderId::Pusher => self.push_into_nest(now_us),
            CylinderId::Gripper => self.grip(now_us),
            CylinderId::JawLeft
            | CylinderId::JawRight
            | CylinderId::ProbeLift
            | CylinderId::SortZ => {}
        }
    }

    pub(super) fn drop_into_pocket(&mut self, now_us: u64) {
        let free = self.places.pocket.is_none() && self.at(CylinderId::Pusher).at_rest(now_us);
        if !free
            || self.is_disturbed(Fault::Starved)
            || self
                .faults
                .strikes(Fault::NoPart, self.magazine.next_number())
        {
            return;
        }
        self.places.pocket = self.magazine.take(now_us, &mut self.faults).map(Box::new);
        self.read_code(now_us);
    }

    /// Lets the code reader read the part that has come into the pocket.
    fn read_code(&mut self, now_us: u64) {
        let (Some(reader), Some(part)) = (&self.code_reader, &self.places.pocket) else {
            return;
        };
        let unreadable = self.faults.strikes(Fault::UnreadableCode, part.number);
        let code = part.code.clone().filter(|_| !unreadable);
        let text = code.unwrap_or_else(|| reader.no_code.clone());
        if !text.is_empty() {
            let at_us = now_us + CODE_READ_US;
            self.scheduled.push((at_us, Scheduled::ReadCode(text)));
            self.schedule();
        }
    }

    pub(super) fn push_into_nest(&mut self, now_us: u64) {
        let Some(mut part) = self.places.pushed.take() else {
            return;
        };
        if self.faults.strikes(Fault::PartMisses, part.number) || self.places.nest.is_some() {
            part.arrive(now_us, Place::Floor);
            self.places.finish(&part);
        } else {
            self.places.enter_nest(part, now_us);
        }
    }

    pub(super) fn grip(&mut self, now_us: u64) {
        let over =
            !self.axis.is_moving() && self.axis.x_mm(now_us).abs() < self.table.axis_window_mm;
        let empty = self.places.carried.is_none();
        if over && empty && self.at(CylinderId::SortZ).at_far(now_us) && self.places.nest.is_some()
        {
            self.places.gripped = true;
        }
    }

    pub(super) fn lift_off(&mut self, now_us: u64) {
        if !self.places.gripped {
            return;
        }
        self.places.gripped = false;
        let number = self.places.nest.as_ref().and_then(|part| part.number);
        let open =
            [CylinderId::JawLeft, CylinderId::JawRight].map(|jaw| self.at(jaw).at_rest(now_us));
        let held = open != [true, true];
        let stays = self.faults.strikes(Fault::PartStays, number);
        // The jaws grip harder than the fingers, which slide off and leave the part in the nest.
        if stays || held {
            self.lookout.slides_off |= stays;
            return;
        }
        self.places.carried = moved(&mut self.places.nest, now_us, Place::Gripper);
    }

    /// Drops the part once the fingers have opened far enough.
    pub(super) fn release_part(&mut self, now_us: u64) {
        self.places.gripped = false;
        let number = self.places.carried.as_ref().and_then(|part| part.number);
        if self.faults.strikes(Fault::PartSticks, number) {
            let hold = (self.table.fault_hold_ms * 1000.0) as u64;
            self.scheduled.push((now_us + hold, Scheduled::TakenOut));
            return;
        }
        let x = self.axis.x_mm(now_us);
        let near = |at: f64| (x - at).abs() <= self.table.axis_window_mm;
        let bin = self
            .bins
            .iter()
            .find(|b| near(b.x_mm) && !self.axis.is_moving());
        let (name, beam) = match bin {
            Some(bin) => (bin.name.clone(), In::from_name(&bin.beam)),
            None if near(0.0) && self.at(CylinderId::SortZ).at_far(now_us) => {
                return self.return_to_nest(now_us);
            }
            None => return self.drop_carried(now_us),
        };
        if let Some(part) = moved(&mut self.places.carried, now_us, Place::Air) {
            self.fall(part, name, beam, now_us);
        }
    }

    pub(super) fn fall(&mut self, part: Box<Part>, bin: String, beam: Option<In>, now_us: u64) {
        let us = |ms: f64| (ms * 1000.0) as u64;
        let seen = !self.faults.strikes(Fault::BeamBlind, part.number);
        let bodies = if part.double { 2 } else { 1 };
        let mut dark = now_us + us(self.draw.between(self.table.fall_ms));
        self.scheduled.push((dark, Scheduled::Land(bin, part)));
        for _ in 0..bodies {
            let lit = dark + us(self.draw.between(self.table.beam_dark_ms));
            if let Some(beam) = beam.filter(|_| seen) {
                self.scheduled.push((dark, Scheduled::Dark(beam)));
                self.scheduled.push((lit, Scheduled::Lit(beam)));
            }
            dark = lit + us(25.0);
        }
    }

    /// Sets a carried part down in the nest.
    pub(super) fn return_to_nest(&mut self, now_us: u64) {
        if let Some(mut part) = self.places.carried.take() {
            match self.places.nest.is_some() {
                true => {
                    part.arrive(now_us, Place::Floor);
                    self.places.finish(&part);
                }
                false => self.places.enter_nest(part, now_us),
            }
        }
    }

    /// Removes a carried part: it falls to the floor, or an operator takes it away.
    pub(super) fn drop_carried(&mut self, now_us: u64) {
        if let Some(part) = moved(&mut self.places.carried, now_us, Place::Floor) {
            self.places.finish(&part);
        }
    }
}
