//! Sections of a recipe for a resistor: the part, and how to measure it.

use super::accuracy::ChannelAccuracy;
use super::parameter::Parameter;
use super::points::Points;
use super::{card, made_up};
use crate::dut::accuracy::AccuracySettings;
use crate::dut::card::Card;
use crate::dut::device::Rig;
use crate::dut::made_up::MadeUp;
use crate::dut::recipe::{KindRecipe, Limits, PartFacts};
use crate::dut::{Calibration, Device, Kind, Recipe};
use crate::gauge::Limit;
use crate::rig::fault::Fault;
use crate::rig::point::MissingPoint;
use crate::rig::supply::SupplyDemand;
use crate::rig::wiring::Wiring;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use units::{Ampere, Celsius, Volt};

/// The sections `[part]` and `[test]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResistorRecipe {
    /// The resistor.
    pub part: PartData,
    /// How the resistor is measured.
    pub test: TestPlan,
}

/// Data of the part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartData {
    /// Body along x, y, z as it lies in the nest, mm.
    pub body_mm: [f64; 3],
    /// Length of the pins below the body, mm.
    pub pin_length_mm: f64,
    /// Temperature to which results are converted, degrees Celsius.
    pub reference_temperature_c: f64,
    /// Temperature coefficient of the resistor, ppm/K, either sign.
    pub tcr_ppm_per_k: f64,
}

/// How the part is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestPlan {
    /// Voltage of the supply across part and probes, V.
    pub level_v: f64,
    /// Time from switching the drive on until a conversion may begin, ms.
    pub settles_ms: u32,
    /// Number of readings that are averaged.
    pub readings: u32,
}

impl KindRecipe for ResistorRecipe {
    fn kind(&self) -> Kind {
        Kind::Resistor
    }

    fn part(&self) -> PartFacts {
        PartFacts {
            body_mm: self.part.body_mm,
            pin_length_mm: self.part.pin_length_mm,
            reference: Celsius(self.part.reference_temperature_c),
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
        Ok(Device::Resistor(Box::new(device)))
    }

    fn infeasible(&self, limits: &Limits, rig: &Rig) -> Vec<Fault> {
        let demand = self.demand(limits, rig.accuracy);
        let points = Points::resolve(rig.wiring);
        let (wiring, points) = match Kind::Resistor.reach(rig, points, demand.as_ref()) {
            Ok(reach) => reach,
            Err(fault) => return vec![fault],
        };
        let channel = ChannelAccuracy {
            accuracy: *rig.accuracy,
            volt_per_ampere: wiring.analog_in(points.current).gain,
        };
        let level = wiring
            .reaches(points.level, Volt(self.test.level_v))
            .map_err(|cannot| Fault::new("test.level_v", self.test.level_v, cannot.to_string()));
        [
            check_modules(&wiring, &points),
            self.check_limit(limits.of(Parameter::Resistance), &channel),
            level,
        ]
        .into_iter()
        .filter_map(Result::err)
        .collect()
    }

    fn demand(&self, limits: &Limits, accuracy: &AccuracySettings) -> Option<SupplyDemand> {
        let level_v = self.test.level_v;
        let low_ohm = limits.of(Parameter::Resistance).low;
        Some(SupplyDemand {
            volts: Volt(level_v * (1.0 + accuracy.ao_gain_pct / 100.0)),
            volts_key: "test.level_v",
            current: Ampere(low_ohm.map_or(0.0, |ohm| level_v / ohm)),
            current_key: "limits.resistance_ohm.low",
        })
    }

    fn card(&self) -> Card {
        card::card(self)
    }

    fn made_up(&self, limits: &Limits) -> MadeUp {
        made_up::made_up(limits)
    }
}

impl ResistorRecipe {
    fn check_limit(&self, limit: Limit, channel: &ChannelAccuracy) -> Result<(), Fault> {
        if limit.is_open() {
            let expected = "a low or a high limit: nothing else is measured";
            return Err(Fault::new("limits.resistance_ohm", "neither", expected));
        }
        if let Some(low_ohm) = limit.low {
            let least_ohm = self.test.level_v / channel.most_ampere();
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
            channel.budget(self, low_ohm).expanded() + channel.budget(self, high_ohm).expanded();
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

/// Checks that the level output steps instead of ramping, and that the converter reads the channel of the current.
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
