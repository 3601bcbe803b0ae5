//! Light on the driver of an output, relative to its threshold: the delay between input current and switching.

use super::truth::Truth;

/// Light divided by its threshold; the output switches on at 1 and off at the hysteresis, below 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Light {
    level: f64,
    lit: bool,
}

impl Light {
    /// Checks whether the output conducts.
    pub fn is_lit(&self) -> bool {
        self.lit
    }

    /// Moves the light for `dt_s` towards `goal`, the input current divided by its threshold; exact for a constant
    /// current.
    pub fn advance(&mut self, goal: f64, truth: &Truth, dt_s: f64) {
        let kept = (-dt_s / Self::tau_s(self.level, goal, truth)).exp();
        self.level = goal + (self.level - goal) * kept;
        let least = if self.lit { truth.hysteresis } else { 1.0 };
        self.lit = self.level >= least;
    }

    /// Returns the time until the output switches, seconds; `None` when this input current never switches it.
    pub fn switch_s(&self, goal: f64, truth: &Truth) -> Option<f64> {
        let limit = if self.lit { truth.hysteresis } else { 1.0 };
        let (rest, whole) = match self.lit {
            true => (limit - goal, self.level - goal),
            false => (goal - limit, goal - self.level),
        };
        if rest <= 0.0 {
            return None;
        }
        Some(Self::tau_s(self.level, goal, truth) * (whole / rest).ln().max(0.0))
    }

    /// Switches the output at the end of the time that [`Light::switch_s`] returned, whatever rounding left.
    pub fn switch(&mut self, on: bool, truth: &Truth) {
        self.lit = on;
        self.level = if on { 1.0 } else { truth.hysteresis };
    }

    fn tau_s(level: f64, goal: f64, truth: &Truth) -> f64 {
        match goal > level {
            true => truth.on_tau_s,
            false => truth.off_tau_s,
        }
    }
}
