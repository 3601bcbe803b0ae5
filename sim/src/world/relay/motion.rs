//! The armature on its way through a test: held on a stop while nothing moves, integrated while it does.
//!
//! Two levels, and the motion chooses:
//!
//! - *held*: the armature is pressed on backstop or seat. Travel and leaf follow the flux in
//!   equilibrium, only the flux moves; a flux that stands still costs nothing.
//! - *moving*: all five states of [`super::lumped`], from the instant at which the push on the stop
//!   falls to [`LEAST_PUSH_N`] until the bounce has died out.
//!
//! A model without the leaf would be cheaper than the five states and 4 % off in time; between the
//! stops the five states cost about 4 us per rig millisecond, so there is nothing to gain by it.

use serde::Serialize;

use super::lumped::{Drive, Event, Kind, LAMBDA, Model, Solver, State, V, W, X, Y};

/// Tolerance of a step: instants to a nanosecond, where the counters resolve 20 us.
const RTOL: f64 = 1e-6;
/// A push below this lets the armature move, N: half of that at rest, so that it is still slow then.
const LEAST_PUSH_N: f64 = 0.02;
/// Above this much speed it is not at rest, m/s: it would hop by less than 0.2 um.
const CALM_M_PER_S: f64 = 4e-3;
/// And further than this from its equilibrium neither, m.
const CALM_M: f64 = 2e-7;
/// So often a moving armature is looked at, s.
const LOOK_S: f64 = 5e-4;
/// Longest step of the flux while held, s.
const FLUX_STEP_S: f64 = 2.5e-4;
/// And no more than this share of its time constant: behind a blocked clamp, where eddy currents alone
/// carry it, that may be 0.05 ms, and a step of three of them runs away.
const FLUX_STEP_SHARE: f64 = 0.25;
/// A flux that moves by less stands still, V: a microvolt of the source.
const STILL_V: f64 = 1e-6;

/// Seconds of rig time on each level.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Levels {
    /// Pressed on a stop.
    pub held_s: f64,
    /// Five states integrated.
    pub moving_s: f64,
}

/// A relay somewhere between its stops.
#[derive(Debug, Clone)]
pub struct Motion {
    model: Model,
    drive: Drive,
    solver: Solver,
    held: bool,
    stuck: bool,
    levels: Levels,
}

impl Motion {
    /// Starts at `t_s` without current, on the backstop, or on the seat where a weld holds it; a
    /// `stuck` armature never moves.
    pub fn new(model: Model, t_s: f64, drive: Drive, stuck: bool, seated: bool) -> Self {
        let mut state = model.at_rest(0.0);
        if seated {
            state[X] = model.places.seat;
            model.pressed(&mut state);
        }
        let solver = Solver::new(&model, &drive, t_s, state, RTOL);
        Self {
            model,
            drive,
            solver,
            held: true,
            stuck,
            levels: Levels::default(),
        }
    }

    /// Rig time spent on each level.
    pub fn levels(&self) -> Levels {
        self.levels
    }

    /// Coil resistance at 23 C of the relay that moves, ohm; of a broken coil, before it broke.
    pub fn reference_ohm(&self) -> f64 {
        self.model.parameters().R23
    }

    /// Whether a contact or stop is touched now.
    pub fn touches(&self, kind: Kind) -> bool {
        self.model.places.overlap(kind, &self.solver.state) > 0.0
    }

    /// At one of the stops: pressed on it, or hopping within a fiftieth of the travel.
    pub fn at_a_stop(&self) -> bool {
        let (x, travel) = (self.solver.state[X], self.model.places.seat);
        x < 0.02 * travel || x > 0.98 * travel
    }

    /// Coil current into `volts` of a source, or into the clamp, A.
    pub fn current(&self, volts: f64) -> f64 {
        let rate = self.flux_rate(&self.solver.state);
        match self.drive {
            Drive::Source { .. } => (volts - rate) / self.model.ohm(),
            Drive::Clamp { .. } => self.model.current_at(&self.solver.state, rate).max(0.0),
        }
    }

    /// Another drive, or another temperature of the copper, from now on.
    pub fn set(&mut self, drive: Drive, ohm: f64) {
        self.drive = drive;
        self.model.set_ohm(ohm);
        self.solver.drive_changed(&self.model, &drive);
    }

    /// Goes on to `until_s` or to the first event before it.
    pub fn advance(&mut self, until_s: f64) -> Option<Event> {
        loop {
            let from_s = self.solver.t_s;
            if self.held {
                self.hold(until_s);
                self.levels.held_s += self.solver.t_s - from_s;
            }
            if self.solver.t_s >= until_s {
                return None;
            }
            let from_s = self.solver.t_s;
            let goal = until_s.min(from_s + LOOK_S);
            let event = self.solver.advance(&self.model, &self.drive, goal);
            self.levels.moving_s += self.solver.t_s - from_s;
            let event = event.expect("a specimen inside its ranges does not run away");
            if event.is_some() {
                return event;
            }
            self.held = self.is_calm();
        }
    }

    /// Armature and leaf are where the flux would hold them.
    fn is_calm(&self) -> bool {
        let now = &self.solver.state;
        if now[V].abs() > CALM_M_PER_S || now[W].abs() > CALM_M_PER_S {
            return false;
        }
        let mut still = *now;
        let push = self.model.pressed(&mut still);
        push > LEAST_PUSH_N && [X, Y].iter().all(|&i| (now[i] - still[i]).abs() < CALM_M)
    }

    fn flux_rate(&self, s: &State) -> f64 {
        self.model
            .resting_flux_rate(self.solver.t_s, s, &self.drive)
    }

    /// Only the flux moves, to `until_s` or until the armature is about to let go: a step at whose end
    /// the push would be gone is not taken.
    fn hold(&mut self, until_s: f64) {
        self.press(self.solver.state);
        while self.solver.t_s < until_s {
            let now = self.solver.state;
            let rate = self.flux_rate(&now);
            if rate.abs() < STILL_V {
                self.solver.t_s = until_s;
                return;
            }
            let steady = FLUX_STEP_SHARE * self.model.flux_time_s(&now, rate, &self.drive);
            let h = FLUX_STEP_S.min(steady).min(until_s - self.solver.t_s);
            let mut next = now;
            next[LAMBDA] += h * self.mean_rate(&now, rate, h);
            if self.press(next) < LEAST_PUSH_N && !self.stuck {
                self.held = false;
                self.solver.state = now;
                self.solver.modes = self.model.modes(&now, &self.drive);
                return;
            }
            let t_s = self.solver.t_s + h;
            self.solver.t_s = if t_s < until_s { t_s } else { until_s };
        }
    }

    /// Armature and leaf take their place under a flux; the push on the stop, N.
    fn press(&mut self, mut s: State) -> f64 {
        let push = self.model.pressed(&mut s);
        s[V] = 0.0;
        s[W] = 0.0;
        self.solver.state = s;
        push
    }

    /// Mean rate of the flux over a step, by the classical method of order 4.
    fn mean_rate(&self, s: &State, first: f64, h: f64) -> f64 {
        let at = |rate: f64, part: f64| {
            let mut s = *s;
            s[LAMBDA] += part * h * rate;
            self.model.pressed(&mut s);
            self.flux_rate(&s)
        };
        let second = at(first, 0.5);
        let third = at(second, 0.5);
        let fourth = at(third, 1.0);
        (first + 2.0 * (second + third) + fourth) / 6.0
    }
}
