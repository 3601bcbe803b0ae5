//! `history prune`: deletes the parts of old runs that were copied whole; lists them without `--yes`.

use crate::cli::output::{Column, Output};
use app::copies::OldRuns;
use app::exit::Exit;
use app::progress::{PIECES, progress};
use clap::Args;
use history::Pruned;
use std::path::Path;

#[derive(Debug, Args)]
pub(super) struct PruneArgs {
    /// Runs that ended at least N days ago
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=36_500))]
    older_than_days: u32,
    /// Delete the runs; without this option the command only lists them
    #[arg(long)]
    yes: bool,
}

pub(super) fn run(db: &Path, args: &PruneArgs) -> anyhow::Result<Exit> {
    let old = OldRuns::open(db, args.older_than_days)?;
    let runs = old.list()?;
    let columns: [Column<Pruned>; 4] = [
        ("lot", |it| it.lot.clone()),
        ("run", |it| it.run.to_string()),
        ("parts", |it| it.parts.to_string()),
        ("copy", |it| it.file.clone()),
    ];
    Output::stdout().table(&runs, &columns)?;
    if !args.yes {
        eprintln!(
            "{} runs could go; nothing was deleted (say --yes)",
            runs.len()
        );
        return Ok(Exit::Done);
    }
    let bar = progress(Some(runs.len() as u64), PIECES);
    old.delete(|| bar.inc(1))?;
    bar.finish_and_clear();
    Ok(Exit::Done)
}
