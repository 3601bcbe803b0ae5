//! What is known of the mechanism: end sensors, motions under way, and the situation for the guard.
//!
//! An actuator is at an end only while its sensors say so and no motion of it is under way; otherwise
//! it may be anywhere on the way, or on its whole stroke. Sensors older than [`SENSOR_AGE`] say nothing.
//!
//! Trouble seen here: a stroke that does not arrive in time (a work stroke is tried once more, back and forth
//! again), an actuator that leaves the end where it stood, both end sensors on at once, the drive's alarm. A
//! sensor that flickers for less than [`DEBOUNCE`] is believed to bounce and counted.

use super::moves::{Move, Strokes};
use super::trouble::Trouble;
use super::watch::Watch;
use super::wear::Uses;
use crate::guard::{Actuator, PartPlaces, PartSize, Position, Situation};
use crate::rig::axis::AxisStation;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

/// Oldest sensor reading that is believed.
pub const SENSOR_AGE: Span = Span::ms(400);
/// After the start edge the drive needs this long to take "in position" away.
const AXIS_REACTS: Span = Span::ms(15);
/// A sensor must show trouble for so long: longer than two scans and the bounce of a reed contact.
pub const DEBOUNCE: Span = Span::ms(60);
/// A work stroke is tried again so often for one part.
const RETRIES: u8 = 1;

/// A motion that was driven and has not arrived.
#[derive(Debug, Clone, Copy)]
struct Underway {
    movement: Move,
    since: RigTime,
    from: [Position; 8],
}

impl Underway {
    /// Every sensor of its end was asked for at `since` or later.
    fn was_looked_at(&self, since: RigTime, image: &Image) -> bool {
        let mut arrival = self.movement.arrival().iter();
        arrival.all(|(point, _)| image.input_at(*point).is_some_and(|at| at >= since))
    }
}

/// A work stroke that failed and is being tried again: back to rest, then forth.
#[derive(Debug, Clone, Copy)]
struct Again {
    movement: Move,
    back: Move,
}

/// What an update has found.
#[derive(Debug, Default)]
pub struct Found {
    /// Trouble.
    pub trouble: Vec<Trouble>,
    /// Motions of a second try.
    pub motions: Vec<Move>,
}

/// Sensors and motions.
#[derive(Debug)]
pub struct Mechanism {
    strokes: Strokes,
    timeout: Vec<(&'static str, Span)>,
    underway: Vec<Underway>,
    /// Asked for and not released yet.
    waiting: Vec<Move>,
    again: Vec<Again>,
    /// Work strokes tried again for the part now in hand.
    tried: Vec<Move>,
    watch: Watch,
    strokes_made: Vec<(&'static str, u64)>,
    uses: Uses,
    axis_at: Option<AxisStation>,
    part_size: PartSize,
}

impl Mechanism {
    /// Nothing known, nothing under way.
    pub fn new(strokes: Strokes, timeout: Vec<(&'static str, Span)>, part_size: PartSize) -> Self {
        Self {
            strokes,
            timeout,
            underway: Vec::new(),
            waiting: Vec::new(),
            again: Vec::new(),
            tried: Vec::new(),
            watch: Watch::default(),
            strokes_made: Vec::new(),
            uses: Uses::default(),
            axis_at: None,
            part_size,
        }
    }

    /// Lengths of the strokes.
    pub fn strokes(&self) -> &Strokes {
        &self.strokes
    }

    /// True when every sensor of the end of `movement` says so and it is not under way.
    pub fn has_arrived(&self, movement: Move, now: RigTime, image: &Image) -> bool {
        if self.is_moving(movement) {
            return false;
        }
        let sent_there = match movement.station() {
            Some(station) => self.axis_at == Some(station),
            None => true,
        };
        sent_there && self.sensed(movement, now, image)
    }

    fn sensed(&self, movement: Move, now: RigTime, image: &Image) -> bool {
        movement
            .arrival()
            .iter()
            .all(|(point, state)| image.input(*point, now, SENSOR_AGE) == Some(*state))
    }

    /// True from the moment a motion of the same actuator was driven until it arrives.
    pub fn is_moving(&self, movement: Move) -> bool {
        let key = movement.actuator_key();
        let same = |other: &Move| other.actuator_key() == key;
        self.underway
            .iter()
            .any(|underway| same(&underway.movement))
            || self.waiting.iter().any(same)
            || self.again.iter().any(|again| same(&again.movement))
    }

    /// The motion under way on an actuator.
    pub fn moving(&self) -> impl Iterator<Item = Move> + '_ {
        self.underway.iter().map(|underway| underway.movement)
    }

    /// Some actuator may have left its end, or its sensor bounces: within [`DEBOUNCE`] it is known.
    pub fn is_in_doubt(&self) -> bool {
        self.watch.is_in_doubt()
    }

    /// Something is not where it should be, and no alarm names a cause yet: a sensor differs, or a motion has taken half of
    /// its time-out.
    pub fn is_suspicious(&self, now: RigTime) -> bool {
        let slow = |underway: &Underway| {
            let limit = self.timeout_of(underway.movement);
            now.since(underway.since).0 > limit.0 / 2
        };
        self.is_in_doubt() || self.underway.iter().any(slow)
    }

    /// Motions that wait for a step, or until no sensor is in doubt; none of their actuators counts as arrived.
    pub fn keep_waiting(&mut self, movements: &[Move]) {
        self.waiting.clear();
        self.waiting.extend_from_slice(movements);
    }

    /// Every output has gone safe: nothing that was under way or stood counts any more.
    pub fn forget(&mut self) {
        self.underway.clear();
        self.waiting.clear();
        self.again.clear();
        self.tried.clear();
        self.watch.forget();
        self.axis_at = None;
    }

    /// The drive of the axis has been reset, and is watched from then on.
    pub fn drive_reset(&mut self, at: RigTime) {
        self.watch.drive_reset(at);
    }

    /// A new part: its strokes may be tried again.
    pub fn new_part(&mut self) {
        self.tried.clear();
    }

    /// Strokes by actuator and flickers of end sensors since the start.
    pub fn wear(&self) -> Vec<(&'static str, u64)> {
        let strokes = self.strokes_made.iter().copied();
        strokes
            .chain(self.uses.each())
            .chain([("sensor_bounces", self.watch.bounces())])
            .collect()
    }

    /// Uses of what wears since the start.
    pub fn uses(&self) -> Uses {
        self.uses
    }

    /// A motion was driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        let from = self.positions(now, image);
        let key = movement.actuator_key();
        self.underway
            .retain(|underway| underway.movement.actuator_key() != key);
        self.watch.left(key);
        self.uses.probe_touches += u64::from(movement == Move::ProbesUp);
        self.uses.jaw_closings += u64::from(movement == Move::ClampClose);
        match self
            .strokes_made
            .iter_mut()
            .find(|(known, _)| *known == key)
        {
            Some((_, strokes)) => *strokes += 1,
            None => self.strokes_made.push((key, 1)),
        }
        self.underway.push(Underway {
            movement,
            since: now,
            from,
        });
        let actuators = Actuator::ALL.len();
        assert!(self.underway.len() < actuators, "one actuator moves twice");
        if let Some(station) = movement.station() {
            self.axis_at = Some(station);
        }
    }

    /// Takes note of arrivals; an actuator that takes too long is tried again or an alarm.
    pub fn update(&mut self, now: RigTime, image: &Image) -> Found {
        let mut found = Found::default();
        for underway in std::mem::take(&mut self.underway) {
            if self.is_there(&underway, now, image) {
                self.arrived(underway.movement, &mut found);
            } else if self.is_late(&underway, image) {
                self.late(underway, &mut found);
            } else {
                self.underway.push(underway);
            }
        }
        found.trouble.extend(self.watch.look(now, image));
        found
    }

    fn is_there(&self, underway: &Underway, now: RigTime, image: &Image) -> bool {
        let is_axis = matches!(underway.movement, Move::AxisTo(_));
        let believed = !is_axis || now.since(underway.since) >= AXIS_REACTS;
        believed
            && underway.was_looked_at(underway.since, image)
            && self.sensed(underway.movement, now, image)
    }

    /// A look that was asked for after the time-out has not shown the end: where replies are late, the look before it may
    /// be older than the stroke took.
    fn is_late(&self, underway: &Underway, image: &Image) -> bool {
        let limit = self.timeout_of(underway.movement);
        underway.was_looked_at(underway.since + limit, image)
    }

    /// Back at rest for a second try: forth again. Anything else stands now and is watched.
    fn arrived(&mut self, movement: Move, found: &mut Found) {
        match self.again.iter().find(|again| again.back == movement) {
            Some(again) => found.motions.push(again.movement),
            None => {
                self.again.retain(|again| again.movement != movement);
                self.watch.stands(movement);
            }
        }
    }

    fn late(&mut self, underway: Underway, found: &mut Found) {
        let movement = underway.movement;
        let limit = self.timeout_of(movement);
        let tried = self.tried.iter().filter(|one| **one == movement).count();
        assert!(
            tried <= usize::from(RETRIES),
            "{movement:?} tried too often"
        );
        match movement.way_back() {
            Some(back) if tried < usize::from(RETRIES) => {
                self.tried.push(movement);
                self.again.push(Again { movement, back });
                found.trouble.push(Trouble::Retried(movement, limit));
                found.motions.push(back);
            }
            Some(_) | None => found.trouble.push(Trouble::NotReached(movement, limit)),
        }
        self.underway.push(underway);
    }

    fn timeout_of(&self, movement: Move) -> Span {
        let key = movement.actuator_key();
        self.timeout
            .iter()
            .find(|(known, _)| *known == key)
            .map_or(Span::ms(1000), |(_, span)| *span)
    }

    /// Position of every actuator, in the order of [`Actuator::ALL`].
    fn positions(&self, now: RigTime, image: &Image) -> [Position; 8] {
        Actuator::ALL.map(|actuator| self.position(actuator, now, image))
    }

    /// What is known of one actuator.
    pub fn position(&self, actuator: Actuator, now: RigTime, image: &Image) -> Position {
        for underway in &self.underway {
            if let Some(to_mm) = underway.movement.motion(&self.strokes).target_mm(actuator) {
                let index = Actuator::ALL
                    .iter()
                    .position(|known| *known == actuator)
                    .unwrap_or(0);
                return underway.from[index].reaching(to_mm);
            }
        }
        let is = |point, state| image.input(point, now, SENSOR_AGE) == Some(state);
        let ends = |rest: DigitalIn, far: DigitalIn| match (is(rest, true), is(far, true)) {
            (true, false) => Some(Position::At(0.0)),
            (false, true) => Some(Position::At(self.strokes.of(actuator))),
            (true, true) | (false, false) => None,
        };
        let known = match actuator {
            Actuator::Escapement => {
                is(DigitalIn::EscapementHold, true).then_some(Position::At(0.0))
            }
            Actuator::Pusher => ends(DigitalIn::PusherRetracted, DigitalIn::PusherExtended),
            Actuator::JawLeft => ends(DigitalIn::JawLeftOpen, DigitalIn::JawLeftClosed),
            Actuator::JawRight => ends(DigitalIn::JawRightOpen, DigitalIn::JawRightClosed),
            Actuator::ProbeLift => ends(DigitalIn::ProbeDown, DigitalIn::ProbeUp),
            Actuator::SortZ => ends(DigitalIn::SortZUp, DigitalIn::SortZDown),
            Actuator::Gripper => ends(DigitalIn::GripperOpen, DigitalIn::GripperPart),
            Actuator::SortAxis => self
                .axis_at
                .filter(|_| is(DigitalIn::AxisInPosition, true))
                .map(|station| Position::At(self.strokes.axis(station))),
        };
        known.unwrap_or_else(|| self.whole_stroke(actuator))
    }

    fn whole_stroke(&self, actuator: Actuator) -> Position {
        if actuator == Actuator::SortAxis {
            return self.strokes.axis_span();
        }
        Position::Between {
            from_mm: 0.0,
            to_mm: self.strokes.of(actuator),
        }
    }

    /// The situation as the guard wants it.
    pub fn situation(&self, parts: PartPlaces, now: RigTime, image: &Image) -> Situation {
        let mut situation = Situation::unknown(self.part_size);
        for actuator in Actuator::ALL {
            situation.set(actuator, self.position(actuator, now, image));
        }
        situation.parts = parts;
        situation
    }
}
