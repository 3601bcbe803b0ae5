//! Solid-state relay part of a recipe: the part, and how to measure it.

use super::feasible;
use super::parameter::Parameter;
use super::{card, made_up};
use crate::dut::card::Card;
use crate::dut::device::Rig;
use crate::dut::made_up::MadeUp;
use crate::dut::recipe::{KindRecipe, Limits, PartFacts};
use crate::dut::rejudge::UNCONVERTED;
use crate::dut::{Calibration, Device, Kind, Recipe};
use crate::rig::fault::Fault;
use crate::rig::point::MissingPoint;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The sections `[part]` and `[test]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SsrRecipe {
    /// The part.
    pub part: PartData,
    /// How the part is measured.
    pub test: TestPlan,
}

/// What the output switches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Output {
    /// A DC load, with MOSFETs.
    Dc,
    /// An AC load, with turn-on at the zero crossing of the mains.
    AcZeroCross,
    /// An AC load, with turn-on at any phase.
    AcRandom,
}

impl Output {
    /// Returns true when an output of this kind has the characteristic.
    pub const fn has(self, parameter: Parameter) -> bool {
        match self {
            Self::Dc => parameter.is_of_dc(),
            Self::AcZeroCross => parameter.is_of_ac(true),
            Self::AcRandom => parameter.is_of_ac(false),
        }
    }

    /// Returns the name in recipes.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dc => "dc",
            Self::AcZeroCross => "ac_zero_cross",
            Self::AcRandom => "ac_random",
        }
    }
}

/// Data of the part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartData {
    /// Body along x, y, z as it lies in the nest, mm.
    pub body_mm: [f64; 3],
    /// Length of the pins below the body, mm.
    pub pin_length_mm: f64,
    /// What the output switches.
    pub output: Output,
    /// Nominal control voltage, V.
    pub control_v: f64,
    /// Voltage of the blocked output, V.
    pub rated_v: f64,
    /// Current of the conducting output, A.
    pub rated_a: f64,
    /// True when the output conducts when reversed.
    #[serde(default)]
    pub body_diode: bool,
    /// AC parts: voltage of the mains in the test, rms, V.
    #[serde(default = "mains_v")]
    pub mains_v: f64,
    /// AC parts: frequency of the mains in the test, Hz.
    #[serde(default = "mains_hz")]
    pub mains_hz: f64,
    /// AC parts: least load current at which the output works, rms, A.
    #[serde(default = "least_a")]
    pub least_a: f64,
}

fn mains_v() -> f64 {
    230.0
}

fn mains_hz() -> f64 {
    50.0
}

fn least_a() -> f64 {
    0.04
}

/// Method for the turn-on and turn-off voltages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Tests whether the output switches at both limits.
    Conformity,
    /// Tests the limits like `Conformity`, then finds both voltages by a ramp each; DC parts only.
    Ramp,
    /// Tests the limits like `Conformity`, then searches both voltages.
    Bisect,
}

fn phases() -> u32 {
    6
}

/// How the part is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestPlan {
    /// Method for the turn-on and turn-off voltages.
    pub method: Method,
    /// Width of the interval at which a search ends, mV.
    pub resolution_mv: f64,
    /// AC parts: number of pulses in the train, each at another phase of the mains.
    #[serde(default = "phases")]
    pub phases: u32,
    /// AC parts: number of parts of a lot of which the test measures the sampled characteristics; of all parts when
    /// absent.
    #[serde(default)]
    pub sampling: Option<u32>,
    /// Number of parts of a lot whose thresholds a search finds; `None` for all parts.
    #[serde(default)]
    pub searched: Option<u32>,
    /// Longest time constant of the output, ms.
    pub time_constant_ms: f64,
    /// Voltage at the reversed control input, V.
    pub reverse_v: f64,
}

impl KindRecipe for SsrRecipe {
    fn kind(&self) -> Kind {
        Kind::Ssr
    }

    fn part(&self) -> PartFacts {
        PartFacts {
            body_mm: self.part.body_mm,
            pin_length_mm: self.part.pin_length_mm,
            reference: UNCONVERTED,
            nominal_v: None,
        }
    }

    fn on_rig(
        &self,
        recipe: Arc<Recipe>,
        rig: &Rig,
        _stored: Option<Calibration>,
    ) -> Result<Device, MissingPoint> {
        let device = super::Device::new(recipe, self, rig)?;
        Ok(Device::Ssr(Box::new(device)))
    }

    fn infeasible(&self, limits: &Limits, rig: &Rig) -> Vec<Fault> {
        feasible::infeasible(self, limits, rig)
    }

    fn card(&self) -> Card {
        card::card(self)
    }

    fn made_up(&self, limits: &Limits) -> MadeUp {
        made_up::made_up(self, limits)
    }
}
