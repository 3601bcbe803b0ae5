//! True values of one solid-state relay, and its characteristics as the test defines them.
//!
//! All figures hold at the temperature at which the part comes into the nest. Current warms the part, so a
//! characteristic measured after others differs: 1 A in the default on-state resistance warms the junction by half a
//! kelvin, which raises drop and resistance by 0.3 % and the leakage by 4 % until the junction has cooled (20 ms).

use crate::scpi::relay::{Heat, Light, Truth as Model};
use crate::world::probes::Pins;

/// Current of the drift and of the hot leakage, amperes.
pub const WARM_A: f64 = 1.0;
/// Instants after the begin of [`WARM_A`] between which the drift of the drop counts, milliseconds.
pub const DRIFT_MS: [u64; 2] = [10, 200];

/// Ratings of the recipe at which the figures are defined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rated {
    /// Control voltage at the input pins, volts.
    pub control_v: f64,
    /// Voltage of the blocked output, volts.
    pub blocked_v: f64,
    /// Current of the conducting output, amperes.
    pub load_a: f64,
    /// Frequency of the line, hertz; 0 for a DC output.
    pub hz: f64,
}

/// True values of a part.
#[derive(Debug, Clone, Copy)]
pub struct Values {
    /// Electrical model, stated at 25 degrees Celsius.
    pub model: Model,
    /// Temperature without own heat, degrees Celsius.
    pub celsius: f64,
    /// Ratings of the recipe.
    pub rated: Rated,
    /// Resistance of a shorted output, ohms.
    pub shorted_ohm: f64,
    /// Time in which the load resistor of the rig recharges the output to 90 % after it has turned off, seconds.
    pub recharge_s: f64,
    /// Direction in which a damaged AC output conducts without light: 1 or -1; 0 for none.
    pub half_short: f64,
    /// Pins that touch their probes: in+, in-, out1, out2; the fifth pair has no probe.
    pub pins: Pins,
}

/// Effect of the current [`WARM_A`] on a part that was cold.
#[derive(Debug, Clone, Copy)]
pub struct WarmUp {
    /// Change of the drop from the first to the second instant of [`DRIFT_MS`], volts.
    pub drift_v: f64,
    /// Temperature of the junction at the second instant, degrees Celsius.
    pub junction_c: f64,
}

impl Values {
    /// Turns the part the wrong way round: its pins stand off the middle, so that two probes meet no metal.
    pub fn misorient(&mut self) {
        self.pins = Pins {
            present: [false; 5],
            kelvin: [true, false, false, true, true],
        };
    }

    /// Returns the input current at the nominal control voltage over its threshold.
    fn drive(&self) -> f64 {
        let amps = self.model.input_a(self.rated.control_v, 0.0, self.celsius);
        amps / self.model.threshold_at(self.celsius)
    }

    /// Returns the time from the control edge to 90 % of the load voltage, seconds; infinite without turn-on.
    pub fn turn_on_s(&self) -> f64 {
        let dark = Light::default();
        dark.switch_s(self.drive(), &self.model)
            .unwrap_or(f64::INFINITY)
    }

    /// Returns the time from the end of a long control pulse to 10 % of the load voltage, seconds; the recharging of
    /// the output over the load resistor is part of it.
    pub fn turn_off_s(&self) -> f64 {
        let drive = self.drive();
        let delay_s = self.model.off_tau_s * (drive / self.model.hysteresis).ln();
        delay_s + self.recharge_s
    }

    /// Returns the conductance of the junction of the blocked output, siemens.
    pub fn junction_siemens(&self, celsius: f64) -> f64 {
        self.model.leakage_a * 2f64.powf((celsius - 25.0) / 10.0) / self.rated.blocked_v
    }

    /// Returns the conductance of the blocked output, siemens. The leakage grows in proportion to the voltage.
    pub fn blocked_siemens(&self, celsius: f64) -> f64 {
        1.0 / self.model.leakage_ohm + self.junction_siemens(celsius)
    }

    /// Returns the resistance of the conducting output, ohms.
    pub fn on_ohm(&self, celsius: f64) -> f64 {
        match self.model.shorted {
            true => self.shorted_ohm,
            false => self.model.slope_ohm(celsius),
        }
    }

    /// Lets [`WARM_A`] flow through the cold part.
    pub fn warm_up(&self) -> WarmUp {
        let mut heat = Heat::default();
        let ohm = |heat: &Heat| self.on_ohm(self.celsius + heat.kelvin());
        let mut first_ohm = ohm(&heat);
        for ms in 1..=DRIFT_MS[1] {
            let watts = WARM_A * WARM_A * ohm(&heat);
            heat.advance(watts, self.model.junction_k_per_w, 1e-3);
            if ms == DRIFT_MS[0] {
                first_ohm = ohm(&heat);
            }
        }
        WarmUp {
            drift_v: WARM_A * (ohm(&heat) - first_ohm),
            junction_c: self.celsius + heat.kelvin(),
        }
    }
}
