//! Event-driven integration: error-controlled steps that end exactly where a mode changes. Integrators of crates spend
//! more on events, or miss them: `cargo bench -p rigsim --features peers --bench transient` compares them.
//!
//! - The flags are constant within a step. After the step the solver compares every gap function with its flag.
//! - To locate a change it repeats the step with trial lengths ([`super::locate`]), so the instant has the full order
//!   of the method. Of several changes in one step, the earliest counts.
//! - Two opposite changes within one step leave the signs unchanged. A cubic through the overlap of a stop and its rate
//!   at both ends of the step reveals them: where the cubic turns close to the touch, the step ends there.
//! - The step after a change is short. While a body leaves a stop, the step ends just behind the end of the touch: the
//!   force has a kink there, over which a method of high order would need many trials.
//! - On request the leaf is condensed while it presses on a contact ([`super::condensed`]): then the steps need not
//!   resolve the swing of its tip.

use super::coil::Drive;
use super::dop853::{EVALUATIONS, Tolerance, TrialStep, step};
use super::model::Model;
use super::modes::{Element, Modes};
use super::{State, Y};

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

/// First step, s.
const FIRST_S: f64 = 1e-6;
/// Longest step after an element has engaged, s; the contacts oscillate with periods of 50 us and longer.
const TOUCHED_S: f64 = 4e-6;
/// Longest step after an element has become free, and after the end of the condensation, s: half a radian of the swing
/// of the tip.
const RELEASED_S: f64 = 2e-5;
/// Longest step towards the end of a touch, as a multiple of the time that the touch lasts at the present speed. What
/// lies behind the kink escapes the estimate of the error: 1.05 would move an operation close to its threshold by 1 %.
const BEYOND_TOUCH: f64 = 1.0001;
/// Shortest step towards the end of a touch, s.
const TO_TOUCH_S: f64 = 1e-8;
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
    /// True while the leaf is condensed.
    condensed: bool,
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
            h: FIRST_S,
            condensed: false,
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
            let h = self.h.min(LONG_S).min(whole).min(self.leaving_s(model));
            let tried = self.attempt(model, drive, &slope, h);
            self.control(tried.error, h)?;
            if tried.error.is_nan() || tried.error > 1.0 {
                continue;
            }
            if self.condensed && !model.keeps_pressing(&tried.state) {
                self.release_leaf(model);
                slope = self.rates(model, drive);
                continue;
            }
            let (h, state) = self.cut_at_graze(model, drive, &slope, h, tried.state);
            if let Some((h, state, element)) = self.first_change(model, drive, &slope, h, state) {
                return Ok(Some(self.change(h, state, element)));
            }
            self.t_s = if h == whole { until_s } else { self.t_s + h };
            self.state = state;
            if self.condensed {
                self.state[Y] = model.resting_tip(&self.state);
            }
            slope = self.rates(model, drive);
        }
        Ok(None)
    }

    /// Condenses the leaf if it presses on a contact and its tip follows the armature; until the pressure ends,
    /// [`Self::advance`] integrates no inertia of the tip.
    pub fn condense_leaf(&mut self, model: &Model) {
        let presses = [Element::Nc, Element::No].map(|it| self.modes.is_engaged(it));
        if !self.condensed && presses != [false, false] && model.tip_follows(&self.state) {
            self.state[Y] = model.resting_tip(&self.state);
            self.condensed = true;
        }
    }

    /// Puts an armature at rest on a stop, with its leaf, into this state; the flags follow from it.
    pub fn rest(&mut self, model: &Model, drive: &Drive, state: State) {
        self.state = state;
        self.modes = model.modes(&state, drive);
        self.condensed = false;
    }

    /// Returns the longest step of a body that leaves a stop or contact, s; infinite while none leaves.
    fn leaving_s(&self, model: &Model) -> f64 {
        let mut first = f64::INFINITY;
        for element in Element::TOUCHING {
            let follows = self.condensed && matches!(element, Element::Nc | Element::No);
            let rate = model.stops.rate(element, &self.state);
            if self.modes.is_engaged(element) && rate < 0.0 && !follows {
                let free_s = model.stops.overlap(element, &self.state) / -rate;
                first = first.min(TO_TOUCH_S.max(BEYOND_TOUCH * free_s));
            }
        }
        first
    }

    /// Gives the tip its own motion again.
    fn release_leaf(&mut self, model: &Model) {
        self.condensed = false;
        self.state = model.with_following_tip(&self.state);
        self.h = self.h.min(RELEASED_S);
    }

    fn rates(&mut self, model: &Model, drive: &Drive) -> State {
        let state = self.state;
        self.rates_at(model, drive, self.t_s, &state)
    }

    /// Returns the rates of change of a state at an instant, with the present flags.
    pub(super) fn rates_at(&mut self, model: &Model, drive: &Drive, t_s: f64, s: &State) -> State {
        self.evaluations += 1;
        match self.condensed {
            true => model.condensed_rates(t_s, s, self.modes, drive),
            false => model.rates(t_s, s, self.modes, drive),
        }
    }

    /// Tries a step of `h` seconds from the present state, whose rates of change are `slope`.
    #[inline]
    pub(super) fn attempt(
        &mut self,
        model: &Model,
        drive: &Drive,
        slope: &State,
        h: f64,
    ) -> TrialStep {
        self.evaluations += EVALUATIONS;
        let (modes, at) = (self.modes, [self.t_s, h]);
        if self.condensed {
            let f = |t: f64, s: &State| model.condensed_rates(t, s, modes, drive);
            return step(f, at, &self.state, slope, &self.tolerance);
        }
        let f = |t: f64, s: &State| model.rates(t, s, modes, drive);
        step(f, at, &self.state, slope, &self.tolerance)
    }

    /// Sets the length of the next step from the error of this one.
    fn control(&mut self, error: f64, h: f64) -> Result<(), SolveError> {
        self.steps += 1;
        let factor = match error.is_nan() {
            true => 0.1,
            // The eighth root: the error of a step grows with the eighth power of its length.
            false => (0.9 / error.max(1e-10).sqrt().sqrt().sqrt()).clamp(0.33, 6.0),
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
        self.h = self.h.min(if on { TOUCHED_S } else { RELEASED_S });
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
                (h, state) = self.locate(model, drive, slope, element, (h, state));
                first = Some((h, state, element));
            }
        }
        first
    }
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
