//! Arithmetic of a rig that tests temperature relays in a chamber: control of the chamber, and the temperatures at which
//! the parts in it switch.
//!
//! Everything is stepped once a second with readings in and commands out; there is no clock, file or socket. Temperatures
//! are degrees Celsius (`_c`), differences kelvin (`_k`), powers shares of the full heater; rates are K/min where a person
//! states them, K/s inside.
//!
//! | module | does |
//! |---|---|
//! | [`ramp`] | set point of S shape, which waits for a slow chamber |
//! | [`program`] | passes of a batch: approach, rise, descent, fall |
//! | [`plan`] | which passes a batch gets, and the windows that earlier passes have narrowed |
//! | [`control`] | PID, fuzzy and fuzzy-PID, feed-forward that learns, heater and vent |
//! | [`tune`] | identification by a step, relay auto-tune, settings |
//! | [`lag`] | switching temperatures from instants, the lag of the parts taken out |
//! | [`budget`] | uncertainty, with and without calibrations |
//! | [`watch`] | plausibility of sensors, energy balance |
//!
//! A chamber that answers like its identification stays within 0.05 K of a ramp:
//!
//! ```
//! use chamber::control::{Controller, Observed};
//! use chamber::ramp::Ramp;
//! use chamber::tune::response::Response;
//! use chamber::tune::{FirstOrder, Identified};
//!
//! let figures = Identified {
//!     gain_k: 30.6, time_constant_s: 21.9, delay_s: 7.0, slope_k_per_s: 0.264,
//!     loss_per_k: 0.0, fan: 0.0, vent_per_k: 0.008,
//!     first_order: FirstOrder { gain_k: 65.0, time_constant_s: 52.0, delay_s: 4.5 },
//! };
//! let (mut plant, mut controller) = (Response::of(&figures), Controller::usual(&figures));
//! let (mut ramp, mut past, mut air_c) = (Ramp::at(40.0), vec![40.0; 8], 40.0);
//! ramp.head_for(60.0, 2.0);
//! for _second in 0..600 {
//!     let set = ramp.step(air_c);
//!     let seen = Observed { measured_c: air_c, ambient_c: 25.0 };
//!     air_c += plant.step(controller.step(&set, &seen).heater);
//!     past.push(set.value_c);
//!     assert!((past[past.len() - 8] - air_c).abs() < 0.05);
//! }
//! ```

#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod budget;
pub mod control;
pub mod lag;
pub mod plan;
pub mod program;
pub mod ramp;
mod statistics;
#[cfg(test)]
mod test_plant;
pub mod tune;
pub mod watch;
