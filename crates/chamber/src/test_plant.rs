//! A small chamber for the tests of this crate: five bodies, a delayed sensor, explicit Euler steps of 50 ms.

use crate::control::Observed;
use crate::control::filter::Delay;
use crate::control::split_range::Command;
use crate::tune::Identified;
use crate::tune::identify::{Identification, Step};

/// Ambient temperature, C.
pub const AMBIENT_C: f64 = 25.0;

/// State of the chamber.
pub struct Plant {
    /// Heater, air, wall, rack, insulation, C.
    bodies_c: [f64; 5],
    sensor_c: f64,
    delay: Delay,
    /// Lag of the sensor, s.
    pub sensor_lag_s: f64,
    /// Ratio of the power of the heater to the nominal one.
    pub mains: f64,
    /// True while the door is open.
    pub door_open: bool,
}

impl Plant {
    /// Makes a chamber at one temperature.
    pub fn at(celsius: f64) -> Self {
        Self {
            bodies_c: [celsius; 5],
            sensor_c: celsius,
            delay: Delay::of(2.0),
            sensor_lag_s: 6.0,
            mains: 1.0,
            door_open: false,
        }
    }

    /// Advances by a second and returns the readings.
    pub fn step(&mut self, command: Command) -> Observed {
        const STEP_S: f64 = 0.05;
        let door = if self.door_open { 40.0 } else { 0.0 };
        for _ in 0..20 {
            let [h, a, w, r, i] = self.bodies_c;
            let out = (0.5 + 18.0 * command.vent + door) * (a - AMBIENT_C);
            let flows = [
                (2200.0 * self.mains * command.heater - 50.0 * (h - a)) / 450.0,
                (50.0 * (h - a) - 35.0 * (a - w) - 25.0 * (a - r) - out + 60.0) / 150.0,
                (35.0 * (a - w) - 4.0 * (w - i)) / 4000.0,
                25.0 * (a - r) / 2900.0,
                (4.0 * (w - i) - 4.0 * (i - AMBIENT_C)) / 3000.0,
            ];
            for (body, flow) in self.bodies_c.iter_mut().zip(flows) {
                *body += STEP_S * flow;
            }
        }
        let delayed = self.delay.step(self.bodies_c[1]);
        self.sensor_c += (delayed - self.sensor_c) * (1.0 - (-1.0 / self.sensor_lag_s).exp());
        self.seen()
    }

    /// Returns the temperature of the heater, C.
    pub fn surface_c(&self) -> f64 {
        self.bodies_c[0]
    }

    /// Returns the present readings.
    pub fn seen(&self) -> Observed {
        Observed {
            measured_c: (self.sensor_c * 100.0).round() / 100.0,
            ambient_c: AMBIENT_C,
        }
    }
}

/// Returns the figures of an identification run on the usual chamber.
pub fn identified() -> Identified {
    identified_on(Plant::at(AMBIENT_C))
}

/// Returns the figures of an identification run on a cold chamber.
pub fn identified_on(mut plant: Plant) -> Identified {
    let mut run = Identification::new(0.15, AMBIENT_C, 90.0);
    loop {
        match run.step(plant.seen().measured_c).unwrap() {
            Step::Go(command) => plant.step(command),
            Step::Done(found) => return found,
        };
    }
}
