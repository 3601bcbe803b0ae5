//! The whole line from outside, and the rules of the house.
//!
//! - [`layout`]: what the source tree must look like: who imports whom, what a pure module may not name,
//!   which files stand where, and that the documents speak of things that exist.
//! - `bus`: the tools of a line against modules on a bench, and the traces of alarms.
//! - `calibrate`: factors stored, verified, and a rig that takes no lot without them.
//! - [`commands`]: the built program given wrong files and simple orders.
//! - `full_disk`: a history that may not grow any more while a lot runs.
//! - `gates`: golden checks, suspect parts, discard limit, first articles, retests, wear.
//! - `history_taken`: files of other programs, of a newer one, and one that another process locks while a lot runs.
//! - `interruptions`: lots that are stopped or killed, and what is left of them.
//! - `killed`: the controller killed over pseudo-terminals, and outputs safe in time.
//! - [`lots`]: whole lots on the simulated rig in virtual time, held against the truth of the world.
//! - `paper`: pages, sheets, another recipe, retention, parts fed again.
//! - [`picture`]: the picture in README.md is that of `config/scene.toml`.
//! - `protocol`: every command of every module, written, answered and read; settings, INIT*.
//! - `stories`: scripts of troubles and orders, and what happened, as a mechanic would tell it.
//! - `storm`: random transactions under every fault of a line at once, judged by the fingerprint of each value.
//! - `tempest`: the whole program under faults of world and line, orders and kills, judged by the simulated rig.
//! - `unplugged`: a port that vanishes over pseudo-terminals.
//! - [`rows`]: four recipes, five seeds, forty parts each, compared with what was recorded.
//! - `serve`: lots started, refused and continued at the page.
//! - [`troubles`]: faults of the rig by name, and the alarm each must end in.

#![allow(clippy::unwrap_used)]

#[cfg(all(feature = "sim", unix))]
mod bus;
#[cfg(feature = "sim")]
mod calibrate;
mod check;
mod commands;
#[cfg(all(feature = "sim", unix))]
mod full_disk;
#[cfg(feature = "sim")]
mod gates;
#[cfg(all(feature = "sim", unix))]
mod history_taken;
#[cfg(all(feature = "sim", unix))]
mod interruptions;
#[cfg(all(feature = "sim", unix))]
mod killed;
mod layout;
#[cfg(feature = "sim")]
mod lots;
#[cfg(feature = "sim")]
mod paper;
mod picture;
mod program;
#[cfg(feature = "sim")]
mod protocol;
#[cfg(feature = "sim")]
mod rows;
#[cfg(all(feature = "sim", unix))]
mod serve;
#[cfg(feature = "sim")]
mod stories;
#[cfg(feature = "sim")]
mod storm;
#[cfg(feature = "sim")]
mod tempest;
#[cfg(feature = "sim")]
mod troubles;
#[cfg(all(feature = "sim", unix))]
mod unplugged;
