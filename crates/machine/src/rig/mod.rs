//! The rig as named points: no module above this one knows a module address.
//!
//! In reading order:
//! - [`point`]: the points to sense, switch, set, measure and count: a closed list for the machine, and a list
//!   declared by each kind of device.
//! - [`settings`], [`model`] and [`wiring`]: the wiring of each point. [`resolve`], `declared`, `modules`, [`axis`]
//!   (with each [`bin`]), [`rack`] and [`reaction`] resolve and check `rig.toml`; a [`fault::Fault`] names a setting
//!   that does not fit.
//! - [`handling`]: a feeder or a rack.
//! - [`instruments`]: the SCPI instruments with their profiles and links.
//! - [`commission`]: checks that the modules on the lines are those of `rig.toml`.
//! - [`query`], [`sample`], [`image`]: commands that read points, and the values read, with their times.
//! - [`drive`], [`level`], [`supply`]: values of the outputs, and the ranges of the supply's amplifier. [`drive`]
//!   switches an output that moves something only with the guard's clearance.
//!
//! All modules are pure: times are arguments, and commands are values that the caller sends.

pub mod axis;
pub mod bin;
pub mod commission;
mod comparison;
mod declared;
pub mod drive;
pub mod fault;
pub mod handling;
pub mod image;
pub mod instruments;
pub mod interlock;
pub mod level;
pub mod model;
mod modules;
pub mod point;
pub mod query;
pub mod rack;
pub mod reaction;
pub mod resolve;
pub mod sample;
pub mod settings;
pub mod stroke;
pub mod supply;
pub mod wiring;

#[cfg(test)]
mod tests;

pub use drive::Outputs;
pub use image::Image;
pub use sample::{CountSample, Sample};
pub use wiring::Wiring;
