//! A rig of the study: one drawn chamber, its identification, and batches that run through it.

use super::rack::{Batch, Lot, Part, Rack};
use super::world::{Kind, SCATTER_K, World};
use crate::controllers::plant::{Medium, Plant, drawn};
use anyhow::Context;
use chamber::control::Controller;
use chamber::lag::{Estimate, LotLag, Noise, Record, Switching, estimate, lot_lag, lot_scatter};
use chamber::plan::narrowed;
use chamber::program::{Phase, Program, Waiting, Window};
use chamber::tune::Identified;
use rigsim::world::oven::{ChamberValues, SensorValues};

/// Temperature of the chamber at which a batch begins, right after the one before, C.
const START_C: f64 = 45.0;
/// Temperature below which a batch ends, C.
const END_C: f64 = 54.0;
/// Temperature for which the set point heads after the last pass, C.
const UNLOAD_C: f64 = 40.0;
/// Switching temperatures that the recipe expects, C.
pub const EXPECTED: [Window; 2] = [
    Window {
        low_c: 80.0,
        high_c: 90.0,
    },
    Window {
        low_c: 57.0,
        high_c: 73.0,
    },
];
/// Lag and delay of the reference sensor that the recipe of an air chamber states, s.
const SENSOR_LAG_S: f64 = 8.0;
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
    sensors: [SensorValues; 2],
    figures: Identified,
}

/// What the controller knows about the lot before a batch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Lag of the lot; `None` until a batch has shown it.
    pub lag: Option<LotLag>,
    /// Windows of operate and reset temperatures.
    pub windows: [Window; 2],
    /// Scatter of switchings that the lot has shown, K.
    pub scatter_k: f64,
}

impl Known {
    /// Knowledge from the recipe alone.
    pub const RECIPE: Self = Self {
        lag: None,
        windows: EXPECTED,
        scatter_k: SCATTER_K,
    };
}

/// A batch that has run.
pub struct Outcome {
    /// Estimates and true operate and reset temperatures, C, by socket.
    pub parts: Vec<(Estimate, [f64; 2])>,
    /// Temperature of the room, C.
    pub ambient_c: f64,
    /// Duration without loading, min.
    pub minutes: f64,
    /// What the controller knows before the next batch of the lot.
    pub known: Known,
    /// Time (min) and reading of the reference sensor (C), every ten seconds.
    pub curve: Vec<[f64; 2]>,
}

/// A batch under way.
struct Running {
    plant: Plant,
    rack: Rack,
    record: Record,
    program: Program,
    controller: Controller,
    lag_s: f64,
}

impl Running {
    fn second(&mut self) {
        self.record.push(self.plant.reference_c());
        let seen = self.plant.seen();
        let before = self.program.pass();
        let set = self.program.step(seen.measured_c, waiting(&self.rack));
        if self.program.pass() > before {
            let [operate, reset] = shown(&self.record, &self.rack, self.lag_s);
            self.program.narrow(operate, reset, self.lag_s);
        }
        let command = self.controller.step(&set, &seen);
        let rack = &mut self.rack;
        self.plant
            .step_with(command, |dt_s, now| rack.step(dt_s, now.air_c));
    }

    fn is_over(&self) -> bool {
        self.program.phase() == Phase::Cool && self.plant.reference_c() <= END_C
    }
}

impl Rig {
    /// Draws a rig and identifies it at nominal mains.
    ///
    /// # Errors
    /// Fails when the chamber does not respond.
    pub fn new(kind: Kind, world: World, seed: u64) -> anyhow::Result<Self> {
        let (values, sensors) = drawn(Medium::Air, world.ambient_c, seed);
        let cold = Plant::new(&values, sensors, values.ambient_c, seed);
        let figures = cold.identify(Medium::Air)?;
        Ok(Self {
            kind,
            world,
            seed,
            values,
            sensors,
            figures,
        })
    }

    /// Runs a batch of the lot.
    ///
    /// # Errors
    /// Fails when the passes show no lag, or a part has no event.
    pub fn batch(&self, batch: &Batch, known: Known) -> anyhow::Result<Outcome> {
        let mut running = self.started(batch, known);
        let mut seconds = 0;
        while !running.is_over() {
            anyhow::ensure!(
                seconds < LONGEST_S,
                "seed {}: a batch does not end",
                self.seed
            );
            let later = seconds >= MAINS_STEP_S;
            running.plant.mains = if later {
                self.world.mains_later
            } else {
                self.world.mains
            };
            running.second();
            seconds += 1;
        }
        running.record.push(running.plant.reference_c());
        self.outcome(&running, known, seconds)
    }

    fn started(&self, batch: &Batch, known: Known) -> Running {
        let ambient_c = self.values.ambient_c;
        let parts_c = if self.world.warm_parts {
            START_C
        } else {
            ambient_c
        };
        let noise_seed = self.seed ^ (batch.number << 32);
        let lag_s = known.lag.map_or(self.kind.recipe_lag_s(), |it| it.seconds);
        let [operate, reset] = known.windows;
        let knows = known.lag.is_some();
        let passes = batch
            .strategy
            .passes(usize::from(knows), knows, operate, reset);
        let lot = Lot {
            kind: self.kind,
            lag: self.world.lag,
            scatter_k: self.world.scatter_k,
            seed: self.seed,
        };
        Running {
            plant: Plant::new(&self.values, self.sensors, START_C, noise_seed),
            rack: Rack::new(&lot, batch, [parts_c, START_C], ambient_c),
            record: Record::new(0.0, ambient_c),
            program: Program::new(START_C, passes, lag_s, UNLOAD_C),
            controller: batch.contender.controller(&self.figures),
            lag_s,
        }
    }

    fn outcome(&self, ran: &Running, known: Known, seconds: usize) -> anyhow::Result<Outcome> {
        let Running { record, rack, .. } = ran;
        let switching: Vec<Switching> = rack.parts.iter().map(|it| it.seen.clone()).collect();
        let lag = lot_lag(record, &switching).or(known.lag);
        let lag = lag.with_context(|| format!("seed {}: the passes tell no lag", self.seed))?;
        let assumed = Noise {
            scatter_k: known.scatter_k,
            sensor_lag_s: SENSOR_LAG_S,
        };
        let scatter_k = lot_scatter(record, &switching, &lag, &assumed);
        let noise = Noise {
            scatter_k,
            ..assumed
        };
        let one = |part: &Part| {
            let found = estimate(record, &part.seen, &lag, &noise);
            let found =
                found.with_context(|| format!("seed {}: a part without event", self.seed))?;
            Ok((found, [part.operate_c, part.reset_c]))
        };
        let parts = rack.parts.iter().map(one).collect::<anyhow::Result<_>>()?;
        let plain = record.filtered(0.0);
        let at = |second: usize| Some([second as f64 / 60.0, plain.at(second as f64)?.celsius]);
        Ok(Outcome {
            parts,
            ambient_c: self.values.ambient_c,
            minutes: seconds as f64 / 60.0,
            known: Known {
                lag: Some(lag),
                windows: shown(record, rack, lag.seconds),
                scatter_k,
            },
            curve: (0..seconds).step_by(10).filter_map(at).collect(),
        })
    }
}

fn waiting(rack: &Rack) -> Waiting {
    let operated = rack.parts.iter().filter(|it| it.operated).count();
    Waiting {
        operate: rack.parts.len() - operated,
        reset: operated,
    }
}

/// Returns the operate and reset windows, narrowed to the temperatures of the last pass.
fn shown(record: &Record, rack: &Rack, lag_s: f64) -> [Window; 2] {
    let filtered = record.filtered(lag_s);
    let window = |which: usize| {
        let last = |it: &Part| {
            let all = if which == 0 {
                &it.seen.operate
            } else {
                &it.seen.reset
            };
            filtered.at(all.last()?.first_s).map(|it| it.celsius)
        };
        let temperatures: Vec<f64> = rack.parts.iter().filter_map(last).collect();
        narrowed(&temperatures, EXPECTED[which])
    };
    [window(0), window(1)]
}
