//! Sections of a recipe for temperature relays: the part, and how a batch is tested.

use super::certificate::{self, EVERY_PART_V};
use super::points::Points;
use super::{Parameter, card, duration, feasible, made_up};
use crate::dut::card::Card;
use crate::dut::device::{Made, Rig};
use crate::dut::made_up::MadeUp;
use crate::dut::recipe::{KindRecipe, Limits, PartFacts};
use crate::dut::rejudge::UNCONVERTED;
use crate::dut::{Calibration, Device, Kind, Recipe};
use crate::gauge::Limit;
use crate::rig::fault::Fault;
use crate::rig::point::MissingPoint;
use chamber::plan::Strategy;
use chamber::program::Window;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Least rate of a slow repeat, K/min, unless the passes of the recipe are slower.
const LEAST_REPEAT: f64 = 0.5;

/// The sections `[part]` and `[test]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ThermostatRecipe {
    /// The part.
    pub part: PartData,
    /// How a batch is tested.
    pub test: TestPlan,
}

/// Data of the part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartData {
    /// Expected lag of the parts relative to the air, s.
    pub lag_s: f64,
}

/// Feedback law of the controller; all of them run with feed-forward.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Control {
    /// PID.
    #[default]
    Pid,
    /// Fuzzy table whose output changes the power.
    Fuzzy,
    /// PID whose gains a fuzzy table adjusts.
    FuzzyPid,
}

/// How a batch is tested.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestPlan {
    /// Rate of the first pass of a batch that measures the lag, K/min.
    pub learning_k_per_min: f64,
    /// Rate of the other passes, K/min.
    pub rate_k_per_min: f64,
    /// Number of passes at `rate_k_per_min` in each batch.
    pub passes: usize,
    /// Number of passes at `learning_k_per_min` before these in each batch, so that a part that scatters shows it; a batch
    /// that measures the lag has at least one.
    #[serde(default)]
    pub scatter_passes: usize,
    /// Number of batches from one that measures the lag to the next.
    pub learning_every: usize,
    /// Distance by which the windows extend beyond the limits, K.
    pub beyond_k: f64,
    /// Expanded uncertainty that temperatures must keep, K; `None` for no such claim.
    #[serde(default)]
    pub claimed_u_k: Option<f64>,
    /// Highest slope over a minute within the windows, K/min; `None` for no such limit.
    #[serde(default)]
    pub most_k_per_min: Option<f64>,
    /// Law of the feedback.
    #[serde(default)]
    pub control: Control,
}

impl TestPlan {
    /// Returns true when the passes of a batch that measures the lag have two rates; a single rate tells no lag.
    pub fn has_two_rates(&self) -> bool {
        self.learning_k_per_min != self.rate_k_per_min
    }

    /// Returns the number of passes that every batch has.
    pub fn least_passes(&self) -> usize {
        self.scatter_passes + self.passes
    }
}

impl ThermostatRecipe {
    /// Returns the windows of operate and reset temperatures in which parts are expected; `None` when a limit has an
    /// open side.
    pub fn windows(&self, limits: &Limits) -> Option<[Window; 2]> {
        let window = |limit: Limit| {
            Some(Window {
                low_c: limit.low? - self.test.beyond_k,
                high_c: limit.high? + self.test.beyond_k,
            })
        };
        let operate = window(limits.of(Parameter::Operate))?;
        Some([operate, window(limits.of(Parameter::Reset))?])
    }

    /// Returns the strategy that chooses the passes of each batch.
    pub fn strategy(&self) -> Strategy {
        let test = &self.test;
        let after = |fast: usize| {
            let fast = vec![test.learning_k_per_min; fast];
            [fast, vec![test.rate_k_per_min; test.passes]].concat()
        };
        let for_lag = usize::from(test.has_two_rates());
        Strategy {
            learning: after(test.scatter_passes.max(for_lag)),
            known: after(test.scatter_passes),
            every: test.learning_every,
            repeat: (test.rate_k_per_min / 2.0).max(LEAST_REPEAT.min(test.rate_k_per_min)),
        }
    }
}

impl KindRecipe for ThermostatRecipe {
    fn kind(&self) -> Kind {
        Kind::Thermostat
    }

    fn part(&self) -> PartFacts {
        PartFacts {
            body_mm: [0.0; 3],
            pin_length_mm: 0.0,
            reference: UNCONVERTED,
            nominal_v: None,
        }
    }

    fn on_rig(
        &self,
        recipe: Arc<Recipe>,
        rig: &Rig,
        stored: Option<Calibration>,
    ) -> Result<Device, MissingPoint> {
        let points = Points::resolve(rig.wiring)?;
        let of_rack = stored.and_then(|it| match it {
            Calibration::Thermostat(of_rack) => Some(of_rack),
            Calibration::EmRelay(_) => None,
        });
        let device = super::Device::new(recipe, self, points, *rig.accuracy);
        let device = super::Device {
            stated: rig
                .certificate
                .and_then(|it| it.chamber.as_deref().copied()),
            ..device.calibrated(of_rack)
        };
        Ok(Device::Thermostat(Box::new(device)))
    }

    fn calibrated_for(&self) -> Option<f64> {
        Some(EVERY_PART_V)
    }

    fn certified(&self, rig: &Rig, made: Made) -> Option<Calibration> {
        let of_rack = certificate::Calibration::new(rig.certificate?.clone(), made);
        Some(Calibration::Thermostat(of_rack))
    }

    fn infeasible(&self, limits: &Limits, rig: &Rig) -> Vec<Fault> {
        feasible::faults(self, limits, rig)
    }

    fn too_long(&self, limits: &Limits, slow_repeats: u32) -> Option<Fault> {
        duration::too_long(self, limits, slow_repeats)
    }

    fn card(&self) -> Card {
        card::card(self)
    }

    fn made_up(&self, limits: &Limits) -> MadeUp {
        made_up::made_up(limits)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::dut::recipe::DeviceRecipe;

    const KSD9700: &str =
        include_str!("../../../../../config/rigs/thermostat/recipes/thermostat-ksd9700.toml");

    /// Returns the rates of a batch that measures the lag and of another one, K/min.
    fn rates(scatter_passes: usize) -> [Vec<f64>; 2] {
        let recipe: Recipe = toml::from_str(KSD9700).unwrap();
        let DeviceRecipe::Thermostat(mut thermostat) = recipe.device else {
            panic!("a temperature relay");
        };
        thermostat.test.scatter_passes = scatter_passes;
        let Strategy {
            learning, known, ..
        } = thermostat.strategy();
        [learning, known]
    }

    #[test]
    fn every_batch_has_its_passes_for_scatter() {
        let fast_then_slow = vec![5.0, 5.0, 5.0, 2.0];
        assert_eq!(rates(3), [fast_then_slow.clone(), fast_then_slow]);
        assert_eq!(rates(0), [vec![5.0, 2.0], vec![2.0]]);
    }
}
