//! A rig of the study: one drawn chamber, its identification, and batches that the machine's own code runs through it.

use super::rack::{Batch, MAP_EXCESS_K, MAP_RESIDUAL_K, Rack};
use super::world::{Kind, World};
use crate::controllers::plant::{CHAIN_K, Medium, Plant, drawn};
use anyhow::Context;
use chamber::control::split_range::Command;
use chamber::lag::Record;
use config::{Folder, Plant as Configuration, load_recipe};
use machine::dut::batch::{BatchOrder, SocketResult};
use machine::dut::device::Made;
use machine::dut::recipe::DeviceRecipe;
use machine::dut::record::Own;
use machine::dut::thermostat::Device;
use machine::dut::thermostat::certificate::{
    Calibration, Certificate, Chain, ChainPoint, SocketMap,
};
use machine::dut::thermostat::device::Lesson;
use machine::dut::thermostat::measure::{Recorded, SCATTER_K, Seen, Shown, Work, judged};
use machine::dut::thermostat::points::Points;
use rigsim::world::oven::{ChamberValues, SensorValues};
use std::sync::Arc;

/// Temperature of the air at which a batch begins, right after the one before, C.
const START_C: f64 = 45.0;
/// Highest temperature of the air in the batch before, C.
const BEFORE_C: f64 = 90.0;
/// Power of the heater on the way to [`BEFORE_C`], 1 = full heater.
const BEFORE: f64 = 0.2;
/// Temperature below which a batch ends, C.
const END_C: f64 = 54.0;
/// Time at which the mains voltage steps, s.
const MAINS_STEP_S: usize = 900;
/// Longest batch, s.
const LONGEST_S: usize = 6 * 3600;

/// A chamber with its lot.
pub struct Rig {
    kind: Kind,
    world: World,
    seed: u64,
    values: ChamberValues,
    /// Temperature of the room as the machine knows it, C.
    room_c: f64,
    sensors: [SensorValues; 2],
    /// The device that the recipe makes on a rig that has identified its chamber and tested no part of the lot.
    device: Device,
}

/// A batch that has run.
pub struct Outcome {
    /// Results, and true operate and reset temperatures, C, by socket.
    pub parts: Vec<(SocketResult, [f64; 2])>,
    /// Duration without loading, min.
    pub minutes: f64,
    /// What the machine has learned for the next batch of the lot.
    pub lesson: Arc<Lesson>,
    /// Time (min) and reading of the reference sensor (C), every ten seconds.
    pub curve: Vec<[f64; 2]>,
}

impl Rig {
    /// Draws a rig and identifies it at the mains of its world.
    ///
    /// # Errors
    /// Fails when the chamber does not respond, or the configuration does not load.
    pub fn new(kind: Kind, world: World, seed: u64) -> anyhow::Result<Self> {
        let (values, sensors) = drawn(Medium::Air, world.ambient_c, seed);
        let mut cold = Plant::new(&values, sensors, values.ambient_c, seed);
        cold.mains = world.mains;
        let device = device(kind)?;
        let windows = device.thermostat.windows(&device.recipe.limits);
        let (chamber, room_c) = cold.identify_in_room(Medium::Air)?;
        let lesson = Lesson {
            batch: 0,
            ambient_c: room_c,
            chamber,
            lag: None,
            windows: windows.context("a recipe with windows")?,
            scatter_k: SCATTER_K,
        };
        Ok(Self {
            kind,
            world,
            seed,
            values,
            room_c,
            sensors,
            device: Device {
                lesson: Some(Arc::new(lesson)),
                ..device
            },
        })
    }

    /// Runs a batch of the lot: its first one, or the one after `earlier`.
    ///
    /// # Errors
    /// Fails when the machine ends the batch early, or learns nothing.
    pub fn batch(&self, batch: &Batch, earlier: Option<&Outcome>) -> anyhow::Result<Outcome> {
        let device = self.device(batch, earlier);
        let mut running = self.started(&device, batch);
        let mut seconds = 0;
        while !running.is_over || running.plant.reference_c() > END_C {
            anyhow::ensure!(seconds < LONGEST_S, "seed {}: no end", self.seed);
            running.plant.mains = match seconds >= MAINS_STEP_S {
                true => self.world.mains_later,
                false => self.world.mains,
            };
            let at = || format!("{}, seed {}, second {seconds}", self.world.name, self.seed);
            running.second(&device).with_context(at)?;
            seconds += 1;
        }
        let results = running.judged(&device, batch.number);
        let lesson = results.first().and_then(|it| match &it.record.own {
            Own::Thermostat(lesson) => Some(Arc::clone(lesson)),
            Own::Nothing | Own::EmRelay(_) | Own::Ssr(_) => None,
        });
        let plain = running.record.filtered(0.0);
        let at = |second: usize| Some([second as f64 / 60.0, plain.at(second as f64)?.celsius]);
        Ok(Outcome {
            parts: results.into_iter().zip(running.rack.truths()).collect(),
            minutes: seconds as f64 / 60.0,
            lesson: lesson.context("a batch without parts")?,
            curve: (0..seconds).step_by(10).filter_map(at).collect(),
        })
    }

    fn started(&self, device: &Device, batch: &Batch) -> Running {
        let ambient_c = self.values.ambient_c;
        let parts_c = if self.world.warm_parts {
            START_C
        } else {
            ambient_c
        };
        let lot = (self.kind, &self.world, self.seed);
        Running {
            room_c: self.room_c,
            plant: self.warm(self.seed ^ (batch.number << 32)),
            rack: Rack::new(lot, batch, [parts_c, START_C], ambient_c),
            record: Record::new(0.0, self.room_c),
            work: Work::new(device, false, self.room_c, START_C),
            is_over: false,
        }
    }

    /// Returns the chamber right after a batch: its walls and insulation have kept some of the heat.
    fn warm(&self, noise_seed: u64) -> Plant {
        let mut plant = Plant::new(
            &self.values,
            self.sensors,
            self.values.ambient_c,
            noise_seed,
        );
        let heating = Command {
            heater: BEFORE,
            vent: 0.0,
        };
        while plant.reference_c() < BEFORE_C {
            plant.step(heating);
        }
        while plant.reference_c() > START_C {
            plant.step(COOLING);
        }
        plant
    }

    /// Returns the device with the rates of a batch and the lesson of an earlier one.
    fn device(&self, batch: &Batch, earlier: Option<&Outcome>) -> Device {
        let mut device = self.device.clone();
        let test = &mut Arc::make_mut(&mut device.thermostat).test;
        [test.learning_k_per_min, test.rate_k_per_min] = batch.rates;
        test.control = batch.control;
        if let Some(earlier) = earlier {
            device.lesson = Some(Arc::clone(&earlier.lesson));
        }
        device
    }
}

/// Command after the last pass, as the machine cools its rack.
const COOLING: Command = Command {
    heater: 0.0,
    vent: 1.0,
};

/// A batch under way.
struct Running {
    room_c: f64,
    plant: Plant,
    rack: Rack,
    record: Record,
    work: Work,
    /// True after the last pass, while the chamber cools.
    is_over: bool,
}

impl Running {
    /// Runs one second of the batch.
    fn second(&mut self, device: &Device) -> anyhow::Result<()> {
        self.record.push(self.plant.reference_c());
        let command = match self.is_over {
            true => None,
            false => self.passes(device)?,
        };
        self.is_over = command.is_none();
        let rack = &mut self.rack;
        self.plant
            .step_with(command.unwrap_or(COOLING), |dt_s, now| {
                rack.step(dt_s, now.air_c);
            });
        Ok(())
    }

    fn passes(&mut self, device: &Device) -> anyhow::Result<Option<Command>> {
        let seen = Seen {
            control_c: Some(self.plant.seen().measured_c),
            reference_c: Some(self.plant.reference_c()),
            ambient_c: self.room_c,
            waiting: self.rack.waiting(),
        };
        let shown: &dyn Fn() -> Vec<Shown> = &|| self.rack.shown();
        let next = self.work.step(device, None, &seen, (&self.record, shown));
        next.map_err(|it| anyhow::anyhow!("{it:?}"))
    }

    fn judged(&self, device: &Device, number: u64) -> Vec<SocketResult> {
        let shown = self.rack.shown();
        let order = BatchOrder {
            sockets: shown.iter().map(|it| it.socket).collect(),
            number: number + 1,
        };
        let recorded = Recorded {
            record: &self.record,
            cold_open: vec![false; shown.len()],
            events: shown.into_iter().map(|it| it.events).collect(),
            drops: &[],
            pulses: &[],
            ambient_c: self.room_c,
            last: None,
        };
        judged(device, &order, &recorded, Some(&self.work))
    }
}

/// Makes the device of the recipe on the rig that comes with the program, without confirmation measurements and without
/// the passes that show scatter. In its calibration, measuring chain and sockets need no correction; their
/// uncertainties are those with which the study draws their errors.
fn device(kind: Kind) -> anyhow::Result<Device> {
    let folder = Folder::built_in_rig("thermostat").context("a rig that comes with the program")?;
    let plant = Configuration::load(&folder)?;
    let mut recipe = load_recipe(&folder, kind.recipe)?;
    recipe.decision.slow_repeats = 0;
    let DeviceRecipe::Thermostat(thermostat) = recipe.device.clone() else {
        anyhow::bail!("{} is no temperature relay", kind.recipe);
    };
    let mut thermostat = thermostat;
    thermostat.test.scatter_passes = 0;
    let points = Points::resolve(&plant.wiring)?;
    let device = Device::new(Arc::new(recipe), &thermostat, points, plant.accuracy);
    let right = |it| ChainPoint {
        reading_c: it,
        true_c: it,
    };
    let certificate = Certificate {
        issued: String::new(),
        chain: Chain {
            points: [0.0, 100.0].map(right).into(),
            u_k: CHAIN_K,
        },
        map: SocketMap {
            excess_k: MAP_EXCESS_K,
            offset_k: Vec::new(),
            u_k: MAP_RESIDUAL_K,
        },
        chamber: None,
    };
    let made = Made {
        at_us: 0,
        valid_us: 0,
        simulated: true,
    };
    Ok(device.calibrated(Some(Calibration::new(certificate, made))))
}
