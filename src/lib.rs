//! The command line of relayrig: a file per command turns arguments into types of `app` and answers into text.
//!
//! [`cli`] has the commands with their options, one file each: `cli/run.rs` for `relayrig run`.
//!
//! ```
//! use clap::Parser;
//! use relayrig::cli::Cli;
//! assert!(Cli::try_parse_from(["relayrig", "run", "--lot", "A", "--recipe", "jzc-22f-012"]).is_ok());
//! assert!(Cli::try_parse_from(["relayrig", "run", "--lot", "A"]).is_err());
//! ```

pub mod cli;
