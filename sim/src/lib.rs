//! The simulated rig: what a relay tester's modules, mechanism and specimens do, behind two lines.
//!
//! In reading order:
//! - [`terminal`]: the screw terminals between modules and world
//! - [`dcon`], [`module`], [`line`]: the device side of the protocol, one family per file
//! - [`world`], [`config`], [`truth`]: interface board, mechanism, specimens and what they really were
//! - [`rig`]: everything together, from event to event
//! - [`fault`]: what can go wrong between a module and its host
//! - [`journal`]: what the outputs do, for tests of safety
//! - [`wire`], [`pace`]: lines as streams in virtual time; [`pty`]: as pseudo-terminals in real time
//! - [`bench`]: modules alone with fixed signals
//! - [`fingerprint`]: a line on which every value tells whose it is
//!
//! The controller shares nothing with this crate but bytes and the files in `config/`.

pub mod bench;
pub mod config;
pub mod dcon;
mod error;
pub mod fault;
pub mod fingerprint;
pub mod journal;
pub mod line;
pub mod module;
pub mod pace;
pub mod pty;
pub mod rig;
mod shared;
pub mod terminal;
pub mod truth;
mod uart;
pub mod wire;
pub mod world;

pub use error::SimError;
pub use shared::{Options, SharedRig, build, build_bench, faults};
