//! `relayrig history restore`: history, people and configuration from a backup.

use crate::cli::output::Output;
use app::exit::Exit;
use app::order::Files;
use app::restore::Contents;
use std::path::PathBuf;

/// Arguments of `history restore`.
#[derive(Debug, clap::Args)]
pub struct RestoreArgs {
    /// Dated folder of `backup --into`, the folder of dated folders (restores the newest), or a copied history
    backup: PathBuf,
    /// Only check the backup; writes nothing
    #[arg(long, conflicts_with = "replace")]
    check: bool,
    /// Replace existing files, which stay beside the restored ones as NAME.before-TIME
    #[arg(long)]
    replace: bool,
}

/// Runs `relayrig history restore`; a fault that the check of the backup finds gives exit status 1, not an error.
pub fn run(files: &Files, args: &RestoreArgs) -> anyhow::Result<Exit> {
    let backup = Contents::find(&args.backup)?;
    let mut out = Output::stdout();
    out.line(&backup.at.display().to_string())?;
    let mut is_whole = true;
    for (name, found) in backup.check() {
        is_whole &= found.is_ok();
        let found = found.unwrap_or_else(|error| format!("FAULT {error:#}"));
        out.line(&format!("  {name}: {found}"))?;
    }
    if !is_whole {
        eprintln!("nothing was restored");
        return Ok(Exit::AnswerIsNo);
    }
    if !args.check {
        for old in backup.restore(files, args.replace)? {
            eprintln!("{}: kept", old.display());
        }
        out.line(&format!("restored; the history is {}", files.db.display()))?;
    }
    Ok(Exit::Done)
}
