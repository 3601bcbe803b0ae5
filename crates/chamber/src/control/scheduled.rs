//! Fuzzy-PID: rule tables adjust the three gains of a PID by up to half of their tuned values.
//!
//! The tables of textbooks lower the gain for positive errors only. [`Symmetry::Even`] mirrors them, so that cold and
//! hot errors are treated alike.

use super::Task;
use super::filter::Slope;
use super::fuzzy::Level::{self, NB, NM, NS, PB, PM, PS, ZO};
use super::fuzzy::{Table, infer};
use super::pid::{DERIVATIVE_FILTER_S, Pid};
use crate::tune::Settings;

/// Rules for the proportional gain; rows by error NB to PB, columns by change of error NB to PB.
pub const KP: Table = [
    [PB, PB, PM, PM, PS, ZO, ZO],
    [PB, PB, PM, PS, PS, ZO, NS],
    [PM, PM, PM, PS, ZO, NS, NS],
    [PM, PM, PS, ZO, NS, NM, NM],
    [PS, PS, ZO, NS, NS, NM, NM],
    [PS, ZO, NS, NM, NM, NM, NB],
    [ZO, ZO, NM, NM, NM, NB, NB],
];

/// Rules for the integral gain.
pub const KI: Table = [
    [NB, NB, NM, NM, NS, ZO, ZO],
    [NB, NB, NM, NS, NS, ZO, ZO],
    [NB, NM, NS, NS, ZO, PS, PS],
    [NM, NM, NS, ZO, PS, PM, PM],
    [NM, NS, ZO, PS, PS, PM, PB],
    [ZO, ZO, PS, PS, PM, PB, PB],
    [ZO, ZO, PS, PM, PM, PB, PB],
];

/// Rules for the derivative gain.
pub const KD: Table = [
    [PS, NS, NB, NB, NB, NM, PS],
    [PS, NS, NB, NM, NM, NS, ZO],
    [ZO, NS, NM, NM, NS, NS, ZO],
    [ZO, NS, NS, NS, NS, NS, ZO],
    [ZO, ZO, ZO, ZO, ZO, ZO, ZO],
    [PB, NS, PS, PS, PS, PS, PB],
    [PB, PM, PM, PM, PS, PS, PB],
];

/// Change of error of one level, K/s.
const CHANGE_K_PER_S: f64 = 1.0 / 20.0;
/// Share by which level 3 of a table changes a gain.
const REACH: f64 = 0.5;

/// Treatment of positive errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// As textbooks print the tables.
    Book,
    /// Positive errors use the mirrored rule.
    Even,
}

/// State of a fuzzy-PID controller, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct FuzzyPid {
    tuned: Settings,
    symmetry: Symmetry,
    pid: Pid,
    slope: Slope,
}

impl FuzzyPid {
    /// Starts from tuned settings.
    pub const fn new(tuned: Settings, symmetry: Symmetry) -> Self {
        Self {
            tuned,
            symmetry,
            pid: Pid::new(tuned),
            slope: Slope::smoothed_over(DERIVATIVE_FILTER_S),
        }
    }

    /// Adds `by`, 1 = full heater, to the integral when the feed-forward falls by as much.
    pub fn shift(&mut self, by: f64) {
        self.pid.shift(by);
    }

    /// Returns the power of this second within the limits of the task.
    pub fn step(&mut self, task: &Task) -> f64 {
        let change = self.slope.step(task.error_k) / CHANGE_K_PER_S;
        self.pid.set(self.moved(task.error_k, change));
        self.pid.step(task)
    }

    /// Returns the adjusted settings for an error (in levels, which are K) and its change (in levels).
    fn moved(&self, error: f64, change: f64) -> Settings {
        let mirrored = self.symmetry == Symmetry::Even && error > 0.0;
        let (error, change) = if mirrored {
            (-error, -change)
        } else {
            (error, change)
        };
        let factor = |table: &Table| 1.0 + REACH * infer(table, error, change) / Level::PB.peak();
        let Settings {
            gain_per_k,
            integral_s,
            derivative_s,
        } = self.tuned;
        let [kp, ki, kd] = [&KP, &KI, &KD].map(factor);
        Settings {
            gain_per_k: gain_per_k * kp,
            integral_s: integral_s * kp / ki,
            derivative_s: derivative_s * kd / kp,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TUNED: Settings = Settings {
        gain_per_k: 0.09,
        integral_s: 36.0,
        derivative_s: 5.0,
    };

    #[test]
    fn no_error_leaves_the_proportional_gain() {
        let law = FuzzyPid::new(TUNED, Symmetry::Book);
        assert!((law.moved(0.0, 0.0).gain_per_k - TUNED.gain_per_k).abs() < 1e-12);
    }

    #[test]
    fn gains_move_by_half_at_most() {
        let law = FuzzyPid::new(TUNED, Symmetry::Book);
        for error in [-9.0, -1.3, 0.2, 2.0] {
            for change in [-4.0, 0.0, 1.7] {
                let found = law.moved(error, change);
                let ratios = [
                    found.gain_per_k / TUNED.gain_per_k,
                    found.gain_per_k / found.integral_s / (TUNED.gain_per_k / TUNED.integral_s),
                    found.gain_per_k * found.derivative_s / (TUNED.gain_per_k * TUNED.derivative_s),
                ];
                assert!(
                    ratios.iter().all(|it| (0.499..=1.501).contains(it)),
                    "{ratios:?}"
                );
            }
        }
    }

    #[test]
    fn even_tables_treat_cold_and_hot_alike() {
        let even = FuzzyPid::new(TUNED, Symmetry::Even);
        assert_eq!(even.moved(1.2, 0.4), even.moved(-1.2, -0.4));
        let book = FuzzyPid::new(TUNED, Symmetry::Book);
        assert!(book.moved(2.5, 0.4).gain_per_k < book.moved(-2.5, -0.4).gain_per_k);
    }
}
