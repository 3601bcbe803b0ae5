//! A dummy of relay size for a check of the fixture: one metal-film resistor of known value between the coil pins.
//!
//! The body is that of a relay and goes through the feeder as one. All five pins are there, each a plain post, so force
//! and sense probe meet on metal at every one and the Kelvin test finds all five good. Common, NO and NC are blind: no
//! wire leads to them, so no contact ever closes. The resistor follows a supply at once; it keeps the temperature that
//! the part had in the magazine, as it warms by few kelvin and 25 ppm of each.

mod lot;

use serde::Deserialize;

use super::probes::{Change, Pins, Supply};
use super::specimen::{OnProbes, REFERENCE_C};
use crate::truth::PartTruth;
use crate::world::table::table;
pub use lot::Lot;

table!(
    /// Dummies of a lot: value, scatter, defects.
    ResistorTable {
        nominal_ohm: f64, tolerance_sd_pct: f64, tcr_ppm_per_k: f64,
        defects_pct: f64, short_ohm: [f64; 2], wrong_value_factor: [f64; 2],
    }
);

/// What can be wrong with a dummy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defect {
    /// No way through.
    Open,
    /// Hardly more than a piece of wire.
    Short,
    /// Another value of the series.
    WrongValue,
    /// Lies in the nest the wrong way round.
    Turned,
}

impl Defect {
    /// What a lot draws; a dummy is turned only where a fault asks for it.
    pub const OF_A_LOT: &'static [Self] = &[Self::Open, Self::Short, Self::WrongValue];

    /// Name in the truth.
    pub fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Short => "short",
            Self::WrongValue => "wrong_value",
            Self::Turned => "turned",
        }
    }
}

/// A dummy on the probes.
#[derive(Debug, Clone)]
pub struct Resistor {
    /// At [`REFERENCE_C`], infinite when open.
    resistance_ohm: f64,
    tcr_per_k: f64,
    celsius: f64,
    defect: Option<Defect>,
    pins: Pins,
    supply_v: f64,
}

impl OnProbes for Resistor {
    fn pins(&self) -> Pins {
        self.pins
    }

    fn input_ohm(&self) -> f64 {
        self.resistance_ohm * (1.0 + self.tcr_per_k * (self.celsius - REFERENCE_C))
    }

    fn input_a(&self) -> f64 {
        self.supply_v / self.input_ohm()
    }

    /// Without inductance no current flows into a clamp.
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
