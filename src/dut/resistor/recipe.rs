//! What a recipe says of a resistor: the part, and how it is measured.

use super::parameter::{BIN, Parameter};
use super::points::Points;
use crate::dut::recipe::{Body, Limits};
use crate::rig::fault::Fault;
use crate::rig::wiring::Wiring;
use serde::{Deserialize, Serialize};

/// The sections `[part]` and `[test]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResistorRecipe {
    /// The part.
    pub part: PartData,
    /// How it is measured.
    pub test: TestPlan,
}

/// The part itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartData {
    /// Body along x, y, z as it lies in the nest, mm.
    pub body_mm: [f64; 3],
    /// Length of the pins below the body, mm.
    pub pin_length_mm: f64,
    /// Temperature that results refer to, degrees Celsius.
    pub reference_temperature_c: f64,
    /// Temperature coefficient of the resistor, ppm/K, either sign.
    pub tcr_ppm_per_k: f64,
}

/// How the part is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestPlan {
    /// Voltage across the part, V.
    pub level_v: f64,
    /// From the drive to the instant after which a conversion may begin, ms.
    pub settles_ms: u32,
    /// Readings that are averaged.
    pub readings: u32,
}

impl ResistorRecipe {
    /// The outside of the part.
    pub fn body(&self) -> Body {
        Body {
            size_mm: self.part.body_mm,
            pin_length_mm: self.part.pin_length_mm,
        }
    }

    /// Checks that the rig has the bin and the points, and that there is a limit to judge by.
    ///
    /// # Errors
    /// Names the first key that asks for what is not there.
    pub fn feasible(&self, limits: &Limits, wiring: &Wiring) -> Result<(), Fault> {
        if !wiring.axis.has(BIN) {
            let expected = format!("a rig with the bins of this kind: rig.toml has no bin.{BIN}");
            return Err(Fault::new("kind", "\"resistor\"", expected));
        }
        Points::resolve(wiring).map_err(|missing| {
            let expected = "a rig with every point that its test needs";
            Fault::new("test", missing, expected)
        })?;
        let limit = limits.of(Parameter::Resistance);
        if limit.low.is_none() && limit.high.is_none() {
            let expected = "a low or a high limit: nothing else is measured";
            return Err(Fault::new("limits.resistance_ohm", "neither", expected));
        }
        Ok(())
    }
}
