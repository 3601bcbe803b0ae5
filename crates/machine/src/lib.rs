//! The machine without its lines, files and screens: what the rig is, what it may do, and what it does next.
//!
//! Everything here is a pure function of state, time, inputs and orders: no clock, no file, no socket, no log. The
//! crate `cycle` reads the inputs, calls [`station`] and carries out the commands that it returns.
//!
//! Modules in reading order:
//!
//! - [`guard`]: clears a motion, or refuses it and tells how near the bodies would come.
//! - [`rig`]: points with names instead of addresses; process image; drive.
//! - [`gauge`]: readings with their uncertainty, judged against limits.
//! - [`instrument`]: acts on wired points, and what they read.
//! - [`dut`]: devices under test, one folder per kind: recipe, calibration, procedure, verdict.
//! - [`handling`]: brings parts to the nest and into the bins.
//! - [`station`]: runs the whole rig: its state machine (PackML), lot, orders, alarms.
//! - [`view`]: what a screen shows.
//! - [`form`]: keys that a configuration file may hold.
//!
//! A result passes only where its uncertainty keeps it inside the limit:
//!
//! ```
//! use machine::gauge::budget::{Budget, Reading, rectangular};
//! use machine::gauge::judgement::{Judgement, Limit, Rule, judge};
//! use units::Unit;
//!
//! let limit = Limit { unit: Unit::Volt, low: None, high: Some(9.0) };
//! let read = |value| Reading {
//!     value,
//!     unit: Unit::Volt,
//!     budget: Budget::default().with("ramp", rectangular(0.02)),
//! };
//! assert_eq!(judge(&read(8.90), &limit, Rule::GuardBand), Judgement::Pass);
//! // U is 0.023 V: this value is inside the limit, but not by U.
//! assert!(matches!(judge(&read(8.99), &limit, Rule::GuardBand), Judgement::Conditional(_)));
//! ```

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
