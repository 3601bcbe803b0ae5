//! `relayrig config check` and `relayrig config schema NAME`: read files only; no port is opened.

use anyhow::Context;
use app::exit::Exit;
use config::schema::{FILES, of_file};
use config::{Folder, overview};
use std::io::Write;

/// Checks the configuration or prints a schema.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Args {
    /// Check everything that loading would refuse, without moving anything
    #[command(
        after_help = "Examples:\n  relayrig config check\n  relayrig --config plant2 config check"
    )]
    Check,
    /// Print the JSON schema of a file: rig, golden, recipe, card or lot
    #[command(after_help = "Example:\n  relayrig config schema recipe > recipe.schema.json")]
    Schema {
        /// Which file
        #[arg(value_parser = FILES)]
        name: String,
    },
}

/// Runs the command on the configuration in `folder`.
///
/// # Errors
/// Fails with every fault of the configuration: exit status 2.
pub fn run(folder: &Folder, args: &Args) -> anyhow::Result<Exit> {
    let text = match args {
        Args::Check => overview(folder)?,
        Args::Schema { name } => {
            let known = || format!("found {name:?}, expected one of {}", FILES.join(", "));
            let schema = of_file(name).with_context(known)?;
            serde_json::to_string_pretty(&schema).context("writing the schema")? + "\n"
        }
    };
    std::io::stdout()
        .lock()
        .write_all(text.as_bytes())
        .context("writing to stdout")?;
    Ok(Exit::Done)
}
