//! A dummy of relay size that checks the fixture: one metal-film resistor of known value between the coil pins.
//!
//! The body has the shape of a relay, and the feeder handles it as one. All five pins are present and plain, so force
//! and sense probe touch metal at every pin and the Kelvin test passes. Common, NO and NC are blind: no wire leads to
//! them, so no contact ever closes. The current follows the supply at once. The resistor keeps the temperature that it
//! had in the magazine: in reality it warms by a few kelvin, each of which changes the resistance by 25 ppm.

mod lot;

use super::probes::{Change, Pins, Supply};
use super::specimen::{ProbeInterface, REFERENCE_C};
use crate::truth::PartTruth;
use crate::world::signal::vocabulary;
use crate::world::table::table;
pub use lot::Lot;

table!(
    /// Value, scatter and defects of a lot of dummies.
    ResistorTable {
        nominal_ohm: f64, tolerance_sd_pct: f64, tcr_ppm_per_k: f64,
        defects_pct: f64, short_ohm: [f64; 2], wrong_value_factor: [f64; 2],
    }
);

vocabulary! {
    /// Defect of a dummy, with its name in the truth file.
    Defect {
        /// No connection between the pins.
        Open = "open",
        /// Resistance of a short piece of wire.
        Short = "short",
        /// Another value of the resistor series.
        WrongValue = "wrong_value",
        /// Misoriented in the nest.
        Misoriented = "turned",
    }
}

impl Defect {
    /// Defects that a lot draws; only a fault makes a dummy misoriented.
    pub const OF_A_LOT: &'static [Self] = &[Self::Open, Self::Short, Self::WrongValue];
}

/// A dummy on the probes.
#[derive(Debug, Clone)]
pub struct Resistor {
    /// Resistance at [`REFERENCE_C`], ohm; infinite when open.
    resistance_ohm: f64,
    tcr_per_k: f64,
    celsius: f64,
    defect: Option<Defect>,
    pins: Pins,
    supply_v: f64,
}

impl ProbeInterface for Resistor {
    fn pins(&self) -> Pins {
        self.pins
    }

    fn input_ohm(&self) -> f64 {
        self.resistance_ohm * (1.0 + self.tcr_per_k * (self.celsius - REFERENCE_C))
    }

    fn input_a(&self) -> f64 {
        self.supply_v / self.input_ohm()
    }

    /// Changes the supply; without inductance no current flows into the suppression.
    fn drive(&mut self, _t_us: f64, supply: Supply) {
        self.supply_v = supply.volts();
    }

    fn advance(&mut self, _t_us: f64) -> Option<Change> {
        None
    }

    fn truth(&self) -> PartTruth {
        let ohm = self.resistance_ohm;
        PartTruth {
            resistance_ohm: ohm.is_finite().then_some(ohm),
            defect: self.defect.map(Defect::name),
            ..PartTruth::default()
        }
    }
}

#[cfg(test)]
mod tests;
