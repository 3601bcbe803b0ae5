//! A recipe: what a part is, what is demanded of it, and how it is measured.
//!
//! One file of `config/recipes/` each. The text it was read from stays with it, with its SHA-256, so that
//! a lot can store the very recipe it was judged by.

use super::Kind;
use super::accuracy::AccuracySettings;
use super::characteristic::Characteristic;
use super::em_relay;
use super::em_relay::recipe::RelayRecipe;
use super::em_relay::settings::{ReferenceSet, ReferenceSettings};
use super::resistor::recipe::ResistorRecipe;
use crate::gauge::{Limit, Rule};
use crate::rig::fault::Fault;
use crate::rig::wiring::Wiring;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The limits of a recipe by characteristic, whose key says the unit.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Limits(BTreeMap<Characteristic, Ends>);

/// As written in a recipe: bare numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Ends {
    low: Option<f64>,
    high: Option<f64>,
}

impl Limits {
    /// The limits of a characteristic in its unit; both sides open when the recipe names none.
    pub fn of(&self, characteristic: impl Into<Characteristic>) -> Limit {
        let characteristic = characteristic.into();
        let Ends { low, high } = self.0.get(&characteristic).copied().unwrap_or_default();
        let unit = characteristic.unit();
        Limit { unit, low, high }
    }

    /// Every limit that the recipe names.
    pub fn named(&self) -> impl Iterator<Item = (Characteristic, Limit)> + '_ {
        self.0
            .keys()
            .map(|characteristic| (*characteristic, self.of(*characteristic)))
    }
}

/// How results become verdicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Decision {
    /// How the uncertainty enters.
    pub rule: Rule,
    /// Readings of confirmation measurements for a result inside the guard band.
    pub slow_repeats: u32,
}

/// Sections of a recipe that belong to the kind: the part, and how to measure it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum DeviceRecipe {
    /// Electromagnetic relay.
    EmRelay(RelayRecipe),
    /// Resistor.
    Resistor(ResistorRecipe),
}

/// Outside of a part as it lies in the nest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Body along x, y, z, mm.
    pub size_mm: [f64; 3],
    /// Length of the pins below the body, mm.
    pub pin_length_mm: f64,
}

/// A checked recipe with the text it came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Its name, equal to the name of its file.
    pub name: String,
    /// Title in English.
    pub title_en: String,
    /// Title in Chinese.
    pub title_zh: String,
    /// What is demanded of the part.
    pub limits: Limits,
    /// How results become verdicts.
    pub decision: Decision,
    /// The part and how it is measured, by kind.
    #[serde(flatten)]
    pub device: DeviceRecipe,
    /// The file, byte for byte.
    #[serde(default)]
    pub source_text: String,
    /// SHA-256 of the file, lower-case hexadecimal.
    #[serde(default)]
    pub hash: String,
}

impl Recipe {
    /// The kind of device it describes.
    pub fn kind(&self) -> Kind {
        match self.device {
            DeviceRecipe::EmRelay(_) => Kind::EmRelay,
            DeviceRecipe::Resistor(_) => Kind::Resistor,
        }
    }

    /// The outside of the part.
    pub fn body(&self) -> Body {
        match &self.device {
            DeviceRecipe::EmRelay(relay) => relay.part.body(),
            DeviceRecipe::Resistor(resistor) => resistor.body(),
        }
    }

    /// Nominal voltage that a calibration and its reference parts must share with the recipe, V; none for a kind that needs
    /// neither.
    pub fn rated_v(&self) -> Option<f64> {
        match &self.device {
            DeviceRecipe::EmRelay(relay) => Some(relay.part.nominal_v),
            DeviceRecipe::Resistor(_) => None,
        }
    }

    /// Temperature that results are converted to, degrees Celsius.
    pub fn reference_temperature_c(&self) -> f64 {
        match &self.device {
            DeviceRecipe::EmRelay(relay) => relay.part.reference_temperature_c,
            DeviceRecipe::Resistor(resistor) => resistor.part.reference_temperature_c,
        }
    }

    /// Every characteristic of the kind with its limit, in the order of reports.
    pub fn limits(&self) -> impl Iterator<Item = (Characteristic, Limit)> + '_ {
        let all = self.kind().characteristics().into_iter();
        all.map(|characteristic| (characteristic, self.limits.of(characteristic)))
    }

    /// Checks that the recipe does not contradict itself.
    ///
    /// # Errors
    /// Names the first key whose value contradicts another one: a low limit above its high one, or what the kind refuses.
    pub fn check(&self) -> Result<(), Fault> {
        for (characteristic, limit) in self.limits.named() {
            check_limit(&format!("limits.{characteristic}"), limit)?;
        }
        match &self.device {
            DeviceRecipe::EmRelay(relay) => relay.check(),
            DeviceRecipe::Resistor(_) => Ok(()),
        }
    }

    /// Checks that the rig has the references and reference parts of the kind.
    ///
    /// # Errors
    /// Names the section or the key of `rig.toml` that is missing.
    pub fn referenced(
        &self,
        board: Option<&ReferenceSettings>,
        parts: &ReferenceSet,
    ) -> Result<(), Fault> {
        match &self.device {
            DeviceRecipe::EmRelay(relay) => {
                em_relay::feasible::check_references(relay.part.nominal_v, board, parts)
            }
            DeviceRecipe::Resistor(_) => Ok(()),
        }
    }

    /// Checks that the modules of this rig can perform the recipe, and that their uncertainty leaves something to judge.
    ///
    /// # Errors
    /// Names the first key that asks too much and the module that stands against it.
    pub fn feasible(&self, wiring: &Wiring, accuracy: &AccuracySettings) -> Result<(), Fault> {
        match &self.device {
            DeviceRecipe::EmRelay(relay) => {
                em_relay::feasible::check(relay, &self.limits, wiring, accuracy)
            }
            DeviceRecipe::Resistor(resistor) => resistor.feasible(&self.limits, wiring, accuracy),
        }
    }

    /// Returns the wiring in the smallest range of the supply that serves the recipe, which must be [feasible](Self::feasible).
    ///
    /// # Errors
    /// Names the key that asks more of the supply than any range gives.
    pub fn wired(&self, wiring: &Wiring, accuracy: &AccuracySettings) -> Result<Wiring, Fault> {
        let demand = match &self.device {
            DeviceRecipe::EmRelay(relay) => {
                em_relay::feasible::demand(relay, &self.limits, accuracy)
            }
            DeviceRecipe::Resistor(resistor) => resistor.demand(&self.limits, accuracy),
        };
        Ok(wiring.in_range(demand.range(wiring)?))
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
