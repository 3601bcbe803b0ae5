//! The command line of relayrig: a file per command turns arguments into types of `app` and answers into text.

pub mod cli;
