//! Motion of the armature: held in equilibrium on a stop, or integrated while it moves.
//!
//! The motion selects one of three levels of detail:
//!
//! - *held*: the armature presses on backstop or seat. The motion integrates only the flux; travel and leaf follow it
//!   in equilibrium. A constant flux costs nothing.
//! - *condensed*: the armature moves and its leaf presses on a contact, for example on a slow ramp below the threshold
//!   (`lumped/condensed.rs`).
//! - *moving*: the motion integrates all five states of [`super::lumped`], until the bounce has died out.
//!
//! A model without the leaf would be cheaper and 4 % off in time. Against all five states throughout, the levels move the
//! first change of a contact after a step by less than 1 us (`no_level_of_detail_moves_a_first_change`).

use serde::Serialize;

use super::lumped::{Drive, Element, Event, LAMBDA, Model, SolveError, Solver, State, V, W, X, Y};

/// Relative tolerance of a step: it locates instants to a nanosecond, while the counters resolve 20 us.
const RTOL: f64 = 1e-6;
/// Stops of the armature.
const STOPS: [Element; 2] = [Element::Backstop, Element::Seat];
/// Force on a stop up to which the model integrates the motion of the armature, N; above it the armature rests. It is
/// an eighth of the force with which a relay without current rests on its stop, so that the integration begins before
/// the armature leaves.
const LEAST_PUSH_N: f64 = 0.005;
/// Height of the hops on a stop up to which the armature counts as at rest, m. Hops of 0.2 um would move an operation that
/// follows within 40 ms by more than a microsecond. The energy of motion and of the compressed stop decides.
const HOP_M: f64 = 5e-8;
/// Speed above which the tip of the leaf is not at rest, m/s.
const CALM_M_PER_S: f64 = 4e-3;
/// Distance of the tip from equilibrium above which it is not at rest, m.
const CALM_M: f64 = 2e-7;
/// Interval at which the motion checks, between touches of a stop, whether armature and leaf have come to rest, s.
const LOOK_S: f64 = 5e-4;
/// Longest step of the flux while held, s.
const FLUX_STEP_S: f64 = 1e-3;
/// Longest step of the flux as a fraction of its time constant, for a relative error below 1e-4. Behind a blocking
/// suppression eddy currents alone carry the flux with a time constant down to 0.05 ms.
const FLUX_STEP_SHARE: f64 = 0.125;
/// Limit of the trials that shorten a step to the instant at which the suppression blocks; four are usual.
const BLOCKING_TRIALS: u32 = 16;
/// Time over which a difference quotient gives the speed of an armature that rests, s.
const QUOTIENT_S: f64 = 1e-6;
/// Rate of change of the flux below which it counts as constant, V: a microvolt of the source.
const STILL_V: f64 = 1e-6;

/// Rig time spent at each level of detail of the motion, s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Levels {
    /// Time with the armature pressed on a stop, s.
    pub held_s: f64,
    /// Time with the motion of the armature integrated, s.
    pub moving_s: f64,
}

/// Motion of a relay, at one of the two levels of detail.
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
    /// Creates the motion at `t_s` without current, on the backstop, or with `seated` on the seat, where a weld holds
    /// the armature; a `stuck` armature never moves.
    pub fn new(model: Model, t_s: f64, drive: Drive, stuck: bool, seated: bool) -> Self {
        let mut state = model.at_rest(0.0);
        if seated {
            state[X] = model.stops.seat;
            model.pressed(&mut state);
        }
        Self {
            stuck,
            ..Self::from_equilibrium(model, t_s, drive, state)
        }
    }

    /// Creates the motion of an armature that presses on a stop, in equilibrium with the flux of `state`.
    pub fn from_equilibrium(model: Model, t_s: f64, drive: Drive, state: State) -> Self {
        let solver = Solver::new(&model, &drive, t_s, state, RTOL);
        Self {
            model,
            drive,
            solver,
            held: true,
            stuck: false,
            levels: Levels::default(),
        }
    }

    /// Returns the rig time spent at each level of detail.
    pub fn levels(&self) -> Levels {
        self.levels
    }

    /// Returns the coil resistance at 23 C, ohm; of an open coil, the value before it broke.
    pub fn reference_ohm(&self) -> f64 {
        self.model.parameters().R23
    }

    /// Checks whether a contact or stop is touched now.
    pub fn touches(&self, element: Element) -> bool {
        self.model.stops.overlap(element, &self.solver.state) > 0.0
    }

    /// Checks whether the armature is at a stop: pressed on it, or within a fiftieth of the travel.
    pub fn at_a_stop(&self) -> bool {
        let (x, travel) = (self.solver.state[X], self.model.stops.seat);
        x < 0.02 * travel || x > 0.98 * travel
    }

    /// Returns the coil current, A: from a source of `volts`, or into the suppression.
    pub fn current(&self, volts: f64) -> f64 {
        let rate = self.flux_rate(&self.solver.state);
        match self.drive {
            Drive::Source { .. } => (volts - rate) / self.model.ohm(),
            Drive::Suppression { .. } => self.model.current_at(&self.solver.state, rate).max(0.0),
        }
    }

    /// Changes the drive and the coil resistance from now on.
    pub fn set(&mut self, drive: Drive, ohm: f64) {
        self.drive = drive;
        self.model.set_ohm(ohm);
        self.solver.drive_changed(&self.model, &drive);
    }

    /// Advances to `until_s`, or to the first event before it.
    pub fn advance(&mut self, until_s: f64) -> Option<Event> {
        let event = self.try_advance(until_s);
        event.expect("the state of a specimen within its ranges does not diverge")
    }

    /// Advances as [`Self::advance`] does.
    ///
    /// # Errors
    /// Fails when the state diverges, as it may for parameters that no relay has.
    pub fn try_advance(&mut self, until_s: f64) -> Result<Option<Event>, SolveError> {
        loop {
            let from_s = self.solver.t_s;
            if self.held {
                self.hold(until_s);
                self.levels.held_s += self.solver.t_s - from_s;
            }
            if self.solver.t_s >= until_s {
                return Ok(None);
            }
            let from_s = self.solver.t_s;
            let goal = until_s.min(from_s + LOOK_S);
            let event = self.solver.advance(&self.model, &self.drive, goal)?;
            self.levels.moving_s += self.solver.t_s - from_s;
            if event.is_none_or(|it| it.on && STOPS.contains(&it.element)) {
                self.held = self.is_calm();
            }
            if !self.held {
                self.solver.condense_leaf(&self.model);
            }
            if event.is_some() {
                return Ok(event);
            }
        }
    }

    /// Checks whether armature and leaf are in equilibrium with the flux, but for hops of the armature below [`HOP_M`].
    fn is_calm(&self) -> bool {
        let now = &self.solver.state;
        let engaged = |it: &Element| self.solver.modes.is_engaged(*it);
        let Some(stop) = STOPS.into_iter().find(engaged) else {
            return false;
        };
        if now[W].abs() > CALM_M_PER_S {
            return false;
        }
        let mut still = *now;
        let push = self.model.pressed(&mut still);
        let [depth, rest] = [now, &still].map(|it| self.model.stops.overlap(stop, it));
        let elastic = self.model.stop.energy(depth) - self.model.stop.energy(rest);
        let kinetic = 0.5 * self.model.parameters().m_a * now[V] * now[V];
        push > LEAST_PUSH_N
            && kinetic + elastic - push * (depth - rest) < push * HOP_M
            && (now[Y] - still[Y]).abs() < CALM_M
    }

    fn flux_rate(&self, s: &State) -> f64 {
        self.model
            .resting_flux_rate(self.solver.t_s, s, &self.drive)
    }

    /// Integrates the flux alone, to `until_s` or until the armature is about to leave its stop; refuses a step that
    /// would end with too small a force on the stop.
    fn hold(&mut self, until_s: f64) {
        self.press(self.solver.state);
        while self.solver.t_s < until_s {
            let now = self.solver.state;
            let blocked = self.model.gap(Element::CoilBlocked, &now, &self.drive) > -STILL_V;
            let rate = self.branch_rate(&now, blocked);
            if rate.abs() < STILL_V {
                self.solver.t_s = until_s;
                return;
            }
            let steady = FLUX_STEP_SHARE * self.model.flux_time_s(&now, blocked);
            let h = FLUX_STEP_S.min(steady).min(until_s - self.solver.t_s);
            let (h, next) = self.flux_step(&now, blocked, h);
            if self.press(next) < LEAST_PUSH_N && !self.stuck {
                self.held = false;
                let leaving = self.with_speeds(&now, rate);
                self.solver.rest(&self.model, &self.drive, leaving);
                self.solver.condense_leaf(&self.model);
                return;
            }
            let t_s = self.solver.t_s + h;
            self.solver.t_s = if t_s < until_s { t_s } else { until_s };
        }
    }

    fn branch_rate(&self, s: &State, blocked: bool) -> f64 {
        self.model
            .branch_flux_rate(self.solver.t_s, s, &self.drive, blocked)
    }

    /// Returns the state after a step of the flux, and the length of the step: `h`, or less if the suppression blocks
    /// before. The suppression stays `blocked`, or conducts, throughout the step.
    fn flux_step(&self, now: &State, blocked: bool, mut h: f64) -> (f64, State) {
        let gap = |s: &State| self.model.gap(Element::CoilBlocked, s, &self.drive);
        let after = |h: f64| {
            let mut next = *now;
            next[LAMBDA] += h * self.mean_rate(now, blocked, h);
            next
        };
        let (from, mut next) = (gap(now), after(h));
        if blocked || matches!(self.drive, Drive::Source { .. }) {
            return (h, next);
        }
        for _ in 0..BLOCKING_TRIALS {
            let mut pressed = next;
            self.model.pressed(&mut pressed);
            let to = gap(&pressed);
            if to < STILL_V {
                break;
            }
            h *= from / (from - to);
            next = after(h);
        }
        (h, next)
    }

    /// Returns a state in equilibrium with the speeds at which armature and leaf follow the flux.
    fn with_speeds(&self, now: &State, rate: f64) -> State {
        let mut later = *now;
        later[LAMBDA] += QUOTIENT_S * rate;
        self.model.pressed(&mut later);
        let mut moving = *now;
        moving[V] = (later[X] - now[X]) / QUOTIENT_S;
        moving[W] = (later[Y] - now[Y]) / QUOTIENT_S;
        moving
    }

    /// Sets armature and leaf to equilibrium under a flux; returns the force on the stop, N.
    fn press(&mut self, mut s: State) -> f64 {
        let push = self.model.pressed(&mut s);
        s[V] = 0.0;
        s[W] = 0.0;
        self.solver.state = s;
        push
    }

    /// Returns the mean rate of change of the flux over a step, by the classical Runge-Kutta method of order 4. The
    /// travel of the armature, up to 0.15 um in a step on the seat, counts as linear in time.
    fn mean_rate(&self, s: &State, blocked: bool, h: f64) -> f64 {
        let first = self.branch_rate(s, blocked);
        let mut end = *s;
        end[LAMBDA] += h * first;
        self.model.pressed(&mut end);
        let at = |rate: f64, part: f64| {
            let mut then = *s;
            then[LAMBDA] += part * h * rate;
            then[X] += part * (end[X] - s[X]);
            self.branch_rate(&then, blocked)
        };
        let second = at(first, 0.5);
        let third = at(second, 0.5);
        let fourth = at(third, 1.0);
        (first + 2.0 * (second + third) + fourth) / 6.0
    }
}
