//! `fleet generate`: made-up histories of many rigs in the database, for trying questions at size.

use app::exit::Exit;
use app::progress::{PIECES, progress};
use clap::Args;
use config::FleetTarget;
use fleet::generate::{VALUES, Wanted, generate};
use std::time::Instant;

#[derive(Debug, Args)]
pub(super) struct GenerateArgs {
    /// Number of parts of all rigs together
    #[arg(long, value_name = "N", default_value_t = 400_000,
        value_parser = clap::value_parser!(i64).range(1..=1_000_000_000))]
    parts: i64,
    /// Number of rigs
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(i64).range(1..=10_000))]
    rigs: i64,
    /// Time over which the parts of each rig are spread, up to now
    #[arg(long, value_name = "DAYS", default_value_t = 365, value_parser = clap::value_parser!(i64).range(1..=3660))]
    days: i64,
}

pub(super) fn run(targets: &[FleetTarget], args: &GenerateArgs) -> anyhow::Result<Exit> {
    let wanted = Wanted {
        parts: args.parts,
        rigs: args.rigs,
        days: args.days,
    };
    for target in targets {
        let bar = progress(Some(args.parts.unsigned_abs()), PIECES);
        let from = Instant::now();
        let made = |parts: i64| bar.set_position(parts.unsigned_abs());
        super::block_on(async { Ok(generate(target, wanted, made).await?) })?;
        bar.finish_and_clear();
        let seconds = from.elapsed().as_secs_f64();
        eprintln!(
            "{}: {} parts, {} measurements, {:.0} measurements/s",
            target.url,
            args.parts,
            args.parts * VALUES,
            (args.parts * VALUES) as f64 / seconds
        );
    }
    Ok(Exit::Done)
}
