//! Model of an identified chamber, which runs along with the real one: power in, slope out.

use super::Identified;
use crate::control::filter::Delay;

/// State of the model, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    gain_k: f64,
    time_constant_s: f64,
    slope_k_per_s: f64,
    delay: Delay,
    settling_k: f64,
}

impl Response {
    /// Starts at rest.
    pub fn of(chamber: &Identified) -> Self {
        Self {
            gain_k: chamber.gain_k,
            time_constant_s: chamber.time_constant_s.max(1.0),
            slope_k_per_s: chamber.slope_k_per_s,
            delay: Delay::of(chamber.delay_s),
            settling_k: 0.0,
        }
    }

    /// Takes the net power of this second (heat less losses, 1 = full heater) and returns the change of temperature,
    /// K/s.
    pub fn step(&mut self, power: f64) -> f64 {
        let power = self.delay.step(power);
        let change = (self.gain_k * power - self.settling_k) / self.time_constant_s;
        self.settling_k += change;
        change + self.slope_k_per_s * power
    }
}
