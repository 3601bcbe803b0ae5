//! `relayrig history backup`: the history in a file, or the whole rig in a dated folder.

use app::backup_folder::back_up;
use app::copies;
use app::order::Files;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Arguments of `history backup`.
#[derive(Debug, clap::Args)]
pub struct BackupArgs {
    /// File to make; must not exist
    #[arg(required_unless_present = "into")]
    file: Option<PathBuf>,
    /// Make a dated folder in DIR instead, with history, people and configuration
    #[arg(long, value_name = "DIR", conflicts_with = "file")]
    into: Option<PathBuf>,
    /// Dated folders to keep in DIR; older ones are deleted
    #[arg(long, value_name = "N", default_value = "14", conflicts_with = "file")]
    keep: NonZeroUsize,
}

/// Runs `relayrig history backup`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: &BackupArgs) -> anyhow::Result<()> {
    if let Some(file) = &args.file {
        let bytes = copies::backup(&files.db, file)?;
        eprintln!("{}: {bytes} bytes, checked", file.display());
    }
    if let Some(into) = &args.into {
        let made = back_up(files, into, args.keep)?;
        for old in &made.deleted {
            eprintln!("{}: deleted", old.display());
        }
        let (folder, bytes) = (made.folder.display(), made.bytes);
        eprintln!("{folder}: history of {bytes} bytes, checked");
    }
    Ok(())
}
