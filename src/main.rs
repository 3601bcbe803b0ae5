//! Parses the command line and runs the command.

mod logging;

use app::exit::Exit;
use clap::Parser;
use relayrig::cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let started = logging::start(cli.log.as_deref());
    let exit = started
        .and_then(|()| cli.execute())
        .unwrap_or_else(|error| {
            eprintln!("relayrig: {error:#}");
            Exit::BadInput
        });
    ExitCode::from(exit.code())
}
