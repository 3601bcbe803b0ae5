//! The command line of relayrig: one file per command; the only place that names the simulator.

pub mod cli;
