//! Event-driven integration: error-controlled steps that end exactly where a mode changes. Integrators of crates spend
//! more on events, or miss them: `cargo bench -p rigsim --features peers --bench transient` compares them.
//!
//! - The flags are constant within a step. After the step the solver compares every gap function with its flag.
//! - To locate a change it repeats the step with trial lengths (Illinois secant method), so the instant has the full
//!   order of the method. Of several changes in one step, the earliest counts.
//! - Two opposite changes within one step leave the signs unchanged. A cubic through the overlap of a stop and its rate
//!   at both ends of the step reveals them: where the cubic turns close to the touch, the step ends there.
//! - The step after a change is short.

use super::State;
use super::coil::Drive;
use super::dop853::{EVALUATIONS, Tolerance, TrialStep, step};
use super::model::Model;
use super::modes::{Element, Modes};

/// A change of a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Instant, s.
    pub t_s: f64,
    /// Element whose mode changes.
    pub element: Element,
    /// True when the element engages, false when it becomes free.
    pub on: bool,
    /// The state at that instant.
    pub state: State,
}

/// Reason why the integration cannot continue.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// Even the shortest step exceeds the tolerance.
    #[error("at {t_s} s the shortest step exceeds the tolerance: the state diverges")]
    Runaway {
        /// Instant, s.
        t_s: f64,
    },
    /// The number of evaluations reaches its limit.
    #[error("at {t_s} s the limit of {evaluations} evaluations is reached")]
    Endless {
        /// Instant, s.
        t_s: f64,
        /// Number of evaluations so far.
        evaluations: u64,
    },
}

/// First step, and longest step after an event, s; the contacts oscillate with periods of 50 us and longer.
const SHORT_S: f64 = 1e-6;
/// Longest step, s: a few time constants of the flux.
const LONG_S: f64 = 2e-3;
/// Shortest useful step, s: the rounding of the instant itself.
const SHORTEST_S: f64 = 1e-17;
/// Distance from the start of a step within which a turning point counts as already checked, s.
const NEAR_S: f64 = 1e-9;
/// Limit of the number of evaluations: a second of chatter.
const EVALUATION_LIMIT: u64 = 400_000_000;

/// An integration in progress.
#[derive(Debug, Clone)]
pub struct Solver {
    /// Present instant, s.
    pub t_s: f64,
    /// Present state.
    pub state: State,
    /// Present flags.
    pub modes: Modes,
    /// Number of evaluations of the equations so far.
    pub evaluations: u64,
    /// Number of steps so far.
    pub steps: u64,
    tolerance: Tolerance,
    h: f64,
}

impl Solver {
    /// Starts in the given state; `relative` is the permitted error of a step as a fraction of the state.
    pub fn new(model: &Model, drive: &Drive, t_s: f64, state: State, relative: f64) -> Self {
        Self {
            t_s,
            state,
            modes: model.modes(&state, drive),
            evaluations: 0,
            steps: 0,
            tolerance: Tolerance { relative },
            h: SHORT_S,
        }
    }

    /// Applies a changed drive: recomputes the flag of the suppression.
    pub fn drive_changed(&mut self, model: &Model, drive: &Drive) {
        let blocked = model.gap(Element::CoilBlocked, &self.state, drive) > 0.0;
        self.modes.set(Element::CoilBlocked, blocked);
    }

    /// Advances to `until_s`, or to the first event before it.
    ///
    /// # Errors
    /// Fails when the state diverges, or the number of evaluations reaches its limit.
    pub fn advance(
        &mut self,
        model: &Model,
        drive: &Drive,
        until_s: f64,
    ) -> Result<Option<Event>, SolveError> {
        let mut slope = self.rates(model, drive);
        while self.t_s < until_s {
            let whole = until_s - self.t_s;
            let h = self.h.min(LONG_S).min(whole);
            let tried = self.attempt(model, drive, &slope, h);
            self.control(tried.error, h)?;
            if tried.error.is_nan() || tried.error > 1.0 {
                continue;
            }
            let (h, state) = self.cut_at_graze(model, drive, &slope, h, tried.state);
            if let Some((h, state, element)) = self.first_change(model, drive, &slope, h, state) {
                return Ok(Some(self.change(h, state, element)));
            }
            self.t_s = if h == whole { until_s } else { self.t_s + h };
            self.state = state;
            slope = self.rates(model, drive);
        }
        Ok(None)
    }

    fn rates(&mut self, model: &Model, drive: &Drive) -> State {
        self.evaluations += 1;
        model.rates(self.t_s, &self.state, self.modes, drive)
    }

    #[inline]
    fn attempt(&mut self, model: &Model, drive: &Drive, slope: &State, h: f64) -> TrialStep {
        self.evaluations += EVALUATIONS;
        let modes = self.modes;
        let f = |t: f64, s: &State| model.rates(t, s, modes, drive);
        step(f, [self.t_s, h], &self.state, slope, &self.tolerance)
    }

    /// Sets the length of the next step from the error of this one.
    fn control(&mut self, error: f64, h: f64) -> Result<(), SolveError> {
        self.steps += 1;
        let factor = match error.is_nan() {
            true => 0.1,
            false => (0.9 * error.max(1e-10).powf(-0.125)).clamp(0.33, 6.0),
        };
        let cut = h < self.h && error <= 1.0;
        self.h = if cut {
            self.h.max(h * factor)
        } else {
            h * factor
        };
        if self.h < SHORTEST_S || self.t_s + self.h == self.t_s {
            return Err(SolveError::Runaway { t_s: self.t_s });
        }
        if self.evaluations > EVALUATION_LIMIT {
            return Err(SolveError::Endless {
                t_s: self.t_s,
                evaluations: self.evaluations,
            });
        }
        Ok(())
    }

    fn change(&mut self, h: f64, state: State, element: Element) -> Event {
        let on = !self.modes.is_engaged(element);
        self.t_s += h;
        self.state = state;
        self.modes.set(element, on);
        self.h = self.h.min(SHORT_S);
        Event {
            t_s: self.t_s,
            element,
            on,
            state,
        }
    }

    /// Shortens the step to the turning point of an overlap that comes close to a touch or passes it twice.
    fn cut_at_graze(
        &mut self,
        model: &Model,
        drive: &Drive,
        slope: &State,
        h: f64,
        state: State,
    ) -> (f64, State) {
        let mut best = (h, state);
        for element in Element::TOUCHING {
            let side = if self.modes.is_engaged(element) {
                1.0
            } else {
                -1.0
            };
            let of = |s: &State| {
                (
                    side * model.stops.overlap(element, s),
                    side * model.stops.rate(element, s),
                )
            };
            let ((from, falls), (to, rises)) = (of(&self.state), of(&state));
            if falls >= 0.0 || rises <= 0.0 || to < 0.0 {
                continue;
            }
            let (share, low) = turning_point([from, falls * h], [to, rises * h]);
            let at = share * h;
            if low < 0.05 * from.min(to) && at < best.0 && at > NEAR_S {
                best = (at, self.attempt(model, drive, slope, at).state);
            }
        }
        best
    }

    /// Returns the earliest change of a flag within a step: step length, state and element; `None` without a change.
    fn first_change(
        &mut self,
        model: &Model,
        drive: &Drive,
        slope: &State,
        h: f64,
        state: State,
    ) -> Option<(f64, State, Element)> {
        let mut first = None;
        let (mut h, mut state) = (h, state);
        for element in Element::TOUCHING.into_iter().chain([Element::CoilBlocked]) {
            if (model.gap(element, &state, drive) > 0.0) != self.modes.is_engaged(element) {
                (h, state) = self.locate(model, drive, slope, element, h, state);
                first = Some((h, state, element));
            }
        }
        first
    }

    /// Returns the step length, at most `h`, at which the gap function of the element is zero, and the state
    /// there. The gap function must have changed its sign by `h`.
    fn locate(
        &mut self,
        model: &Model,
        drive: &Drive,
        slope: &State,
        element: Element,
        h: f64,
        state: State,
    ) -> (f64, State) {
        let side = if self.modes.is_engaged(element) {
            1.0
        } else {
            -1.0
        };
        let gap = |s: &State| side * model.gap(element, s, drive);
        let (mut lo, mut low) = (0.0, gap(&self.state).max(0.0));
        let (mut hi, mut high) = (h, gap(&state));
        let (mut best, mut moved) = ((h, state), h);
        let mut inside = None;
        while high < 0.0 && hi - lo > exact(self.t_s) && moved > exact(self.t_s) {
            let secant = hi - high * (hi - lo) / (high - low);
            let at = if secant > lo && secant < hi {
                secant
            } else {
                0.5 * (lo + hi)
            };
            let there = self.attempt(model, drive, slope, at).state;
            let value = gap(&there);
            moved = (at - best.0).abs();
            best = (at, there);
            if value > 0.0 {
                (lo, low) = (at, value);
                high *= if inside == Some(true) { 0.5 } else { 1.0 };
            } else {
                (hi, high) = (at, value);
                low *= if inside == Some(false) { 0.5 } else { 1.0 };
            }
            inside = Some(value > 0.0);
        }
        best
    }
}

/// Returns the accuracy to which an instant is located, s.
fn exact(t_s: f64) -> f64 {
    1e-15 + 4.0 * f64::EPSILON * t_s
}

/// Returns position and value of the minimum of the cubic through value and slope at 0 and 1; the slope is
/// negative at 0 and positive at 1.
fn turning_point([from, falls]: [f64; 2], [to, rises]: [f64; 2]) -> (f64, f64) {
    let c2 = 3.0 * (to - from) - 2.0 * falls - rises;
    let c3 = 2.0 * (from - to) + falls + rises;
    let root = (c2 * c2 - 3.0 * c3 * falls).max(0.0).sqrt();
    let at = (-falls / (c2 + root)).clamp(0.0, 1.0);
    (at, from + at * (falls + at * (c2 + at * c3)))
}
