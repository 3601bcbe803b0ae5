//! The state of the mechanism: end sensors, motions in progress, and the situation for the guard.
//!
//! An actuator is at an end only while its sensors show that end and it does not move; otherwise it may be anywhere on
//! its way, or on its whole stroke. It counts as having left the end where it began once the sensor there has been off
//! for [`DEBOUNCE`]. A sensor value older than [`SENSOR_AGE`] counts as unknown.
//!
//! The mechanism detects a stroke that arrives late, an actuator that leaves its end, both end sensors on at once, and
//! the drive's alarm. It repeats a late stroke away from rest once: back to rest, then out again. A signal shorter than
//! [`DEBOUNCE`] counts as a bounce.

use super::moves::{Move, Strokes};
use super::stroke_times::StrokeTimes;
use super::trouble::Trouble;
use super::watch::Watch;
use super::wear::Uses;
use crate::guard::{Actuator, End, PartPlaces, PartSize, Position, Situation};
use crate::rig::axis::AxisStation;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use crate::rig::stroke::StrokeLimits;
use units::{RigTime, Span};

/// Greatest age of a valid sensor value.
pub const SENSOR_AGE: Span = Span::ms(400);
/// Time from the rising edge of `axis_drive` until the drive withdraws its signal "in position".
const AXIS_REACTS: Span = Span::ms(15);
/// Time that a sensor must show a fault: longer than two scans and the bounce of a reed contact.
pub const DEBOUNCE: Span = Span::ms(60);
/// Number of repetitions of a failed stroke away from rest, per part.
const RETRIES: u8 = 1;

/// A driven motion that has not arrived yet.
#[derive(Debug, Clone, Copy)]
struct Underway {
    movement: Move,
    since: RigTime,
    from: [Position; 8],
    /// Instant since which every reading of the sensors at the end where the motion began shows them off.
    off_since: Option<RigTime>,
}

impl Underway {
    /// Reads the sensors of the end where the motion began; without any, the actuator never counts as having left it.
    fn look_back(&mut self, now: RigTime, image: &Image) {
        let mut sensors = self.movement.other_end().iter();
        let is_off = |point: &DigitalIn| {
            let is_new = image.input_at(*point).is_some_and(|at| at >= self.since);
            is_new && image.input(*point, now, SENSOR_AGE) == Some(false)
        };
        let all_off = sensors.len() > 0 && sensors.all(is_off);
        self.off_since = all_off.then(|| self.off_since.unwrap_or(now));
    }

    /// Returns true when the actuator has left the end where the motion began.
    fn has_left(&self, now: RigTime) -> bool {
        self.off_since
            .is_some_and(|since| now.since(since) >= DEBOUNCE)
    }

    /// Returns true when every sensor of the motion's end was read at `since` or later.
    fn was_read_since(&self, since: RigTime, image: &Image) -> bool {
        let mut arrival = self.movement.arrival().iter();
        arrival.all(|(point, _)| image.input_at(*point).is_some_and(|at| at >= since))
    }
}

/// A failed stroke away from rest that is being repeated: back to rest, then out again.
#[derive(Debug, Clone, Copy)]
struct Repetition {
    movement: Move,
    back: Move,
}

/// Results of one [`Mechanism::update`].
#[derive(Debug, Default)]
pub struct MechanismUpdate {
    /// Troubles found.
    pub trouble: Vec<Trouble>,
    /// Motions of a repeated stroke.
    pub motions: Vec<Move>,
}

/// How a motion ordered by hand ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandEnd {
    /// Every sensor shows the end of the motion.
    Arrived,
    /// The fingers are closed and hold no part.
    ClosedOnNothing,
    /// The motion ended before its sensors showed the end.
    Cut,
}

/// End sensors and motions in progress.
#[derive(Debug)]
pub struct Mechanism {
    strokes: Strokes,
    limits: StrokeLimits,
    underway: Vec<Underway>,
    /// Motions requested and not driven yet.
    waiting: Vec<Move>,
    again: Vec<Repetition>,
    /// Strokes away from rest that have already been repeated for the current part.
    tried: Vec<Move>,
    /// Motion that a person ordered; kept until [`Self::take_hand_end`] returns how it ended.
    by_hand: Option<Move>,
    watch: Watch,
    times: StrokeTimes,
    strokes_made: Vec<(&'static str, u64)>,
    uses: Uses,
    axis_at: Option<AxisStation>,
    part_size: PartSize,
}

impl Mechanism {
    /// Makes a mechanism with unknown positions and no motion.
    pub fn new(strokes: Strokes, limits: StrokeLimits, part_size: PartSize) -> Self {
        Self {
            strokes,
            limits,
            underway: Vec::new(),
            waiting: Vec::new(),
            again: Vec::new(),
            tried: Vec::new(),
            by_hand: None,
            watch: Watch::default(),
            times: StrokeTimes::default(),
            strokes_made: Vec::new(),
            uses: Uses::default(),
            axis_at: None,
            part_size,
        }
    }

    /// Returns the lengths of the strokes.
    pub fn strokes(&self) -> &Strokes {
        &self.strokes
    }

    /// Returns true when every sensor at the end of `movement` shows that end and the motion is over.
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

    /// Returns true when a motion of the same actuator is under way, waits to be driven, or is repeated.
    pub fn is_moving(&self, movement: Move) -> bool {
        let same = |other: &Move| other.key() == movement.key();
        self.underway
            .iter()
            .any(|underway| same(&underway.movement))
            || self.waiting.iter().any(same)
            || self.again.iter().any(|again| same(&again.movement))
    }

    /// Returns true when the pusher, on its way back, has left the nest so far that the guard lets the probes rise.
    pub fn pusher_left_the_probes(&self, now: RigTime) -> bool {
        let mut underway = self.underway.iter();
        let left = |it: &Underway| it.movement == Move::PusherRetract && it.has_left(now);
        self.strokes.probes_beside_pusher && underway.any(left)
    }

    /// Yields the motions in progress.
    pub fn moving(&self) -> impl Iterator<Item = Move> + '_ {
        self.underway.iter().map(|underway| underway.movement)
    }

    /// Yields the sensors at the ends of the motions that may arrive now.
    pub fn awaited(&self, now: RigTime) -> impl Iterator<Item = DigitalIn> + '_ {
        let may_arrive =
            move |it: &&Underway| self.times.may_arrive(it.movement, now.since(it.since));
        let arriving = self.underway.iter().filter(may_arrive);
        arriving.flat_map(|it| it.movement.arrival().iter().map(|(point, _)| *point))
    }

    /// Returns true while it is undecided whether an actuator has left its end or its sensor bounces; [`DEBOUNCE`]
    /// decides.
    pub fn is_undecided(&self) -> bool {
        self.watch.is_undecided()
    }

    /// Returns true when the motion needs an input that was not read recently; the line of its module then reports the
    /// cause.
    pub fn needs_unread_input(&self, movement: Move, now: RigTime, image: &Image) -> bool {
        let end = match movement
            .motion(&self.strokes)
            .strokes()
            .all(|it| it.to_mm == 0.0)
        {
            true => End::Rest,
            false => End::Far,
        };
        let mut interlocks = image.wiring().interlocks.iter();
        interlocks.any(|needs| {
            let is_own = needs.actuator == movement.key() && needs.end == end;
            is_own && image.input(needs.input, now, SENSOR_AGE).is_none()
        })
    }

    /// Returns true for a deviation that no alarm explains yet: a sensor differs, or a motion has used half of its
    /// time-out. The cycle then checks whether a module has restarted.
    pub fn needs_restart_check(&self, now: RigTime) -> bool {
        let slow = |underway: &Underway| {
            let limit = self.timeout_of(underway.movement);
            now.since(underway.since).0 > limit.0 / 2
        };
        self.is_undecided() || self.underway.iter().any(slow)
    }

    /// Marks motions that wait for the order `step`, or until every end sensor is debounced; their actuators do not
    /// count as arrived.
    pub fn keep_waiting(&mut self, movements: &[Move]) {
        self.waiting.clear();
        self.waiting.extend_from_slice(movements);
    }

    /// Forgets motions and positions, because all outputs are made safe.
    pub fn forget(&mut self) {
        self.underway.clear();
        self.waiting.clear();
        self.again.clear();
        self.tried.clear();
        self.watch.forget();
        self.axis_at = None;
    }

    /// Records the reset of the axis drive and begins to watch the drive.
    pub fn drive_reset(&mut self, at: RigTime) {
        self.watch.drive_reset(at);
    }

    /// Allows one repetition of each stroke again, because a new part begins.
    pub fn new_part(&mut self) {
        self.tried.clear();
    }

    /// Returns the strokes of each actuator, the uses of wearing parts and the sensor bounces, counted since the
    /// program started.
    pub fn wear(&self) -> Vec<(&'static str, u64)> {
        let strokes = self.strokes_made.iter().copied();
        strokes
            .chain(self.uses.each())
            .chain([("sensor_bounces", self.watch.bounces())])
            .collect()
    }

    /// Returns the use counts of the wearing parts since the program started.
    pub fn uses(&self) -> Uses {
        self.uses
    }

    /// Records that a motion was driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        let from = self.positions(now, image);
        let key = movement.key();
        self.underway
            .retain(|underway| underway.movement.key() != key);
        self.watch.remove(key);
        self.uses.probe_touches += u64::from(movement == Move::ProbesUp);
        self.uses.jaw_closings += u64::from(movement == Move::ClampClose);
        match self
            .strokes_made
            .iter_mut()
            .find(|(known, _)| *known == key.name())
        {
            Some((_, strokes)) => *strokes += 1,
            None => self.strokes_made.push((key.name(), 1)),
        }
        self.underway.push(Underway {
            movement,
            since: now,
            from,
            off_since: None,
        });
        let several = self.underway.len() >= Actuator::ALL.len();
        assert!(!several, "two motions of one actuator");
        if let Some(station) = movement.station() {
            self.axis_at = Some(station);
        }
    }

    /// Records that a person ordered this motion, which has just begun.
    pub fn driven_by_hand(&mut self, movement: Move) {
        assert!(self.is_moving(movement), "a motion by hand was not driven");
        self.by_hand = Some(movement);
    }

    /// Returns how the motion by hand ended, once; `None` while it moves, or without such a motion.
    pub fn take_hand_end(&mut self, now: RigTime, image: &Image) -> Option<HandEnd> {
        let movement = self.by_hand.filter(|it| !self.is_moving(*it))?;
        let end = if self.has_arrived(movement, now, image) {
            HandEnd::Arrived
        } else if self.closed_on_nothing(movement, now, image) {
            HandEnd::ClosedOnNothing
        } else {
            HandEnd::Cut
        };
        self.by_hand = None;
        Some(end)
    }

    /// Returns true when the fingers have closed on a person's order and hold no part, which by hand is no trouble.
    fn closed_on_nothing(&self, movement: Move, now: RigTime, image: &Image) -> bool {
        let shows = |point| image.input(point, now, SENSOR_AGE);
        movement == Move::GripperClose
            && self.by_hand == Some(movement)
            && shows(DigitalIn::GripperOpen) == Some(false)
            && shows(DigitalIn::GripperPart) == Some(false)
    }

    /// Records arrivals; repeats a late stroke or reports it.
    pub fn update(&mut self, now: RigTime, image: &Image) -> MechanismUpdate {
        let mut found = MechanismUpdate::default();
        for mut underway in std::mem::take(&mut self.underway) {
            underway.look_back(now, image);
            if self.is_there(&underway, now, image) {
                let took = now.since(underway.since);
                self.times.note(underway.movement, took);
                self.arrived(underway.movement, &mut found);
            } else if self.is_late(&underway, image) {
                if !self.closed_on_nothing(underway.movement, now, image) {
                    self.late(underway, &mut found);
                }
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
            && underway.was_read_since(underway.since, image)
            && self.sensed(underway.movement, now, image)
    }

    /// Returns true when a sensor value requested after the time-out does not show the end. An earlier value proves
    /// nothing: on a slow line it may be older than the stroke.
    fn is_late(&self, underway: &Underway, image: &Image) -> bool {
        let limit = self.timeout_of(underway.movement);
        underway.was_read_since(underway.since + limit, image)
    }

    /// Sends an actuator out again that has returned to rest for a repetition; watches any other actuator at its new
    /// end.
    fn arrived(&mut self, movement: Move, found: &mut MechanismUpdate) {
        match self.again.iter().find(|again| again.back == movement) {
            Some(again) => found.motions.push(again.movement),
            None => {
                self.again.retain(|again| again.movement != movement);
                self.watch.add(movement);
            }
        }
    }

    fn late(&mut self, underway: Underway, found: &mut MechanismUpdate) {
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
                self.again.push(Repetition { movement, back });
                found.trouble.push(Trouble::Retried(movement, limit));
                found.motions.push(back);
            }
            Some(_) | None => found.trouble.push(Trouble::NotReached(movement, limit)),
        }
        self.underway.push(underway);
    }

    fn timeout_of(&self, movement: Move) -> Span {
        self.limits[movement.key().index()]
    }

    /// Returns the position of every actuator, in the order of [`Actuator::ALL`].
    fn positions(&self, now: RigTime, image: &Image) -> [Position; 8] {
        Actuator::ALL.map(|actuator| self.position(actuator, now, image))
    }

    /// Returns the known position of one actuator.
    pub fn position(&self, actuator: Actuator, now: RigTime, image: &Image) -> Position {
        for underway in &self.underway {
            if let Some(to_mm) = underway.movement.motion(&self.strokes).target_mm(actuator) {
                let way = underway.from[actuator.index()].reaching(to_mm);
                return match underway.has_left(now) {
                    true => self.without_its_beginning(way, actuator, to_mm),
                    false => way,
                };
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

    /// Returns the way of an actuator to `to_mm` without the piece at its beginning in which the end sensor is on.
    fn without_its_beginning(&self, way: Position, actuator: Actuator, to_mm: f64) -> Position {
        let off_mm = self.strokes.sensor_off_mm[actuator.index()];
        let (from_mm, last_mm) = match to_mm == 0.0 {
            true => (0.0, self.strokes.of(actuator) - off_mm),
            false => (off_mm, to_mm),
        };
        let (low, high) = way.span_mm();
        Position::Between {
            from_mm: low.max(from_mm),
            to_mm: high.min(last_mm),
        }
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

    /// Returns the situation for the guard.
    pub fn situation(&self, parts: PartPlaces, now: RigTime, image: &Image) -> Situation {
        let mut situation = Situation::unknown(self.part_size);
        for actuator in Actuator::ALL {
            situation.set(actuator, self.position(actuator, now, image));
        }
        situation.parts = parts;
        for (number, needs) in image.wiring().interlocks.iter().enumerate() {
            if image.input(needs.input, now, SENSOR_AGE) == Some(true) {
                situation.grant(number);
            }
        }
        situation
    }
}
