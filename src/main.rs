//! Parses the command line and runs the command.

use app::exit::Exit;
use clap::Parser;
use relayrig::cli::Cli;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let filter = EnvFilter::try_new(&cli.log).unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()))
        .init();
    let exit = cli.execute().unwrap_or_else(|error| {
        eprintln!("relayrig: {error:#}");
        Exit::BadInput
    });
    ExitCode::from(exit.code())
}
