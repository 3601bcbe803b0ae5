//! A recipe of temperature relays on a rig, with what its batches have revealed about chamber and lot.

use super::certificate::{Calibration, Certificate};
use super::measure::Test;
use super::points::Points;
use super::recipe::ThermostatRecipe;
use super::response::StatedResponse;
use crate::dut::accuracy::AccuracySettings;
use crate::dut::batch::{BatchOrder, BatchTest};
use crate::dut::device::{DeviceUnderTest, TestOrder};
use crate::dut::experiment::Experiment;
use crate::dut::record::Own;
use crate::dut::{Procedure, Recipe, TestRecord};
use crate::instrument::act::Act;
use crate::rig::point::Thermometer;
use chamber::lag::LotLag;
use chamber::program::Window;
use chamber::tune::Identified;
use std::sync::Arc;
use units::{RigTime, Volt};

/// Level of an analog output for the full heater or the fully open vent, V.
pub const WHOLE_V: f64 = 10.0;
/// Lag and delay of a thermometer in moving air, s. A lot's lag counts from the reading of the thermometer.
pub const SENSOR_LAG_S: f64 = 8.0;

/// Facts about chamber and lot that a batch has revealed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lesson {
    /// Number of the batch in its run, from 1.
    pub batch: u64,
    /// Temperature of the room, C.
    pub ambient_c: f64,
    /// Identified response of the chamber to its heater.
    pub chamber: Identified,
    /// Lag of the lot; `None` until passes at two rates have shown it.
    pub lag: Option<LotLag>,
    /// Windows in which the parts have operated and reset.
    pub windows: [Window; 2],
    /// Scatter of switchings from cycle to cycle, K.
    pub scatter_k: f64,
}

/// A recipe on a rig, with what its batches have revealed so far.
#[derive(Debug, Clone)]
pub struct Device {
    /// The recipe.
    pub recipe: Arc<Recipe>,
    /// Sections of the recipe that only this kind has.
    pub thermostat: Arc<ThermostatRecipe>,
    /// Points of the chamber as this rig has wired them.
    pub points: Arc<Points>,
    /// Accuracies of the modules.
    pub accuracy: AccuracySettings,
    /// Lesson of the last complete batch; `None` before the first one.
    pub lesson: Option<Arc<Lesson>>,
    /// Certificate of thermometer chain and sockets; `None` on a rig without calibration.
    pub certificate: Option<Arc<Certificate>>,
    /// Instant at which the certificate expires, microseconds since 1970 UTC; `None` without a certificate.
    pub due_at_us: Option<i64>,
    /// Response of the chamber that the plant states; `None` when the first batch identifies it.
    pub stated: Option<StatedResponse>,
}

impl Device {
    /// Makes the device of a recipe on resolved points.
    pub fn new(
        recipe: Arc<Recipe>,
        thermostat: &ThermostatRecipe,
        points: Points,
        accuracy: AccuracySettings,
    ) -> Self {
        Self {
            recipe,
            thermostat: Arc::new(thermostat.clone()),
            points: Arc::new(points),
            accuracy,
            lesson: None,
            certificate: None,
            due_at_us: None,
            stated: None,
        }
    }

    /// Returns the device with this calibration.
    pub fn calibrated(self, calibration: Option<Calibration>) -> Self {
        let due_at_us = calibration.as_ref().map(|it| it.facts().due_at_us);
        Self {
            due_at_us,
            certificate: calibration.map(|it| Arc::new(it.certificate)),
            ..self
        }
    }

    /// Returns the acts that switch every source of heat off and set the vent, 0 to 1.
    pub fn heat_off(&self, vent: f64) -> Vec<Act> {
        let points = &self.points;
        vec![
            Act::Level(vec![
                (points.heater, Volt(0.0)),
                (points.vent, Volt(vent * WHOLE_V)),
            ]),
            Act::Set(vec![(points.contactor, false), (points.current, false)]),
        ]
    }
}

impl DeviceUnderTest for Device {
    fn begin(&self, order: &TestOrder, _now: RigTime) -> Procedure {
        panic!("a kind for a rack gets a nest: {order:?}")
    }

    fn begin_batch(&self, order: &BatchOrder, now: RigTime) -> Box<dyn BatchTest> {
        Box::new(Test::begin(self.clone(), order, now))
    }

    fn begin_experiment(&self, what: Experiment, now: RigTime) -> Box<dyn BatchTest> {
        Box::new(Test::experiment(self.clone(), what, now))
    }

    fn cooling(&self, on: bool) -> Vec<Act> {
        let mut acts = self.heat_off(if on { 1.0 } else { 0.0 });
        acts.push(Act::Set(vec![(self.points.fan, on)]));
        acts
    }

    fn air_thermometers(&self) -> Vec<Thermometer> {
        vec![self.points.reference, self.points.control]
    }

    fn hot_surfaces(&self) -> Vec<Thermometer> {
        self.points.surface.into_iter().collect()
    }

    fn due_at_us(&self) -> Option<i64> {
        self.due_at_us
    }

    fn learn(&mut self, record: &TestRecord, _pass: bool) {
        if let Own::Thermostat(lesson) = &record.own {
            self.lesson = Some(Arc::clone(lesson));
        }
    }
}
