//! `relayrig init`: writes the configuration that is inside this program as a directory to edit.

use anyhow::Context;
use app::exit::Exit;
use std::io::Write;
use std::path::PathBuf;

/// Writes a configuration of your own.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig init rig1
  relayrig init rig2 --rig ssr
  relayrig config check --config rig1
  relayrig demo --config rig1

The files describe a rig of the demo; comments and README.md explain each key. A directory that is not empty is
refused: to compare with newer files, write them to another one.")]
pub struct InitArgs {
    /// Directory to write; new or empty
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Rig whose configuration to write
    #[arg(long, value_name = "NAME", default_value = "jzc-22f", value_parser = super::rig::built_in())]
    pub rig: String,
}

/// Runs `relayrig init` and prints what to do next.
///
/// # Errors
/// Fails when the directory is not empty or cannot be written.
pub fn run(args: &InitArgs) -> anyhow::Result<Exit> {
    config::init(&args.dir, &args.rig)?;
    let dir = args.dir.display();
    let next = format!(
        "{dir}: written. Begin with {dir}/README.md, edit the files, then
  relayrig config check --config {dir}    says what is wrong
  relayrig demo --config {dir}            tries them on the simulated rig
  relayrig serve --config {dir}           runs the rig
"
    );
    let written = std::io::stdout().write_all(next.as_bytes());
    super::unless_pipe_closed(written.context("writing to stdout"), ())?;
    Ok(Exit::Done)
}
