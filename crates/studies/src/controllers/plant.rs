//! The simulated chamber of a study, with its control and reference sensors, stepped a second at a time.

use chamber::control::Observed;
use chamber::control::split_range::Command;
use chamber::tune::Identified;
use chamber::tune::identify::{Identification, Step};
use rigsim::world::draw::{Draw, Subject};
use rigsim::world::oven::{
    Chamber, ChamberValues, Drive, Sensor, SensorValues, Spread, Temperatures,
};

/// Medium that carries the heat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Medium {
    /// Moving air.
    Air,
    /// Stirred oil bath.
    Oil,
    /// Dry metal block.
    Block,
}

impl Medium {
    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Air => "air",
            Self::Oil => "oil",
            Self::Block => "block",
        }
    }

    /// Returns the nominal values of chamber and sensors.
    pub fn values(self) -> (ChamberValues, SensorValues) {
        match self {
            Self::Air => (ChamberValues::AIR, SensorValues::AIR),
            Self::Oil => (ChamberValues::OIL, SensorValues::OIL),
            Self::Block => (ChamberValues::BLOCK, SensorValues::BLOCK),
        }
    }

    /// Returns the power of the heater in an identification run, 1 = full heater.
    fn step(self) -> f64 {
        match self {
            Self::Air | Self::Block => 0.15,
            Self::Oil => 0.3,
        }
    }
}

/// Range of the room temperature, C.
const ROOM_C: [f64; 2] = [18.0, 28.0];
/// Standard uncertainty of a calibrated chain (sensor, wires, converter), K. The study draws the bias of each chain
/// with this standard deviation.
pub const CHAIN_K: f64 = 0.05;
/// Standard deviation of delay and lag of the sensors, percent.
const SENSOR_SPREAD_PCT: f64 = 30.0;

/// Draws a chamber with control and reference sensor at random, and the room temperature too when `room_c` is `None`.
pub fn drawn(medium: Medium, room_c: Option<f64>, seed: u64) -> (ChamberValues, [SensorValues; 2]) {
    let mut draw = Draw::new(seed, Subject::Rig, 3);
    let (nominal, sensor) = medium.values();
    let any_c = draw.between(ROOM_C);
    let values = ChamberValues {
        ambient_c: room_c.unwrap_or(any_c),
        ..nominal.drawn(&Spread::USUAL, &mut draw)
    };
    let sensors = [(); 2].map(|()| sensor.drawn(CHAIN_K, SENSOR_SPREAD_PCT, &mut draw));
    (values, sensors)
}

/// Highest temperature of an identification run, C.
const IDENTIFY_LIMIT_C: f64 = 90.0;

/// A running chamber.
#[derive(Debug, Clone)]
pub struct Plant {
    chamber: Chamber,
    control: Sensor,
    reference: Sensor,
    draw: Draw,
    /// Ratio of the heater power to the heater power at nominal mains voltage.
    pub mains: f64,
    /// True while the door is open.
    pub door_open: bool,
    control_c: f64,
    reference_c: f64,
}

impl Plant {
    /// Makes a chamber at one temperature with two sensors: control and reference.
    pub fn new(
        values: &ChamberValues,
        sensors: [SensorValues; 2],
        celsius: f64,
        seed: u64,
    ) -> Self {
        let [control, reference] = sensors.map(|it| Sensor::new(it, celsius));
        Self {
            chamber: Chamber::new(values, celsius),
            control_c: control.celsius(),
            reference_c: reference.celsius(),
            control,
            reference,
            draw: Draw::new(seed, Subject::Rig, 1),
            mains: 1.0,
            door_open: false,
        }
    }

    /// Makes the nominal chamber of a medium, cold.
    pub fn nominal(medium: Medium, seed: u64) -> Self {
        let (values, sensor) = medium.values();
        Self::new(&values, [sensor; 2], values.ambient_c, seed)
    }

    /// Advances by a second, in short steps; calls `follow` with the length of each step, s, and the temperatures at
    /// the end of the step.
    pub fn step_with(&mut self, command: Command, mut follow: impl FnMut(f64, &Temperatures)) {
        let drive = Drive {
            duty: command.heater,
            power: self.mains,
            vent: command.vent,
            fan: 1.0,
            door_open: self.door_open,
        };
        let (control, reference) = (&mut self.control, &mut self.reference);
        self.chamber.step_with(1.0, &drive, |dt_s, now| {
            control.step(dt_s, now.air_c);
            reference.step(dt_s, now.air_c);
            follow(dt_s, now);
        });
        self.control_c = self.control.read(&mut self.draw);
        self.reference_c = self.reference.read(&mut self.draw);
    }

    /// Advances by a second.
    pub fn step(&mut self, command: Command) {
        self.step_with(command, |_, _| {});
    }

    /// Returns the readings that the controller gets.
    pub fn seen(&self) -> Observed {
        Observed {
            measured_c: self.control_c,
            ambient_c: self.chamber.values().ambient_c,
        }
    }

    /// Returns the reading of the reference sensor, C.
    pub fn reference_c(&self) -> f64 {
        self.reference_c
    }

    /// Returns the temperature at the control sensor without noise, C.
    pub fn exact_c(&self) -> f64 {
        self.control.celsius()
    }

    /// Runs an identification on this chamber, which must be cold.
    ///
    /// # Errors
    /// Fails when the chamber does not respond as an identification needs it.
    pub fn identify(self, medium: Medium) -> anyhow::Result<Identified> {
        Ok(self.identify_in_room(medium)?.0)
    }

    /// Does what [`Self::identify`] does; returns also the temperature of the room, C, that belongs to the figures: a run
    /// that takes the chamber for a warm one finds its own.
    ///
    /// # Errors
    /// Fails as [`Self::identify`] does.
    pub fn identify_in_room(mut self, medium: Medium) -> anyhow::Result<(Identified, f64)> {
        let ambient_c = self.seen().ambient_c;
        let mut run = Identification::new(medium.step(), ambient_c, IDENTIFY_LIMIT_C);
        loop {
            match run.step(self.control_c)? {
                Step::Go(command) => self.step(command),
                Step::Done(found) => return Ok((found, run.ambient_c())),
            }
        }
    }
}
