//! Tests of the built program, and rules about the source tree.
//!
//! - [`layout`]: rules about imports, pure modules, places of files, and references in documents.
//! - `backup`: a backup of the whole rig, and its restoration.
//! - `bus`: the bus tools on the modules of a bench file, and traces of alarms.
//! - `calibrate`: storing and verifying factors, and refusing lots without them.
//! - [`commands`]: wrong files and simple orders.
//! - `doctor`: a fresh folder, and spoiled ones.
//! - `figures`: the document of all figures, made from its plan.
//! - [`first_steps`]: a demo in an empty directory, and `init`.
//! - `full_disk`: a history file that reaches its size limit.
//! - `gates`: reference checks, suspect parts, reject-rate limit, first articles, retests, wear.
//! - `history_taken`: histories of other or newer programs, and one that another process locks.
//! - `instruments`: links to SCPI instruments against the simulated ones, under faults and by the commands.
//! - `interruptions`: rows of stopped and killed lots.
//! - `killed`: outputs become safe in time after a kill.
//! - [`lots`]: whole lots on the simulated rig in virtual time, compared with the truth of its world.
//! - `notify`: notifications of the service to systemd.
//! - `packaging`: units, scripts and contents of the Debian package.
//! - `paper`: printing, export, rejudging, retention.
//! - [`picture`]: the drawing in README.md matches `config/scene.toml`.
//! - [`plan`]: tables and orders of scenes, every step tried again by `check`; refusals.
//! - `prompts`: prompts of a recipe, with answers given in advance.
//! - `protocol`: every command of every module, written, answered and read; settings, INIT*.
//! - `stories`: scripts of troubles and orders with their expected course.
//! - `ssr`: lots of solid-state relays, compared with the truth of their world.
//! - `ssr_killed`: controllers killed in the middle of a test of a solid-state relay.
//! - `storm`: random transactions under all faults of a line; the fingerprint of each value names its origin.
//! - `tempest`: the whole program under faults, orders and kills, judged by the simulated rig.
//! - `unplugged`: a port that vanishes while a lot runs.
//! - `fleet`: the page of all rigs, from a PostgreSQL server of its own.
//! - [`rows`]: recorded rows of six recipes, five seeds, forty parts each.
//! - `serials`: serial numbers of parts, and paper and searches with them.
//! - `serve`: lots started, refused and continued at the page.
//! - [`troubles`]: faults of the rig by name, with the alarm of each.

#![allow(clippy::unwrap_used)]

#[cfg(feature = "sim")]
mod backup;
#[cfg(all(feature = "sim", unix))]
mod bus;
#[cfg(feature = "sim")]
mod calibrate;
mod check;
mod commands;
#[cfg(feature = "sim")]
mod doctor;
#[cfg(feature = "study")]
mod figures;
mod first_steps;
#[cfg(all(feature = "study", feature = "fleet", unix))]
mod fleet;
#[cfg(all(feature = "sim", unix))]
mod full_disk;
#[cfg(feature = "sim")]
mod gates;
#[cfg(all(feature = "sim", unix))]
mod history_taken;
#[cfg(all(feature = "sim", unix))]
mod instruments;
#[cfg(all(feature = "sim", unix))]
mod interruptions;
#[cfg(all(feature = "sim", unix))]
mod killed;
mod layout;
#[cfg(feature = "sim")]
mod lots;
#[cfg(all(feature = "sim", unix))]
mod notify;
mod packaging;
#[cfg(feature = "sim")]
mod paper;
mod picture;
mod plan;
mod program;
#[cfg(feature = "sim")]
mod prompts;
#[cfg(feature = "sim")]
mod protocol;
#[cfg(feature = "sim")]
mod rows;
#[cfg(feature = "sim")]
mod serials;
#[cfg(all(feature = "sim", unix))]
mod serve;
#[cfg(feature = "sim")]
mod ssr;
#[cfg(all(feature = "sim", unix))]
mod ssr_killed;
#[cfg(feature = "sim")]
mod stories;
#[cfg(feature = "sim")]
mod storm;
#[cfg(feature = "sim")]
mod tempest;
#[cfg(feature = "sim")]
mod thermostat;
#[cfg(feature = "sim")]
mod troubles;
#[cfg(all(feature = "sim", unix))]
mod unplugged;
