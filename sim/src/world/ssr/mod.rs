//! A solid-state relay in the nest: light of the LED on its driver, heat of the junction, firing of an AC output.
//!
//! The board solves the circuit and gives the part its input current and its power, both constant between two events.
//! The electrical model is that of the instruments' bench (`scpi/relay`).

mod ac;
mod ac_values;
mod defect;
mod lot;
pub mod table;
mod truth;
mod values;

use super::probes::{Change, Pins, Supply};
use super::specimen::ProbeInterface;
use crate::scpi::circuit::{Drive, Reading};
use crate::scpi::relay::{Heat, Light};
use crate::truth::PartTruth;
pub use defect::Defect;
pub use lot::Lot;
pub use truth::SsrTruth;
pub use values::{Rated, Values};

/// A part with its state.
#[derive(Debug, Clone)]
pub struct Ssr {
    values: Values,
    defect: Option<Defect>,
    /// Resistance of the loop for which figures at the rated alternating current are defined, ohms.
    loop_ohm: f64,
    light: Light,
    heat: Heat,
    at: AtTemperature,
    now_us: f64,
}

/// Change of the temperature from which its effects are computed anew, kelvin.
const STALE_K: f64 = 1e-4;

/// Values of the part at a temperature of its junction.
#[derive(Debug, Clone, Copy)]
struct AtTemperature {
    celsius: f64,
    threshold_a: f64,
    on_siemens: f64,
    blocked_siemens: f64,
    /// Threshold voltage of the conducting AC output in positive and in negative direction, volts.
    knee_v: [f64; 2],
    slope_ohm: f64,
}

impl AtTemperature {
    fn new(values: &Values, celsius: f64) -> Self {
        Self {
            celsius,
            threshold_a: values.model.threshold_at(celsius),
            on_siemens: 1.0 / values.on_ohm(celsius),
            blocked_siemens: values.blocked_siemens(celsius),
            knee_v: values.knee_v(celsius),
            slope_ohm: values.model.slope_ohm(celsius),
        }
    }
}

impl Ssr {
    /// Creates a cold, dark part at an instant, microseconds.
    pub fn new(values: Values, defect: Option<Defect>, loop_ohm: f64, now_us: f64) -> Self {
        Self {
            at: AtTemperature::new(&values, values.celsius),
            values,
            defect,
            loop_ohm,
            light: Light::default(),
            heat: Heat::default(),
            now_us,
        }
    }

    /// Returns the temperature of the junction, degrees Celsius; changes below a ten-thousandth of a kelvin wait.
    pub fn celsius(&self) -> f64 {
        self.at.celsius
    }

    /// Returns voltage and current of the input at a source.
    pub fn input(&self, drive: Drive) -> Reading {
        self.values.model.at_input(drive, self.celsius())
    }

    /// Returns the light of an input current, over the threshold.
    pub fn goal(&self, input_a: f64) -> f64 {
        input_a.max(0.0) / self.at.threshold_a
    }

    /// Returns the time after which the output switches at a light, microseconds; `None` for never.
    pub fn switch_us(&self, goal: f64) -> Option<f64> {
        let after_s = self.light.switch_s(goal, &self.values.model)?;
        Some(after_s * 1e6)
    }

    /// Checks whether the light lets the output conduct.
    pub fn is_lit(&self) -> bool {
        self.light.is_lit()
    }

    /// Returns the present conductance of the blocked or DC output, siemens; a conducting AC output has none.
    pub fn siemens(&self) -> f64 {
        match self.values.model.shorted || self.light.is_lit() && !self.is_ac() {
            true => self.at.on_siemens,
            false => self.at.blocked_siemens,
        }
    }

    /// Returns the capacitance over the output, farads.
    pub fn farads(&self) -> f64 {
        self.values.model.capacitance_f
    }

    /// Advances by `dt_us` at a constant light goal and power, watts.
    pub fn pass(&mut self, dt_us: f64, goal: f64, watts: f64) {
        let dt_s = dt_us * 1e-6;
        self.shine(goal, dt_s);
        let k_per_w = self.values.model.junction_k_per_w;
        self.heat.advance(watts, k_per_w, dt_s);
        let celsius = self.values.celsius + self.heat.kelvin();
        if (celsius - self.at.celsius).abs() > STALE_K {
            self.at = AtTemperature::new(&self.values, celsius);
        }
        self.now_us += dt_us;
    }

    /// Moves the light towards its goal, and switches the output when the light passes a threshold.
    fn shine(&mut self, goal: f64, dt_s: f64) {
        let (model, was_lit) = (&self.values.model, self.is_lit());
        let switch_s = self.light.switch_s(goal, model);
        let Some(first_s) = switch_s.filter(|it| *it <= dt_s) else {
            return self.light.advance(goal, model, dt_s);
        };
        self.light.advance(goal, model, first_s);
        self.light.switch(!was_lit, model);
        if dt_s > first_s {
            self.light.advance(goal, model, dt_s - first_s);
        }
    }

    /// Returns the true figures.
    pub fn figures(&self) -> SsrTruth {
        SsrTruth::new(&self.values, self.defect, self.loop_ohm)
    }
}

impl ProbeInterface for Ssr {
    fn pins(&self) -> Pins {
        self.values.pins
    }

    fn input_ohm(&self) -> f64 {
        f64::INFINITY
    }

    fn input_a(&self) -> f64 {
        0.0
    }

    /// The coil supply of a board for other parts reaches no pin of this one.
    fn drive(&mut self, _t_us: f64, _supply: Supply) {}

    /// Advances without source.
    fn advance(&mut self, t_us: f64) -> Option<Change> {
        let dt_us = t_us - self.now_us;
        if dt_us > 0.0 {
            self.pass(dt_us, 0.0, 0.0);
            self.now_us = t_us;
        }
        None
    }

    fn truth(&self) -> PartTruth {
        PartTruth {
            ssr: Some(self.figures()),
            defect: self.defect.map(Defect::name),
            ..PartTruth::default()
        }
    }
}
