//! `history generate`: a random history as large as weeks of a plant, see [`app::generate`].

use app::exit::Exit;
use app::generate::{BATCH, GenerateOptions, generate};
use app::progress::{PIECES, progress};
use clap::Args;
use config::Folder;
use history::Moment;
use std::path::Path;

/// Arguments of `history generate`.
#[derive(Debug, Clone, Args)]
pub(super) struct GenerateArgs {
    /// Number of parts
    #[arg(long, value_name = "N", default_value_t = 1_000_000,
        value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    parts: u64,
    /// Seed of all values
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Recipe that judges the parts
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    recipe: String,
    /// Instant of the last part (2026-11-22, -8h, RFC 3339); now when absent
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    until: Option<Moment>,
}

pub(super) fn run(config: &Folder, db: &Path, args: &GenerateArgs) -> anyhow::Result<Exit> {
    let wanted = GenerateOptions {
        parts: args.parts,
        seed: args.seed,
        recipe: args.recipe.clone(),
        until: args.until,
    };
    let bar = progress(Some(args.parts), PIECES);
    let done = generate(config, db, &wanted, |parts| bar.set_position(parts))?;
    bar.finish_and_clear();
    eprintln!(
        "{}: {} parts, {} measurements, {:.0} parts/s in transactions of {BATCH}",
        db.display(),
        done.parts,
        done.measurements,
        done.parts as f64 / done.writing.as_secs_f64()
    );
    Ok(Exit::Done)
}
