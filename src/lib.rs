//! Controller of a JZC-22F relay performance tester with automatic feed and discharge.
//!
//! Modules in reading order:
//!
//! - [`units`]: volts, ohms, microseconds of rig time.
//! - [`dcon`]: the protocol of the I-7000 modules; pure.
//! - [`bus`]: a line; one transaction at a time, bounded, never a neighbour's answer.
//! - [`lpm`]: the collision core: layers, projections, exact sweeps.
//! - [`guard`]: every motion passes it and comes out cleared or refused with numbers.
//! - [`rig`]: named points instead of addresses; process image; drive.
//! - [`gauge`]: readings with their uncertainty.
//! - [`instrument`]: acts on wired points, and what was read.
//! - [`dut`]: a kind of device is one folder: recipe, calibration, procedure, verdict.
//! - [`handling`]: how parts get to the nest and into bins.
//! - [`station`]: the sequence: outer machine, lot, orders, alarms.
//! - [`cycle`]: one turn of the rig, top to bottom.
//! - [`history`]: SQLite; [`quality`]: statistics that stay right.
//! - [`report`]: print, spreadsheet, process card, charts.
//! - [`inquiry`]: what may be asked of the history, answered alike everywhere.
//! - [`view`]: what a screen may know; [`hmi`]: the page, its events and orders.
//! - [`form`]: what a configuration file may hold; [`config`]: files to settings, with the line of every mistake.
//! - [`app`]: what a lot, a day of service, a story, a calibration is; the only place that opens lines.
//! - [`study`]: figures that anyone can reprint.
//! - [`cli`]: a file per command: arguments into types of `app`, answers into text.

pub mod app;
pub mod bus;
pub mod cli;
pub mod config;
pub mod cycle;
pub mod dcon;
pub mod dut;
pub mod form;
pub mod gauge;
pub mod guard;
pub mod handling;
pub mod history;
pub mod hmi;
pub mod inquiry;
pub mod instrument;
pub mod lpm;
pub mod quality;
pub mod report;
pub mod rig;
pub mod station;
#[cfg(feature = "sim")]
pub mod study;
pub mod units;
pub mod view;
