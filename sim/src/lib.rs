//! The simulated rig: modules, mechanism and specimens of a relay tester, behind serial lines.
//!
//! A host sends bytes to a line and receives the bytes that real modules would send; the simulated physics behind the
//! terminals determines the values in them. The controller shares nothing with this crate but bytes, the files in
//! `config/` and the clock of virtual time.
//!
//! | module | content, in reading order |
//! |---|---|
//! | [`terminal`] | screw terminals: the boundary between modules and world |
//! | [`dcon`], [`module`], [`mod@line`] | the device side of the protocol, one file per family |
//! | [`world`], [`config`], [`truth`] | interface board, mechanism and specimens, with their true values |
//! | [`rig`] | lines, modules and world together, stepped from event to event |
//! | [`fault`] | faults between a module and its host |
//! | [`journal`] | record of the outputs, for tests of safety |
//! | [`wire`], [`pace`], [`pty`] | lines as streams in virtual time, and as pseudo-terminals in real time |
//! | [`mod@bench`] | modules alone, with fixed signals |
//! | [`scpi`] | SCPI instruments, their links, and what they measure |
//! | [`fingerprint`] | a line whose values identify their module and channel |
//!
//! ```
//! let bench = "[[module]]\naddress = 1\nmodel = \"I-7017\"\ninputs = [5.0]";
//! let mut rig = rigsim::bench::build_text(bench)?;
//! let reply = rig.exchange(0, b"#010", 0).expect("module 1 answers");
//! assert_eq!(reply.bytes, b">+05.000\r");
//! # Ok::<(), rigsim::SimError>(())
//! ```

pub mod bench;
pub mod config;
pub mod dcon;
mod error;
pub mod fault;
mod files;
pub mod fingerprint;
mod instruments;
pub mod journal;
pub mod line;
pub mod module;
pub mod pace;
pub mod pty;
pub mod rig;
pub mod scpi;
mod shared;
mod table;
pub mod terminal;
pub mod truth;
mod uart;
pub mod wire;
pub mod world;

pub use error::SimError;
pub use files::Files;
pub use shared::{Options, SharedRig, build, build_bench, faults};
