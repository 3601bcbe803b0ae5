//! Incremental fuzzy control, as furnaces have it: error and change of error decide by how much the power changes each
//! second.

use super::Task;
use super::filter::Slope;
use super::fuzzy::{FURNACE, MACVICAR_WHELAN, Table, infer};
use super::pid::DERIVATIVE_FILTER_S;

/// A rule table with the scales of its inputs and its output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Rules by error and change of error.
    pub table: Table,
    /// Error that counts as one level, K.
    pub error_k: f64,
    /// Change of error that counts as one level, K/s.
    pub change_k_per_s: f64,
    /// Change of power per second for one level of the output.
    pub power_per_s: f64,
}

impl Rules {
    /// Furnace table with its usual scales.
    pub const FURNACE: Self = Self {
        table: FURNACE,
        error_k: 1.0,
        change_k_per_s: 1.0 / 60.0,
        power_per_s: 0.001,
    };
    /// MacVicar-Whelan table with its usual scales.
    pub const MACVICAR_WHELAN: Self = Self {
        table: MACVICAR_WHELAN,
        error_k: 1.0,
        change_k_per_s: 1.0 / 30.0,
        power_per_s: 0.002,
    };
}

/// State of an incremental fuzzy controller, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Increment {
    rules: Rules,
    sum: f64,
    slope: Slope,
}

impl Increment {
    /// Starts at a power of zero.
    pub const fn new(rules: Rules) -> Self {
        Self {
            rules,
            sum: 0.0,
            slope: Slope::smoothed_over(DERIVATIVE_FILTER_S),
        }
    }

    /// Adds `by`, 1 = full heater, to the power when the feed-forward falls by as much.
    pub fn shift(&mut self, by: f64) {
        self.sum += by;
    }

    /// Returns the power of this second. A power at a limit changes only away from that limit.
    pub fn step(&mut self, task: &Task) -> f64 {
        let Rules {
            table,
            error_k,
            change_k_per_s,
            power_per_s,
        } = &self.rules;
        let change = self.slope.step(task.error_k);
        let by = power_per_s * infer(table, task.error_k / error_k, change / change_k_per_s);
        let wanted = self.sum + task.forward;
        let stuck = by > 0.0 && wanted >= task.highest || by < 0.0 && wanted <= task.lowest;
        if !stuck {
            self.sum += by;
        }
        (self.sum + task.forward).clamp(task.lowest, task.highest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(error_k: f64, forward: f64) -> Task {
        Task {
            error_k,
            moving_c: 60.0,
            forward,
            lowest: -0.2,
            highest: 1.0,
        }
    }

    #[test]
    fn a_steady_error_of_one_kelvin_adds_two_thousandths() {
        let mut law = Increment::new(Rules::FURNACE);
        let first = law.step(&task(1.0, 0.0));
        let second = law.step(&task(1.0, 0.0));
        assert!((first - 0.002).abs() < 1e-12 && (second - 0.004).abs() < 1e-12);
    }

    #[test]
    fn a_power_at_its_limit_does_not_wind_up() {
        let mut law = Increment::new(Rules::FURNACE);
        for _ in 0..5000 {
            law.step(&task(3.0, 0.5));
        }
        assert_eq!(law.step(&task(3.0, 0.5)), 1.0);
        let back = (0..60).map(|_| law.step(&task(-3.0, 0.5))).last();
        assert!(back < Some(0.85), "{back:?}");
    }
}
