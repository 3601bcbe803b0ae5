//! `history rejudge`: verdicts of another recipe. The history does not change.

use crate::cli::output::{Output, Table};
use clap::Args;
use config::{Folder, load_recipe};
use history::Archive;
use history::inquiry::rejudge::{RejudgedPart, Rejudging};
use std::io::Write;

#[derive(Debug, Args)]
pub(super) struct RejudgeArgs {
    /// Name of the lot
    #[arg(long, value_name = "LOT")]
    lot: String,
    /// Only this run of the lot (1, 2, ...)
    #[arg(long, value_name = "N")]
    run: Option<u32>,
    /// Recipe in config/recipes
    #[arg(long, value_name = "NAME")]
    recipe: String,
    /// One JSON object per part, then a summary
    #[arg(long)]
    json: bool,
}

pub(super) fn run(config: &Folder, archive: &Archive, args: &RejudgeArgs) -> anyhow::Result<()> {
    let recipe = load_recipe(config, &args.recipe)?;
    let question = Rejudging::of(archive, args.lot.clone(), args.run, recipe)?;
    let mut out = Output::stdout();
    let mut table = Table::new(&["run", "seq", "verdict", "now", "bin", "reasons"]);
    let changes = question.each::<anyhow::Error>(archive, |part| {
        match args.json {
            true => out.json(&part)?,
            false if part.changes() => table.row(&mut out, cells(part))?,
            false => {}
        }
        Ok(())
    })??;
    if args.json {
        out.json(&changes)?;
        return Ok(out.flush()?);
    }
    table.finish(&mut out)?;
    for it in &changes.changes {
        writeln!(out, "{} -> {}: {}", it.was, it.now, it.parts)?;
    }
    Ok(out.flush()?)
}

fn cells(part: RejudgedPart) -> Vec<String> {
    vec![
        part.run.to_string(),
        part.seq.to_string(),
        part.verdict_was,
        part.verdict.into(),
        part.bin,
        part.reasons.join("; "),
    ]
}
