//! Temperatures of heater, air, wall, rack and insulation: five lumped bodies in closed form.
//!
//! Between two changes of its inputs the chamber is linear, `C T' = b - K T` with symmetric K, so its temperatures are
//! sums of five exponentials: a step of any length is exact up to rounding.

use super::burst::BurstFiring;
use super::eigen::{self, Matrix, N};
use super::values::ChamberValues;

/// Share of the convection that remains while the fan stands still.
const STILL_AIR: f64 = 0.08;

/// Longest time between two calls of the follower of [`Chamber::step_with`], microseconds.
const FOLLOW_US: u64 = 100_000;

/// Inputs of a chamber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Duty that the power unit of the heater receives, 0 to 1.
    pub duty: f64,
    /// Ratio of the power of the conducting heater to that at nominal mains; 0 with an open contactor.
    pub power: f64,
    /// Opening of the vent, 0 to 1.
    pub vent: f64,
    /// Speed of the fan, 0 to 1.
    pub fan: f64,
    /// True while the door is open.
    pub door_open: bool,
}

impl Drive {
    /// Fan on, mains nominal, vent and door shut, no heat.
    pub const RUNNING: Self = Self {
        duty: 0.0,
        power: 1.0,
        vent: 0.0,
        fan: 1.0,
        door_open: false,
    };
}

/// Temperatures of the bodies, degrees Celsius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Temperatures {
    /// Heater.
    pub heater_c: f64,
    /// Air between the sockets; in other designs oil or metal block.
    pub air_c: f64,
    /// Inner wall.
    pub wall_c: f64,
    /// Rack with its sockets and parts.
    pub rack_c: f64,
    /// Insulation.
    pub insulation_c: f64,
}

/// A chamber with its state.
#[derive(Debug, Clone)]
pub struct Chamber {
    values: ChamberValues,
    celsius: [f64; N],
    unit: BurstFiring,
    modes: Modes,
    /// Time since the last multiple of [`FOLLOW_US`], microseconds.
    phase_us: u64,
}

/// The five exponentials for one state of fan, vent and door.
#[derive(Debug, Clone, Copy)]
struct Modes {
    fan: f64,
    /// Conductance from air to ambient, W/K.
    out_w_per_k: f64,
    rates_per_s: [f64; N],
    /// Matrix that turns temperatures into amplitudes of the modes, weighted by the root of the heat capacities.
    shapes: Matrix,
    root_capacity: [f64; N],
}

impl Chamber {
    /// Creates a chamber with all bodies at one temperature, degrees Celsius.
    pub fn new(values: &ChamberValues, celsius: f64) -> Self {
        let out_w_per_k = values.leak_w_per_k;
        Self {
            values: *values,
            celsius: [celsius; N],
            unit: BurstFiring::default(),
            modes: Modes::new(values, 1.0, out_w_per_k),
            phase_us: 0,
        }
    }

    /// Returns the values of this chamber.
    pub fn values(&self) -> &ChamberValues {
        &self.values
    }

    /// Returns the present temperatures.
    pub fn temperatures(&self) -> Temperatures {
        let [heater_c, air_c, wall_c, rack_c, insulation_c] = self.celsius;
        Temperatures {
            heater_c,
            air_c,
            wall_c,
            rack_c,
            insulation_c,
        }
    }

    /// Advances by `dt_s` (whole microseconds) under a constant drive.
    pub fn step(&mut self, dt_s: f64, drive: &Drive) -> Temperatures {
        self.step_with(dt_s, drive, |_, _| {});
        self.temperatures()
    }

    /// Advances by `dt_s` (whole microseconds); calls `follow` with each part of that time, 0.1 s at most, and the
    /// temperatures at its end.
    pub fn step_with(
        &mut self,
        dt_s: f64,
        drive: &Drive,
        mut follow: impl FnMut(f64, &Temperatures),
    ) {
        self.arrange(drive);
        let mut left_us = (dt_s * 1e6).round() as u64;
        while left_us > 0 {
            let most_us = left_us.min(FOLLOW_US - self.phase_us);
            let (us, on) = self.unit.run(drive.duty, most_us);
            let heater_w = if on {
                drive.power * self.values.heater_w
            } else {
                0.0
            };
            let part_s = us as f64 * 1e-6;
            self.relax(part_s, heater_w);
            self.phase_us = (self.phase_us + us) % FOLLOW_US;
            left_us -= us;
            follow(part_s, &self.temperatures());
        }
    }

    /// Recomputes the modes when fan, vent or door have changed.
    fn arrange(&mut self, drive: &Drive) {
        let values = &self.values;
        let door = if drive.door_open {
            values.door_w_per_k
        } else {
            0.0
        };
        let out = values.leak_w_per_k + values.vent_w_per_k * drive.vent.clamp(0.0, 1.0) + door;
        let fan = drive.fan.clamp(0.0, 1.0);
        if (fan, out) != (self.modes.fan, self.modes.out_w_per_k) {
            self.modes = Modes::new(values, fan, out);
        }
    }

    /// Advances with constant power, and without a change of fan, vent or door.
    fn relax(&mut self, dt_s: f64, heater_w: f64) {
        let (values, modes) = (&self.values, &self.modes);
        let ambient_c = values.ambient_c;
        let fan_w = values.fan_w * modes.fan.powi(3);
        // Temperatures are relative to ambient, so that only the powers drive.
        let power_w = [heater_w, fan_w, 0.0, 0.0, 0.0];
        let root = &modes.root_capacity;
        let above: [f64; N] = std::array::from_fn(|i| (self.celsius[i] - ambient_c) * root[i]);
        let pushed: [f64; N] = std::array::from_fn(|i| power_w[i] / root[i]);
        let amplitudes: [f64; N] = std::array::from_fn(|k| {
            let along = |v: &[f64; N]| -> f64 { (0..N).map(|i| modes.shapes[i][k] * v[i]).sum() };
            let rate = modes.rates_per_s[k];
            let gone = -(-rate * dt_s).exp_m1();
            along(&above) * (1.0 - gone) + along(&pushed) * gone / rate
        });
        for (i, celsius) in self.celsius.iter_mut().enumerate() {
            let sum: f64 = (0..N).map(|k| modes.shapes[i][k] * amplitudes[k]).sum();
            *celsius = ambient_c + sum / root[i];
        }
    }
}

impl Modes {
    fn new(values: &ChamberValues, fan: f64, out_w_per_k: f64) -> Self {
        let root_capacity = values.capacity_j_per_k.map(f64::sqrt);
        let k = conductances(values, fan, out_w_per_k);
        let scaled = std::array::from_fn(|i| {
            std::array::from_fn(|j| k[i][j] / (root_capacity[i] * root_capacity[j]))
        });
        let (rates_per_s, shapes) = eigen::symmetric(scaled);
        Self {
            fan,
            out_w_per_k,
            rates_per_s,
            shapes,
            root_capacity,
        }
    }
}

/// Returns the matrix K. Row i gives the heat that leaves body i, W, per kelvin of each body above ambient.
fn conductances(values: &ChamberValues, fan: f64, out_w_per_k: f64) -> Matrix {
    let convection = fan.powf(0.8).max(STILL_AIR);
    let links = [
        (0, 1, values.heater_air_w_per_k * convection),
        (1, 2, values.air_wall_w_per_k * convection),
        (1, 3, values.air_rack_w_per_k * convection),
        (2, 4, values.wall_insulation_w_per_k),
    ];
    let mut k = [[0.0; N]; N];
    for (i, j, g) in links {
        k[i][i] += g;
        k[j][j] += g;
        k[i][j] -= g;
        k[j][i] -= g;
    }
    k[1][1] += out_w_per_k;
    k[4][4] += values.insulation_ambient_w_per_k;
    k
}
