//! A heated chamber: temperatures of its five parts, its heater and its sensors, as plain models.
//!
//! ```text
//! duty -> burst (whole half cycles) -> heater -> air -> wall -> insulation -> ambient
//!                                                 air -> rack;  air -> ambient by leak, vent, door
//!                                                 air, rack, heater -> sensor (delay, lag, errors)
//! ```
//!
//! [`Chamber::step_with`] advances a chamber together with anything that follows its temperatures:
//!
//! ```
//! use rigsim::world::oven::{Chamber, ChamberValues, Drive, Sensor, SensorValues};
//!
//! let mut chamber = Chamber::new(&ChamberValues::AIR, 23.0);
//! let mut sensor = Sensor::new(SensorValues::AIR, 23.0);
//! let drive = Drive { duty: 0.5, ..Drive::RUNNING };
//! for _second in 0..60 {
//!     chamber.step_with(1.0, &drive, |dt_s, now| sensor.step(dt_s, now.air_c));
//! }
//! assert!(chamber.temperatures().heater_c > sensor.celsius());
//! ```

pub mod burst;
pub mod chamber;
mod eigen;
pub mod follow;
pub mod sensor;
pub mod values;

pub use burst::BurstFiring;
pub use chamber::{Chamber, Drive, Temperatures};
pub use follow::{Delay, Lag};
pub use sensor::{Sensor, SensorValues};
pub use values::{ChamberValues, Spread};

#[cfg(test)]
mod tests;
