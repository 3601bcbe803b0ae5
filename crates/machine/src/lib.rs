//! The machine without its wires: what the rig is, what it may do, and what it does next.
//!
//! Everything here is a pure function of state, time, inputs and orders: no clock, no file, no socket, no log. The crate
//! `app` reads the inputs, calls [`station`] and drives what comes out.
//!
//! Modules in reading order:
//!
//! - [`guard`]: clears a motion or refuses it with the distance that is missing.
//! - [`rig`]: points with names instead of addresses; process image; drive.
//! - [`gauge`]: readings with their uncertainty, judged against limits.
//! - [`instrument`]: acts on wired points, and what they read.
//! - [`dut`]: a kind of device is one folder: recipe, calibration, procedure, verdict.
//! - [`handling`]: brings parts to the nest and into the bins.
//! - [`station`]: sequences the whole: outer machine, lot, orders, alarms.
//! - [`view`]: what a screen shows.
//! - [`form`]: keys that a configuration file may hold.

#[macro_use]
mod named;

pub mod dut;
pub mod form;
pub mod gauge;
pub mod guard;
pub mod handling;
pub mod instrument;
pub mod rig;
pub mod station;
pub mod view;
