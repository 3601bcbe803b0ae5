//! A recipe: what a part is, which limits it must keep, and how it is measured.
//!
//! Each file of `config/recipes/` is one recipe. [`Recipe`] keeps the text of its file and the SHA-256 of that text, so
//! that a lot can store exactly the recipe that judged it.

use super::accuracy::AccuracySettings;
use super::card::Card;
use super::characteristic::Characteristic;
use super::device::{Made, Rig};
use super::em_relay::recipe::RelayRecipe;
use super::external::ExternalLimits;
use super::made_up::MadeUp;
use super::prompt::{self, Prompt};
use super::resistor::recipe::ResistorRecipe;
use super::ssr::recipe::SsrRecipe;
use super::thermostat::recipe::ThermostatRecipe;
use super::{Calibration, Device, Kind};
use crate::gauge::{Limit, Rule};
use crate::rig::fault::{Fault, Requirement};
use crate::rig::point::MissingPoint;
use crate::rig::supply::SupplyDemand;
use crate::rig::wiring::Wiring;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Deref;
use std::sync::Arc;
use units::Celsius;

impl Kind {
    /// Returns the wiring in the supply range that serves `demand`, if there is one, and the points of the kind.
    ///
    /// # Errors
    /// Fails on a rig without a feeder, else with the first bin, point or range that the rig does not have.
    pub(super) fn reach<P>(
        self,
        rig: &Rig,
        points: Result<P, MissingPoint>,
        demand: Option<&SupplyDemand>,
    ) -> Result<(Wiring, P), Fault> {
        let wiring = rig.wiring;
        let definition = self.definition();
        if wiring.feeder().is_none() {
            let found = format!("\"{}\"", definition.name);
            let expected = "a rig with a feeder: rig.toml has [rack]";
            return Err(Fault::new("kind", found, expected));
        }
        if let Some(missing) = definition.bins.iter().find(|bin| !wiring.has_bin(**bin)) {
            let found = format!("\"{}\"", definition.name);
            let expected =
                format!("a rig with the bins of this kind: rig.toml has no bin.{missing}");
            return Err(Fault::new("kind", found, expected));
        }
        let points = points.map_err(|missing| {
            let expected = "a rig with every point that its test needs";
            Fault::new("test", missing, expected)
        })?;
        let Some(demand) = demand else {
            return Ok((wiring.clone(), points));
        };
        let range = demand.range(wiring)?;
        Ok((wiring.in_range(range), points))
    }
}

/// The limits of a recipe, by characteristic, in the unit that the key of the characteristic states.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Limits(BTreeMap<Characteristic, Ends>);

/// Ends of a limit as written in a recipe: bare numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Ends {
    pub low: Option<f64>,
    pub high: Option<f64>,
}

impl Limits {
    /// Returns the limit of a characteristic in its unit; both sides are open if the recipe has none.
    pub fn of(&self, characteristic: impl Into<Characteristic>) -> Limit {
        let characteristic = characteristic.into();
        let Ends { low, high } = self.0.get(&characteristic).copied().unwrap_or_default();
        let unit = characteristic.unit();
        Limit { unit, low, high }
    }

    /// Returns every limit that the recipe contains.
    pub fn named(&self) -> impl Iterator<Item = (Characteristic, Limit)> + '_ {
        self.0
            .keys()
            .map(|characteristic| (*characteristic, self.of(*characteristic)))
    }
}

/// How results become verdicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Decision {
    /// How the uncertainty enters the decision.
    pub rule: Rule,
    /// Number of confirmation measurements for a result inside the guard band.
    pub slow_repeats: u32,
}

/// Sections of a recipe that belong to the kind: what the part is, and how to measure it.
pub trait KindRecipe {
    /// Returns the kind of device that the sections describe.
    fn kind(&self) -> Kind;

    /// Returns the data that parts of every kind have.
    fn part(&self) -> PartFacts;

    /// Makes the device from `recipe`, which contains these sections, on a rig; uses the `stored` calibration if there
    /// is one.
    ///
    /// # Errors
    /// Fails with the first point of the kind that the rig does not have.
    fn on_rig(
        &self,
        recipe: Arc<Recipe>,
        rig: &Rig,
        stored: Option<Calibration>,
    ) -> Result<Device, MissingPoint>;

    /// Returns the voltage by which a calibration for these parts is stored, V; `None` for parts that need none.
    fn calibrated_for(&self) -> Option<f64> {
        self.part().nominal_v
    }

    /// Returns the calibration that certificates of the plant alone give, without any part; `None` for a kind that is
    /// calibrated on parts, or without a certificate.
    fn certified(&self, _rig: &Rig, _made: Made) -> Option<Calibration> {
        None
    }

    /// Returns every reason why the rig cannot perform the recipe: points, bins and references that `rig.toml` lacks,
    /// keys that ask too much of a module, limits beyond the reach of the test or closer than its uncertainty.
    fn infeasible(&self, limits: &Limits, rig: &Rig) -> Vec<Fault>;

    /// Returns the fault of a test that takes too long with this number of slow repeats; `None` for a kind whose parts
    /// take seconds.
    fn too_long(&self, _limits: &Limits, _slow_repeats: u32) -> Option<Fault> {
        None
    }

    /// Returns the demand of the test on the supply; none for a test that uses no supply.
    fn demand(&self, _limits: &Limits, _accuracy: &AccuracySettings) -> Option<SupplyDemand> {
        None
    }

    /// Returns the process card.
    fn card(&self) -> Card;

    /// Returns the statistics of made-up parts.
    fn made_up(&self, limits: &Limits) -> MadeUp;

    /// Checks that the sections do not contradict themselves.
    ///
    /// # Errors
    /// Fails with the first key whose value contradicts another one.
    fn check(&self) -> Result<(), Fault> {
        Ok(())
    }
}

/// Sections of a recipe that belong to its kind of device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum DeviceRecipe {
    /// Electromagnetic relay.
    EmRelay(RelayRecipe),
    /// Resistor.
    Resistor(ResistorRecipe),
    /// Solid-state relay.
    Ssr(SsrRecipe),
    /// Temperature relay.
    Thermostat(ThermostatRecipe),
}

impl Deref for DeviceRecipe {
    type Target = dyn KindRecipe;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::EmRelay(relay) => relay,
            Self::Resistor(resistor) => resistor,
            Self::Ssr(ssr) => ssr,
            Self::Thermostat(thermostat) => thermostat,
        }
    }
}

/// Data that parts of every kind have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartFacts {
    /// Body along x, y, z as it lies in the nest, mm.
    pub body_mm: [f64; 3],
    /// Length of the pins below the body, mm.
    pub pin_length_mm: f64,
    /// Temperature to which results are converted.
    pub reference: Celsius,
    /// Nominal voltage that a calibration and its reference parts must share with the part, V; `None` for a kind that
    /// needs neither.
    pub nominal_v: Option<f64>,
}

/// A checked recipe with the text of its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Name of the recipe, equal to the name of its file.
    pub name: String,
    /// Title in English.
    pub title_en: String,
    /// Title in Chinese.
    pub title_zh: String,
    /// Limits that the part must keep.
    pub limits: Limits,
    /// Limits of results from outside of the rig that every lot needs; the test does not measure them.
    #[serde(default, skip_serializing_if = "ExternalLimits::is_empty")]
    pub external: ExternalLimits,
    /// How results become verdicts.
    pub decision: Decision,
    /// Prompts that a person must answer during a lot.
    #[serde(rename = "prompt", default)]
    pub prompts: Vec<Prompt>,
    /// Sections of the kind: the part, and how it is measured.
    #[serde(flatten)]
    pub device: DeviceRecipe,
    /// The text of the file, byte for byte.
    #[serde(default)]
    pub source_text: String,
    /// SHA-256 of the file, lower-case hexadecimal.
    #[serde(default)]
    pub hash: String,
}

impl Recipe {
    /// Returns every characteristic of the kind with its limit, in the order of reports.
    pub fn limits(&self) -> impl Iterator<Item = (Characteristic, Limit)> + '_ {
        let all = self.device.kind().characteristics().into_iter();
        all.map(|characteristic| (characteristic, self.limits.of(characteristic)))
    }

    /// Checks that the recipe does not contradict itself.
    ///
    /// # Errors
    /// Fails with the first key whose value contradicts another one: a low limit above its high one, or a value that
    /// the kind refuses.
    pub fn check(&self) -> Result<(), Fault> {
        for (characteristic, limit) in self.limits.named() {
            check_limit(&format!("limits.{characteristic}"), limit)?;
        }
        prompt::check(&self.prompts)?;
        self.device.check()
    }

    /// Returns every reason why a rig cannot perform the recipe, each with its key; empty for a feasible recipe.
    pub fn infeasible(&self, rig: &Rig) -> Vec<Fault> {
        let mut faults = self.device.infeasible(&self.limits, rig);
        let repeats = self.decision.slow_repeats;
        faults.extend(self.device.too_long(&self.limits, repeats));
        faults
    }

    /// Returns the wiring in the smallest supply range that serves the recipe. The recipe must not be
    /// [infeasible](Self::infeasible); unchanged for a recipe that uses no supply.
    ///
    /// # Errors
    /// Fails with the key that asks more of the supply than any range gives.
    pub fn wired(&self, wiring: &Wiring, accuracy: &AccuracySettings) -> Result<Wiring, Fault> {
        match self.device.demand(&self.limits, accuracy) {
            Some(demand) => Ok(wiring.in_range(demand.range(wiring)?)),
            None => Ok(wiring.clone()),
        }
    }
}

fn check_limit(key: &str, limit: Limit) -> Result<(), Fault> {
    match (limit.low, limit.high) {
        (Some(low), Some(high)) if low > high => Err(Fault::new(
            format!("{key}.low"),
            low,
            format!("at most high, which is {high}"),
        )
        .requires(Requirement::AtMostHigh(high.to_string()))),
        (Some(_) | None, Some(_) | None) => Ok(()),
    }
}
