//! PID with back-calculation of the integral at the limits.
//!
//! The derivative acts on the measurement; with feed-forward it acts on the error, because the ramp of the set point
//! has no steps. The integral acts at every error: if it waited for a small error, the chamber could stay far from the
//! set point for good.

use super::Task;
use super::filter::Slope;
use crate::tune::Settings;

/// Time constant of the derivative filter, s.
pub const DERIVATIVE_FILTER_S: f64 = 4.0;
/// Time constant with which the integral returns when the power is at a limit, s.
const TRACKING_S: f64 = 20.0;

/// State of a PID controller, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Pid {
    settings: Settings,
    integral: f64,
    slope: Slope,
}

impl Pid {
    /// Starts with an integral of zero.
    pub const fn new(settings: Settings) -> Self {
        Self {
            settings,
            integral: 0.0,
            slope: Slope::smoothed_over(DERIVATIVE_FILTER_S),
        }
    }

    /// Returns the settings in force.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Changes the settings; the integral stays.
    pub fn set(&mut self, settings: Settings) {
        self.settings = settings;
    }

    /// Adds `by`, 1 = full heater, to the integral when the feed-forward falls by as much, so that the power has no
    /// step.
    pub fn shift(&mut self, by: f64) {
        self.integral += by;
    }

    /// Returns the power of this second within the limits of the task.
    pub fn step(&mut self, task: &Task) -> f64 {
        let Settings {
            gain_per_k: gain,
            integral_s,
            derivative_s,
        } = self.settings;
        let slope = self.slope.step(task.moving_c);
        let wanted =
            gain * task.error_k + self.integral - gain * derivative_s * slope + task.forward;
        let power = wanted.clamp(task.lowest, task.highest);
        self.integral += gain / integral_s * task.error_k + (power - wanted) / TRACKING_S;
        power
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: Settings = Settings {
        gain_per_k: 0.1,
        integral_s: 40.0,
        derivative_s: 0.0,
    };

    fn task(error_k: f64) -> Task {
        Task {
            error_k,
            moving_c: 60.0 - error_k,
            forward: 0.0,
            lowest: 0.0,
            highest: 1.0,
        }
    }

    #[test]
    fn a_constant_error_adds_its_share_each_second() {
        let mut pid = Pid::new(SETTINGS);
        let powers: Vec<f64> = (0..3).map(|_| pid.step(&task(1.0))).collect();
        let expected = [0.1, 0.1025, 0.105];
        assert!(
            powers
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
    }

    #[test]
    fn a_saturated_integral_returns_within_a_minute() {
        let mut pid = Pid::new(SETTINGS);
        for _ in 0..3600 {
            pid.step(&task(20.0));
        }
        let back = (0..60).position(|_| pid.step(&task(-0.5)) < 0.5);
        assert!(back.is_some());
    }

    #[test]
    fn a_run_agrees_with_the_crate_pidgeon() {
        use pidgeon::{AntiWindupMode, ControllerConfig, PidState, pid_compute};
        let settings = Settings {
            derivative_s: 5.0,
            ..SETTINGS
        };
        let Settings {
            gain_per_k: kp,
            integral_s,
            derivative_s,
        } = settings;
        let config = ControllerConfig::builder()
            .with_kp(kp)
            .with_ki(kp / integral_s)
            .with_kd(kp * derivative_s)
            .with_setpoint(60.0)
            .with_output_limits(0.0, 1.0)
            .with_anti_windup_mode(AntiWindupMode::BackCalculation {
                tracking_time: TRACKING_S,
            })
            .with_derivative_filter_coeff(1.0 / DERIVATIVE_FILTER_S)
            .build()
            .unwrap();
        let (mut own, mut peer) = (Pid::new(settings), PidState::default());
        for second in 0..600 {
            let error_k =
                30.0 * (-f64::from(second) / 90.0).exp() * (f64::from(second) / 30.0).cos();
            let (expected, next) = pid_compute(&config, &peer, 60.0 - error_k, 1.0).unwrap();
            peer = next;
            // The peer adds the error of this second to the integral before it computes the output.
            own.shift(kp / integral_s * error_k);
            let found = own.step(&task(error_k));
            own.shift(-kp / integral_s * error_k);
            assert!(
                (found - expected).abs() < 1e-9,
                "{second}: {found}, {expected}"
            );
        }
    }
}
