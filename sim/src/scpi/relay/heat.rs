//! Temperature of an output above its surroundings: junction and case, each with one time constant.

/// Time constants of junction and case, seconds, and the resistance of the case, kelvin per watt.
pub const JUNCTION_S: f64 = 0.02;
/// See [`JUNCTION_S`].
pub const CASE_S: f64 = 20.0;
/// See [`JUNCTION_S`].
pub const CASE_K_PER_W: f64 = 8.0;

/// Rise of junction and case, kelvin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Heat {
    junction_k: f64,
    case_k: f64,
}

impl Heat {
    /// Returns the rise of the junction, kelvin.
    pub fn kelvin(&self) -> f64 {
        self.junction_k + self.case_k
    }

    /// Warms or cools for `dt_s`; exact for constant power.
    pub fn advance(&mut self, watts: f64, junction_k_per_w: f64, dt_s: f64) {
        let towards =
            |from: f64, goal: f64, tau_s: f64| goal + (from - goal) * (-dt_s / tau_s).exp();
        self.junction_k = towards(self.junction_k, watts * junction_k_per_w, JUNCTION_S);
        self.case_k = towards(self.case_k, watts * CASE_K_PER_W, CASE_S);
    }
}
