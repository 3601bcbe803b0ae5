//! Watches the temperature of the rack while no test runs, and carries out the acts that cool it.
//!
//! A rack that may be hot becomes cool when its own thermometer and one in the air around it say so, and no thermometer on
//! a surface that gives off heat reads hot. From then on its own thermometer alone decides, because walls warm the still
//! air of an open door.

use super::BatchTurn;
use super::rack_trust::{RackTrust, Readings};
use crate::handling::trouble::Trouble;
use crate::instrument::act::{Act, JobDone, Read, Runner, RunnerState};
use crate::rig::point::{Point, Thermometer};
use crate::rig::rack::Rack;
use crate::rig::sample::Quality;
use units::{Celsius, RigTime, Span};

/// Time between two readings.
const PERIOD: Span = Span::ms(1_000);
/// Age from which a reading no longer says whether the rack is cool.
const FRESH: Span = Span::ms(5_000);
/// Time without a usable reading after which the watch reports trouble.
const SILENT: Span = Span::ms(20_000);
/// Distance of cool surroundings from the limit while the reading of the rack is in doubt, K: a slow rack may still be
/// some kelvin warmer than the air.
const SURELY_K: f64 = 10.0;
/// A rack that was cool counts as hot only when it warms by this above the limit, so that noise does not move the lock.
const HYSTERESIS_K: f64 = 1.0;

/// Whether the rack is hot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Heat {
    /// Unknown; counts as hot.
    Unknown,
    /// Homing began at this time and waits for the first reading.
    Awaited(RigTime),
    /// Cool at the last reading; see [`RackWatch::is_cool`].
    Cool,
    /// Not cool at the last usable reading.
    Hot,
}

/// Watch over the thermometer in the rack.
#[derive(Debug)]
pub(super) struct RackWatch {
    thermometer: Thermometer,
    unlock_below: Celsius,
    runner: Option<Runner>,
    /// Acts that the runner carries out; when one fails, all go back to `next`.
    acts: Vec<Act>,
    /// Acts to carry out once the present ones are done.
    next: Vec<Act>,
    /// Earliest time at which the next runner begins.
    due: Option<RigTime>,
    heat: Heat,
    /// Time of the last turn.
    stepped_at: Option<RigTime>,
    /// Time of the last usable reading, or of the first turn after a pause.
    known_at: Option<RigTime>,
}

impl RackWatch {
    /// Makes a watch without a reading.
    pub fn new(rack: &Rack) -> Self {
        Self {
            thermometer: rack.thermometer,
            unlock_below: rack.unlock_below,
            runner: None,
            acts: Vec::new(),
            next: Vec::new(),
            due: None,
            heat: Heat::Unknown,
            stepped_at: None,
            known_at: None,
        }
    }

    /// Returns a watch without acts; it still knows whether the rack is cool or hot.
    pub fn cut_off(&self, rack: &Rack) -> Self {
        let heat = match self.heat {
            Heat::Unknown | Heat::Awaited(_) => Heat::Unknown,
            known @ (Heat::Cool | Heat::Hot) => known,
        };
        let watch = Self::new(rack);
        Self { heat, ..watch }
    }

    /// Waits for a reading for a short time, in which an unknown rack does not count as hot.
    pub fn await_reading(&mut self, now: RigTime) {
        if self.heat == Heat::Unknown {
            self.heat = Heat::Awaited(now);
        }
    }

    /// Carries out these acts next.
    pub fn then(&mut self, acts: Vec<Act>) {
        self.next.extend(acts);
        self.due = None;
    }

    /// Advances the acts. Returns true when no job is under way and only the next reading is due. Repeats acts that
    /// fail until all are done.
    pub fn step(&mut self, turn: &mut BatchTurn, done: Option<&JobDone>) -> bool {
        self.note(turn);
        let mut done = done;
        loop {
            let Some(runner) = &mut self.runner else {
                if let Some(due) = self.due.filter(|due| turn.now < *due) {
                    turn.wake_within(due.since(turn.now));
                    return self.next.is_empty();
                }
                self.begin(turn);
                continue;
            };
            match runner.step(turn.now, done.take(), turn.image) {
                RunnerState::Done => self.done(turn.now),
                RunnerState::Trouble(_) => self.failed(turn.now),
                waiting @ (RunnerState::Job(_) | RunnerState::Busy | RunnerState::Wait(_)) => {
                    turn.run(&waiting);
                    return false;
                }
            }
        }
    }

    /// Begins the next acts; a reading when there are none.
    fn begin(&mut self, turn: &BatchTurn) {
        self.acts = std::mem::take(&mut self.next);
        let acts = match self.acts.is_empty() {
            true => {
                let mut all = turn.device.air_thermometers();
                all.push(self.thermometer);
                // Apart from the others: their readings count also when the module of the surfaces is silent.
                let each = [all, turn.device.hot_surfaces()].into_iter();
                let each = each.filter(|it| !it.is_empty());
                let read = |all: Vec<Thermometer>| {
                    Act::Read(Read::points(all.into_iter().map(Point::Temperature)))
                };
                each.map(read).collect()
            }
            false => self.acts.clone(),
        };
        self.runner = Some(Runner::new(acts, turn.now));
    }

    fn done(&mut self, now: RigTime) {
        let was_reading = self.acts.is_empty();
        self.due = (was_reading && self.next.is_empty()).then(|| now + PERIOD);
        self.acts.clear();
        self.runner = None;
    }

    fn failed(&mut self, now: RigTime) {
        let later = std::mem::take(&mut self.next);
        self.next = std::mem::take(&mut self.acts);
        self.next.extend(later);
        self.due = Some(now + PERIOD);
        self.runner = None;
    }

    /// Stores the time of the last usable reading, and ends a wait for the first one that took too long.
    fn note(&mut self, turn: &BatchTurn) {
        let now = turn.now;
        if self.stepped_at.is_none_or(|at| now.since(at) > FRESH) {
            self.known_at = Some(now);
        }
        self.stepped_at = Some(now);
        if let Some((_, at)) = reading(turn, self.thermometer) {
            self.known_at = self.known_at.max(Some(at));
        }
        if let Heat::Awaited(since) = self.heat
            && now.since(since) > FRESH
        {
            self.heat = Heat::Unknown;
        }
    }

    /// Returns true when a thermometer in the air has a fresh reading, or the rig has none there, and neither there nor on
    /// a surface that gives off heat a fresh reading is at the limit less a margin, or above.
    fn are_surroundings_cool(&self, margin_k: f64, turn: &BatchTurn) -> bool {
        let of_air = turn.device.air_thermometers();
        let is_bare = of_air.is_empty();
        let (air, surfaces) = (fresh(turn, of_air), fresh(turn, turn.device.hot_surfaces()));
        let mut all = air.iter().chain(&surfaces);
        (is_bare || !air.is_empty()) && all.all(|it| *it < self.unlock_below.0 - margin_k)
    }

    /// Compares the thermometer in the rack with those in the air, also during a test; reports a doubt that lasts. A rig
    /// without a thermometer in the air compares nothing.
    pub fn compare(&self, trust: &mut RackTrust, turn: &mut BatchTurn) {
        let rack = fresh(turn, vec![self.thermometer]);
        let air = fresh(turn, turn.device.air_thermometers());
        let lowest = air.iter().copied().reduce(f64::min);
        let ends = lowest.zip(air.iter().copied().reduce(f64::max));
        let (Some(rack_c), Some((low_c, high_c))) = (rack.first(), ends) else {
            return;
        };
        let readings = Readings {
            rack_c: *rack_c,
            air_c: [low_c, high_c],
            are_surroundings_cool: self.are_surroundings_cool(SURELY_K, turn),
        };
        if trust.step(turn.now, &readings) {
            turn.trouble.push(Trouble::RackStuck);
        }
    }

    /// Returns true when the last reading is fresh, below the limit and not in doubt, and the surroundings are cool. While
    /// the rack is cool, the limit is higher by [`HYSTERESIS_K`], and the surroundings do not matter.
    pub fn is_cool(&mut self, trust: &RackTrust, turn: &BatchTurn) -> bool {
        let Some((Celsius(value), at)) = reading(turn, self.thermometer) else {
            return false;
        };
        let is_fresh = turn.now.since(at) <= FRESH;
        let margin_k = match self.heat {
            Heat::Cool => HYSTERESIS_K,
            Heat::Unknown | Heat::Awaited(_) | Heat::Hot => 0.0,
        };
        let was_cool = self.heat == Heat::Cool;
        let is_below = value < self.unlock_below.0 + margin_k
            && !trust.is_in_doubt()
            && (was_cool || self.are_surroundings_cool(0.0, turn));
        if !is_below {
            self.heat = Heat::Hot;
        } else if is_fresh {
            self.heat = Heat::Cool;
        }
        is_below && is_fresh
    }

    /// Returns true unless the rack is known to be cool, or homing still waits for its first reading.
    pub fn may_be_hot(&self) -> bool {
        match self.heat {
            Heat::Unknown | Heat::Hot => true,
            Heat::Awaited(_) | Heat::Cool => false,
        }
    }

    /// Reports trouble when the rack has had no usable reading for too long.
    pub fn check(&self, turn: &mut BatchTurn) {
        if self.known_at.is_some_and(|at| turn.now.since(at) > SILENT) {
            turn.trouble.push(Trouble::RackUnread);
        }
    }
}

/// Returns the fresh readings of these thermometers, C.
fn fresh(turn: &BatchTurn, all: Vec<Thermometer>) -> Vec<f64> {
    let readings = all.into_iter().filter_map(|it| reading(turn, it));
    let fresh = readings.filter(|(_, at)| turn.now.since(*at) <= FRESH);
    fresh.map(|(celsius, _)| celsius.0).collect()
}

/// Returns the last usable reading of a thermometer with its time.
fn reading(turn: &BatchTurn, thermometer: Thermometer) -> Option<(Celsius, RigTime)> {
    let sample = turn.image.temperature(thermometer)?;
    let usable = sample.quality == Quality::Good && sample.value.is_finite();
    usable.then_some((Celsius(sample.value), sample.origin.at))
}
