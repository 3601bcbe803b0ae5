//! What is known of the mechanism: end sensors, motions under way, and the situation for the guard.
//!
//! An actuator is at an end only while its sensors say so and no motion of it is under way; otherwise
//! it may be anywhere on the way, or on its whole stroke. Sensors older than [`SENSOR_AGE`] say nothing.

use super::moves::{Move, Strokes};
use super::trouble::Alarm;
use crate::guard::{Actuator, PartPlaces, PartSize, Position, Situation};
use crate::rig::axis::AxisStation;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use crate::units::{RigTime, Span};

/// Oldest sensor reading that is believed.
pub const SENSOR_AGE: Span = Span::ms(400);
/// After the start edge the drive needs this long to take "in position" away.
const AXIS_REACTS: Span = Span::ms(15);

/// A motion that was driven and has not arrived.
#[derive(Debug, Clone, Copy)]
struct Underway {
    movement: Move,
    since: RigTime,
    from: [Position; 8],
}

/// Sensors and motions.
#[derive(Debug)]
pub struct Mechanism {
    strokes: Strokes,
    timeout: Vec<(&'static str, Span)>,
    underway: Vec<Underway>,
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
        let at_end = self.sensed(movement, now, image);
        match movement {
            Move::AxisTo(station) => at_end && self.axis_at == Some(station),
            _other => at_end,
        }
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
        self.underway
            .iter()
            .any(|underway| underway.movement.actuator_key() == key)
    }

    /// A motion was driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        let from = self.positions(now, image);
        let key = movement.actuator_key();
        self.underway
            .retain(|underway| underway.movement.actuator_key() != key);
        self.underway.push(Underway {
            movement,
            since: now,
            from,
        });
        if let Move::AxisTo(station) = movement {
            self.axis_at = Some(station);
        }
    }

    /// Takes note of arrivals; an actuator that takes too long is an alarm.
    pub fn update(&mut self, now: RigTime, image: &Image) -> Option<Alarm> {
        let mut late = None;
        let mut kept = Vec::with_capacity(self.underway.len());
        for underway in std::mem::take(&mut self.underway) {
            let elapsed = now.since(underway.since);
            let is_axis = matches!(underway.movement, Move::AxisTo(_));
            let believed = !is_axis || elapsed >= AXIS_REACTS;
            let fresh = underway.movement.arrival().iter().all(|(point, _)| {
                image
                    .input_at(*point)
                    .is_some_and(|at| at >= underway.since)
            });
            if believed && fresh && self.sensed(underway.movement, now, image) {
                continue;
            }
            if elapsed > self.timeout_of(underway.movement) {
                late = Some(Alarm::not_reached(underway.movement, elapsed));
            }
            kept.push(underway);
        }
        self.underway = kept;
        late
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
