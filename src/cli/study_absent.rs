//! `relayrig study` in a build without the studies: fails with the name of the feature to build with.

use anyhow::bail;
use app::exit::Exit;
use std::path::Path;

/// Every argument after `study`.
#[derive(Debug, Clone, clap::Args)]
pub struct StudyArgs {
    /// Name and options of a study
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub words: Vec<String>,
}

/// Refuses the command.
///
/// # Errors
/// Always fails; the error names the feature to build with.
pub fn run(_config: &Path, _args: &StudyArgs) -> anyhow::Result<Exit> {
    bail!(
        "study: this program was built without the studies; build it with `cargo build --release --features study`"
    )
}
