//! Resistor part of a recipe: the part, and how to measure it.

use super::parameter::{BIN, Parameter};
use super::points::Points;
use super::promise::Promise;
use crate::dut::accuracy::AccuracySettings;
use crate::dut::recipe::{Body, Limits};
use crate::gauge::Limit;
use crate::rig::fault::Fault;
use crate::rig::supply::SupplyDemand;
use crate::rig::wiring::Wiring;
use serde::{Deserialize, Serialize};
use units::{Ampere, Volt};

/// The sections `[part]` and `[test]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResistorRecipe {
    /// The resistor.
    pub part: PartData,
    /// Its measurement.
    pub test: TestPlan,
}

/// Data of the part.
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

/// Measurement of the part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestPlan {
    /// Voltage across the part, V.
    pub level_v: f64,
    /// Time from the drive until a conversion may begin, ms.
    pub settles_ms: u32,
    /// Number of readings that are averaged.
    pub readings: u32,
}

impl ResistorRecipe {
    /// Returns the dimensions for the collision guard.
    pub fn body(&self) -> Body {
        Body {
            size_mm: self.part.body_mm,
            pin_length_mm: self.part.pin_length_mm,
        }
    }

    /// Checks that the rig has bin and points, that the modules reach level and current, and that the limits are wider
    /// than the guard bands.
    ///
    /// # Errors
    /// Names the first key that the rig cannot meet.
    pub fn feasible(
        &self,
        limits: &Limits,
        wiring: &Wiring,
        accuracy: &AccuracySettings,
    ) -> Result<(), Fault> {
        if !wiring.axis.has(BIN) {
            let expected = format!("a rig with the bins of this kind: rig.toml has no bin.{BIN}");
            return Err(Fault::new("kind", "\"resistor\"", expected));
        }
        let points = Points::resolve(wiring).map_err(|missing| {
            let expected = "a rig with every point that its test needs";
            Fault::new("test", missing, expected)
        })?;
        let wiring = &wiring.in_range(self.demand(limits, accuracy).range(wiring)?);
        let promise = Promise {
            accuracy: *accuracy,
            volt_per_ampere: wiring.analog_in(points.current).gain,
        };
        check_modules(wiring, &points)?;
        self.check_limit(limits.of(Parameter::Resistance), &promise)?;
        wiring
            .reaches(points.level, Volt(self.test.level_v))
            .map_err(|cannot| Fault::new("test.level_v", self.test.level_v, cannot.to_string()))
    }

    /// Returns what the test asks of the supply: the level, with the tolerance of its source, and the current of the lowest
    /// accepted resistance.
    pub fn demand(&self, limits: &Limits, accuracy: &AccuracySettings) -> SupplyDemand {
        let level_v = self.test.level_v;
        let low_ohm = limits.of(Parameter::Resistance).low;
        SupplyDemand {
            volts: Volt(level_v * (1.0 + accuracy.ao_gain_pct / 100.0)),
            volts_key: "test.level_v",
            current: Ampere(low_ohm.map_or(0.0, |ohm| level_v / ohm)),
            current_key: "limits.resistance_ohm.low",
        }
    }

    fn check_limit(&self, limit: Limit, promise: &Promise) -> Result<(), Fault> {
        if limit.is_open() {
            let expected = "a low or a high limit: nothing else is measured";
            return Err(Fault::new("limits.resistance_ohm", "neither", expected));
        }
        if let Some(low_ohm) = limit.low {
            let least_ohm = self.test.level_v / promise.most_ampere();
            if low_ohm < least_ohm {
                let expected = format!(
                    "at least {least_ohm:.1}: below it the current at test.level_v is over range"
                );
                return Err(Fault::new("limits.resistance_ohm.low", low_ohm, expected));
            }
        }
        let (Some(low_ohm), Some(high_ohm)) = (limit.low, limit.high) else {
            return Ok(());
        };
        let bands_ohm =
            promise.budget(self, low_ohm).expanded() + promise.budget(self, high_ohm).expanded();
        if high_ohm - low_ohm < bands_ohm {
            let found = format!("{low_ohm} to {high_ohm}");
            let expected = format!(
                "limits more than {bands_ohm:.3} apart: the guard bands at both ends leave nothing between"
            );
            return Err(Fault::new("limits.resistance_ohm", found, expected));
        }
        Ok(())
    }
}

/// Checks that the level steps, and that the converter reads the channel of the current.
fn check_modules(wiring: &Wiring, points: &Points) -> Result<(), Fault> {
    let source = wiring.module(wiring.analog_out(points.level).module);
    if source
        .slew
        .is_some_and(|code| code.volt_per_second().is_some())
    {
        let expected = "a supply level that steps (slew code 0)";
        return Err(Fault::new("test.level_v", &source.name, expected));
    }
    let terminal = wiring.analog_in(points.current);
    let reader = wiring.module(terminal.module);
    let masked = |mask: u8| mask >> terminal.channel.get() & 1 == 0;
    if reader.mask.is_some_and(masked) {
        let expected = "a module that converts the channel of the current";
        return Err(Fault::new("test", &reader.name, expected));
    }
    Ok(())
}
