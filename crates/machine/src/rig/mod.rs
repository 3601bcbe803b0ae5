//! The rig as named points: nobody above this module knows an address.
//!
//! Read in this order:
//! - [`point`]: what can be sensed, switched, set, measured, counted: a closed vocabulary of the machine, and what a kind of
//!   device declares.
//! - [`settings`], [`model`] and [`wiring`]: where each point is wired. The file is resolved and checked by
//!   [`resolve`], `declared`, `modules`, [`axis`] (with each [`bin`]) and [`reaction`]; a [`fault::Fault`] says what does not fit.
//! - [`commission`]: is the rig on the lines the rig of the file?
//! - [`query`], [`sample`], [`image`]: what is asked, and what is known, since when.
//! - [`drive`], [`level`]: what is put out; motion only as cleared by the guard.
//!
//! Pure: times are arguments, commands are values; sending them is the business of the caller.

pub mod axis;
pub mod bin;
pub mod commission;
mod declared;
pub mod drive;
pub mod fault;
pub mod image;
mod judge;
pub mod level;
pub mod model;
mod modules;
pub mod point;
pub mod query;
pub mod reaction;
pub mod resolve;
pub mod sample;
pub mod settings;
pub mod wiring;

#[cfg(test)]
mod tests;

pub use drive::Outputs;
pub use image::Image;
pub use sample::{CountSample, Sample};
pub use wiring::Wiring;
