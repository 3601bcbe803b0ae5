//! A recipe: what a part is, what is demanded of it, and how it is measured.
//!
//! One file of `config/recipes/` each. The text it was read from stays with it, with its SHA-256, so that
//! a lot can store the very recipe it was judged by.

use super::em_relay::parameter::Parameter;
use super::em_relay::sampling::{CoilSampling, ContactSampling};
use super::em_relay::strategy::Strategy;
use crate::rig::fault::Fault;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What kind of relay a recipe describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Electromagnetic relay: coil, armature, changeover contact.
    EmRelay,
}

/// The part itself.
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

/// Limits of one parameter in its own unit, inclusive; a missing side is not judged.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Limit {
    /// Least good value.
    pub low: Option<f64>,
    /// Greatest good value.
    pub high: Option<f64>,
}

/// The limits of a recipe by parameter.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Limits(BTreeMap<Parameter, Limit>);

impl Limits {
    /// The limits of a parameter; both sides open when the recipe names none.
    pub fn of(&self, parameter: Parameter) -> Limit {
        self.0.get(&parameter).copied().unwrap_or_default()
    }

    /// Every parameter with its limits, in the order of [`Parameter::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Parameter, Limit)> + '_ {
        Parameter::ALL
            .into_iter()
            .map(|parameter| (parameter, self.of(parameter)))
    }
}

/// How the uncertainty enters a decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// The limit is moved inwards by the expanded uncertainty (k = 2).
    GuardBand,
    /// The bare value is compared.
    Simple,
}

/// How results become verdicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Decision {
    /// How the uncertainty enters.
    pub rule: Rule,
    /// Readings of the slow strategy for a result inside the guard band.
    pub slow_repeats: u32,
}

/// Which channels measure the coil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CoilChannels {
    /// `coil_voltage_fine` and `coil_current_fine`.
    Fine,
    /// `coil_voltage_fine` and `coil_current`: a coil of low resistance draws too much for the fine current.
    CoarseCurrent,
}

/// What takes the coil's energy at switching off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Clamp {
    /// 60 V zener: quick release.
    Zener,
    /// Plain diode: slow release.
    Diode,
}

/// How the part is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestPlan {
    /// Operations before the first measurement.
    pub conditioning_operations: u32,
    /// Coil resistance is measured here and the operate ramp starts here, V.
    pub prebias_v: f64,
    /// Height of the coarse ramp, V.
    pub coarse_span_v: f64,
    /// Which channels measure the coil.
    pub coil_channels: CoilChannels,
    /// Operate threshold expected of the lot, V.
    pub expected_operate_v: f64,
    /// Its standard deviation, V.
    pub expected_operate_sd_v: f64,
    /// Release threshold expected of the lot, V.
    pub expected_release_v: f64,
    /// Its standard deviation, V.
    pub expected_release_sd_v: f64,
    /// Coil suppression during the timed release.
    pub clamp: Clamp,
    /// How the thresholds are found.
    #[serde(default)]
    pub strategy: Strategies,
}

/// A strategy per threshold, one that is not named is `coarse_fine`; and how often the rest is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Strategies {
    /// Of the operate threshold.
    pub operate_voltage_v: Strategy,
    /// Of the release threshold.
    pub release_voltage_v: Strategy,
    /// Of the coil resistance.
    pub coil: CoilSampling,
    /// Of both contacts.
    pub contact: ContactSampling,
}

impl Strategies {
    /// Each threshold with its own.
    pub fn each(&self) -> [(Parameter, Strategy); 2] {
        [
            (Parameter::OperateVoltage, self.operate_voltage_v),
            (Parameter::ReleaseVoltage, self.release_voltage_v),
        ]
    }
}

/// A checked recipe with the text it came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Its name, equal to the name of its file.
    pub name: String,
    /// Kind of relay.
    pub kind: Kind,
    /// Title in English.
    pub title_en: String,
    /// Title in Chinese.
    pub title_zh: String,
    /// The part.
    pub part: PartData,
    /// What is demanded of it.
    pub limits: Limits,
    /// How results become verdicts.
    pub decision: Decision,
    /// How it is measured.
    pub test: TestPlan,
    /// The file, byte for byte.
    #[serde(default)]
    pub source_text: String,
    /// SHA-256 of the file, lower-case hexadecimal.
    #[serde(default)]
    pub hash: String,
}

impl Recipe {
    /// Refuses what contradicts itself: a limit whose low side is above its high side, a pre-bias at which the relay would already operate, an operate
    /// threshold expected below release.
    pub fn check(&self) -> Result<(), Fault> {
        for (parameter, limit) in &self.limits.0 {
            check_limit(&format!("limits.{parameter}"), *limit)?;
        }
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
                return Err(Fault::new(format!("test.{low}"), low_v, expected));
            }
        }
        Ok(())
    }
}

fn check_limit(key: &str, limit: Limit) -> Result<(), Fault> {
    match (limit.low, limit.high) {
        (Some(low), Some(high)) if low > high => Err(Fault::new(
            format!("{key}.low"),
            low,
            format!("at most high, which is {high}"),
        )),
        (Some(_) | None, Some(_) | None) => Ok(()),
    }
}
