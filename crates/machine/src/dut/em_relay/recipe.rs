//! Sections of a recipe for a relay: the device, and how to measure it.

use super::parameter::Parameter;
use super::points::AnalogIn;
use super::sampling::{CoilSampling, ContactSampling};
use super::strategy::Strategy;
use super::threshold::Direction;
use super::{card, feasible, made_up};
use crate::dut::accuracy::AccuracySettings;
use crate::dut::card::Card;
use crate::dut::device::Rig;
use crate::dut::made_up::MadeUp;
use crate::dut::recipe::{KindRecipe, Limits, PartFacts};
use crate::dut::{Calibration, Device, Kind, Recipe};
use crate::rig::fault::{Fault, Requirement};
use crate::rig::point::MissingPoint;
use crate::rig::supply::SupplyDemand;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use units::Celsius;

/// Highest voltage that the coil of a relay of this class withstands, as a multiple of the nominal voltage.
const HIGHEST_RAMP: f64 = 1.3;

/// The sections `[part]` and `[test]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RelayRecipe {
    /// The device.
    pub part: PartData,
    /// How the device is measured.
    pub test: TestPlan,
}

impl KindRecipe for RelayRecipe {
    fn kind(&self) -> Kind {
        Kind::EmRelay
    }

    fn part(&self) -> PartFacts {
        PartFacts {
            body_mm: self.part.body_mm,
            pin_length_mm: self.part.pin_length_mm,
            reference: Celsius(self.part.reference_temperature_c),
            nominal_v: Some(self.part.nominal_v),
        }
    }

    fn on_rig(
        &self,
        recipe: Arc<Recipe>,
        rig: &Rig,
        stored: Option<Calibration>,
    ) -> Result<Device, MissingPoint> {
        let stored = stored.and_then(|it| match it {
            Calibration::EmRelay(factors) => Some(*factors),
            Calibration::Thermostat(_) => None,
        });
        let device = super::Device::new(recipe, self, rig, stored)?;
        Ok(Device::EmRelay(Box::new(device)))
    }

    fn infeasible(&self, limits: &Limits, rig: &Rig) -> Vec<Fault> {
        feasible::faults(self, limits, rig)
    }

    fn demand(&self, limits: &Limits, accuracy: &AccuracySettings) -> Option<SupplyDemand> {
        Some(feasible::demand(self, limits, accuracy))
    }

    fn card(&self) -> Card {
        card::card(self)
    }

    fn made_up(&self, _limits: &Limits) -> MadeUp {
        made_up::made_up(self)
    }

    /// Checks that the expected operate threshold lies above pre-bias and expected release threshold and below the
    /// nominal voltage, and that the coarse ramp ends at a voltage that the coil withstands.
    ///
    /// # Errors
    /// Fails with the first key that breaks this order or bound.
    fn check(&self) -> Result<(), Fault> {
        let test = &self.test;
        let ordered = [
            (
                "expected_release_v",
                test.expected_release_v,
                "expected_operate_v",
                test.expected_operate_v,
            ),
            (
                "prebias_v",
                test.prebias_v,
                "expected_operate_v",
                test.expected_operate_v,
            ),
            (
                "expected_operate_v",
                test.expected_operate_v,
                "nominal_v",
                self.part.nominal_v,
            ),
        ];
        for (low, low_v, high, high_v) in ordered {
            if low_v >= high_v {
                let expected = format!("less than {high}, {high_v} V");
                let fault = Fault::new(format!("test.{low}"), low_v, expected);
                return Err(fault.requires(Requirement::Below(format!("{high_v} V"))));
            }
        }
        let most_v = HIGHEST_RAMP * self.part.nominal_v - test.prebias_v;
        if test.coarse_span_v > most_v {
            let expected = format!(
                "at most {most_v:.2} V: the ramp from test.prebias_v ends at {HIGHEST_RAMP} times nominal_v, which a coil bears"
            );
            return Err(Fault::new(
                "test.coarse_span_v",
                test.coarse_span_v,
                expected,
            ));
        }
        Ok(())
    }
}

/// Data of the device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartData {
    /// Nominal coil voltage, V.
    pub nominal_v: f64,
    /// Nominal coil resistance at the reference temperature, ohm.
    pub nominal_coil_ohm: f64,
    /// Body along x, y, z as it lies in the nest, mm.
    pub body_mm: [f64; 3],
    /// Length of the pins below the body, mm.
    pub pin_length_mm: f64,
    /// Temperature that all results are converted to, degrees Celsius.
    pub reference_temperature_c: f64,
}

/// Which channels measure the coil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CoilChannels {
    /// `coil_voltage_fine` and `coil_current_fine`.
    Fine,
    /// `coil_voltage_fine` and `coil_current`: a coil of low resistance exceeds the range of the fine current.
    CoarseCurrent,
    /// `coil_voltage_fine` and `coil_current_high`: a coil that draws too much for `coil_current` as well.
    HighCurrent,
}

impl CoilChannels {
    /// Names in recipes.
    pub const NAMES: [&'static str; 3] = ["fine", "coarse_current", "high_current"];

    /// Returns the name in recipes.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Returns the channel of the coil current.
    pub const fn current(self) -> AnalogIn {
        match self {
            Self::Fine => AnalogIn::CoilCurrentFine,
            Self::CoarseCurrent => AnalogIn::CoilCurrent,
            Self::HighCurrent => AnalogIn::CoilCurrentHigh,
        }
    }
}

/// Coil suppression: the path of the coil current after switch-off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Suppression {
    /// 60 V zener: fast release.
    Zener,
    /// Plain diode: slow release.
    Diode,
}

/// How the part is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestPlan {
    /// Number of operations before the first measurement.
    pub conditioning_operations: u32,
    /// Voltage at which the coil resistance is measured and the operate ramp starts, V.
    pub prebias_v: f64,
    /// Height of the coarse ramp, V.
    pub coarse_span_v: f64,
    /// Channels that measure the coil.
    pub coil_channels: CoilChannels,
    /// Operate threshold expected of the lot, V.
    pub expected_operate_v: f64,
    /// Standard deviation of `expected_operate_v`, V.
    pub expected_operate_sd_v: f64,
    /// Release threshold expected of the lot, V.
    pub expected_release_v: f64,
    /// Standard deviation of `expected_release_v`, V.
    pub expected_release_sd_v: f64,
    /// Coil suppression during the timed release.
    #[serde(rename = "clamp")]
    pub suppression: Suppression,
    /// How the test searches each threshold, and how it samples coil and contacts.
    #[serde(default)]
    pub strategy: Strategies,
}

/// A strategy per threshold, `coarse_fine` by default, and the sampling of coil and contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Strategies {
    /// Strategy of the operate threshold.
    pub operate_voltage_v: Strategy,
    /// Strategy of the release threshold.
    pub release_voltage_v: Strategy,
    /// Sampling of the coil resistance.
    pub coil: CoilSampling,
    /// Sampling of both contacts.
    pub contact: ContactSampling,
}

impl Strategies {
    /// Returns each threshold with its strategy.
    pub fn each(&self) -> [(Parameter, Strategy); 2] {
        [
            (Parameter::OperateVoltage, self.operate_voltage_v),
            (Parameter::ReleaseVoltage, self.release_voltage_v),
        ]
    }
}

impl TestPlan {
    /// Returns the expected threshold of the lot and its standard deviation, V.
    pub fn expected(&self, direction: Direction) -> (f64, f64) {
        match direction {
            Direction::Rising => (self.expected_operate_v, self.expected_operate_sd_v),
            Direction::Falling => (self.expected_release_v, self.expected_release_sd_v),
        }
    }
}
