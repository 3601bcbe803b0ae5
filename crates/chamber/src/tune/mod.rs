//! Finds the settings of a controller from an experiment on its chamber: a step response, or a relay oscillation.

mod cool;
mod doubt;
pub mod fit;
pub mod identify;
pub mod relay;
pub mod response;
pub mod room;

/// Model of a chamber with one lag and a delay: its response to power in the first two minutes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder {
    /// Rise per unit of power, K.
    pub gain_k: f64,
    /// Time constant, s.
    pub time_constant_s: f64,
    /// Delay, s.
    pub delay_s: f64,
}

/// Figures of an identification run: the response to power `K/(tau s + 1) + ki/(s + ki loss)` after a delay, fan and
/// vent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified {
    /// Gain `K` of the part that settles, K per unit of power.
    pub gain_k: f64,
    /// Time constant `tau` of the part that settles, s.
    pub time_constant_s: f64,
    /// Delay, s.
    pub delay_s: f64,
    /// First slope `ki` of the part that rises until the losses balance it, K/s per unit of power.
    pub slope_k_per_s: f64,
    /// Power that replaces the losses per kelvin above ambient, 1/K.
    pub loss_per_k: f64,
    /// Power of the fan, in units of the heater.
    pub fan: f64,
    /// Power that the open vent removes per kelvin above ambient, 1/K.
    pub vent_per_k: f64,
    /// First-order model, for tuning.
    pub first_order: FirstOrder,
}

/// Settings of a PID controller in its standard form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Power per kelvin, 1/K.
    pub gain_per_k: f64,
    /// Integral time, s.
    pub integral_s: f64,
    /// Derivative time, s.
    pub derivative_s: f64,
}

impl Settings {
    /// Tunes by Skogestad's SIMC rule. `calm` is the closed-loop time constant in delays: 1 is tight, 2 gentle.
    ///
    /// ```
    /// use chamber::tune::{FirstOrder, Settings};
    /// let air = FirstOrder { gain_k: 65.0, time_constant_s: 52.0, delay_s: 4.5 };
    /// let tight = Settings::simc(&air, 1.0);
    /// assert!((tight.gain_per_k - 0.089).abs() < 5e-4 && tight.integral_s == 36.0);
    /// ```
    pub fn simc(chamber: &FirstOrder, calm: f64) -> Self {
        let closed_s = (1.0 + calm) * chamber.delay_s;
        Self {
            gain_per_k: chamber.time_constant_s / (chamber.gain_k * closed_s),
            integral_s: chamber.time_constant_s.min(4.0 * closed_s),
            derivative_s: chamber.delay_s,
        }
    }

    /// Tunes from the ultimate gain (1/K) and the period (s) of a relay oscillation: a third of the gain, an integral
    /// time of two periods, a derivative time of an eighth. The rule of Ziegler and Nichols is too aggressive for a
    /// chamber.
    pub fn from_oscillation(ultimate_per_k: f64, period_s: f64) -> Self {
        Self {
            gain_per_k: ultimate_per_k / 3.0,
            integral_s: 2.0 * period_s,
            derivative_s: period_s / 8.0,
        }
    }
}
