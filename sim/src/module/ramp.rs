//! Output stage of one analog channel: target, present value and slew.
//!
//! With slew code 0 the output jumps to its target. Otherwise it moves in one step per refresh; code 1 is 0.0625
//! V/s (0.125 mA/s), and each further code doubles the rate.

/// Slewed output; values in the unit of the output (V or mA).
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp {
    target: f64,
    present: f64,
    next_us: Option<u64>,
}

/// Returns the nominal rate of a slew code, units per second; `None` for code 0.
pub fn nominal_rate(code: u8, is_current: bool) -> Option<f64> {
    let first = if is_current { 0.125 } else { 0.0625 };
    (code > 0).then(|| first * f64::from(1u32 << (code.min(15) - 1)))
}

impl Ramp {
    /// Creates an output at rest.
    pub fn at(value: f64) -> Self {
        Self {
            target: value,
            present: value,
            next_us: None,
        }
    }

    /// Returns the last commanded value.
    pub fn target(&self) -> f64 {
        self.target
    }

    /// Returns the present value.
    pub fn present(&self) -> f64 {
        self.present
    }

    /// Jumps to a value, whatever the slew code.
    pub fn jump(&mut self, value: f64) {
        *self = Self::at(value);
    }

    /// Moves to `value` in steps; unless steps are already running, the first one follows after one refresh.
    pub fn go(&mut self, value: f64, now_us: u64, refresh_us: u64) {
        self.target = value;
        if self.next_us.is_none() && self.present != value {
            self.next_us = Some(now_us + refresh_us);
        }
    }

    /// Returns the instant of the next step; `u64::MAX` at rest.
    pub fn next_us(&self) -> u64 {
        self.next_us.unwrap_or(u64::MAX)
    }

    /// Moves by one step of at most `step` units; `refresh_us` is the time to the next step.
    pub fn step(&mut self, step: f64, refresh_us: u64) {
        let left = self.target - self.present;
        if left.abs() <= step {
            self.jump(self.target);
        } else {
            self.present += step.copysign(left);
            self.next_us = self.next_us.map(|due| due + refresh_us);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_slew_code_doubles_the_rate() {
        assert_eq!(nominal_rate(0, false), None);
        assert_eq!(nominal_rate(5, false), Some(1.0));
        assert_eq!(nominal_rate(0xB, false), Some(64.0));
        assert_eq!(nominal_rate(0xF, true), Some(2048.0));
    }

    #[test]
    fn a_ramp_steps_down_to_its_target_and_rests() {
        let mut ramp = Ramp::at(1.0);
        ramp.go(0.75, 100, 1_000);
        assert_eq!(ramp.next_us(), 1_100);
        ramp.step(0.2, 1_000);
        assert_eq!((ramp.present(), ramp.next_us()), (0.8, 2_100));
        ramp.step(0.2, 1_000);
        assert_eq!((ramp.present(), ramp.next_us()), (0.75, u64::MAX));
    }
}
