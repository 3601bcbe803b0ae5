//! `fleet push`: sends what the databases lack.

use crate::cli::output::Output;
use app::exit::Exit;
use app::order::Files;
use clap::Args;
use config::{FleetSettings, FleetTarget};
use history::outbox::Outbox;
use std::time::Instant;

#[derive(Debug, Args)]
pub(super) struct PushArgs {
    /// Continue as a new epoch of the rig: this history file replaces the file that sent before
    #[arg(long)]
    take_over: bool,
    /// Queue and send everything again, after a database lost rows; the database keeps the rows that it has
    #[arg(long, conflicts_with = "take_over")]
    again: bool,
    /// Remove databases that fleet.toml no longer names, so that retention does not wait for them
    #[arg(long)]
    forget: bool,
}

pub(super) fn run(
    files: &Files,
    (settings, targets): (&FleetSettings, &[FleetTarget]),
    args: &PushArgs,
) -> anyhow::Result<Exit> {
    anyhow::ensure!(files.db.exists(), "no history at {}", files.db.display());
    let mut outbox = Outbox::open(&files.db)?;
    if args.forget {
        let urls: Vec<&str> = settings.targets.iter().map(|it| it.url.as_str()).collect();
        for gone in outbox.forget_others(&urls)? {
            eprintln!("{gone}: forgotten");
        }
    }
    let mut out = Output::stdout();
    for target in targets {
        let from = Instant::now();
        let pushed = super::block_on(async {
            if args.take_over {
                fleet::take_over(&mut outbox, settings, target).await?;
            }
            if args.again {
                fleet::start_again(&mut outbox, settings, target).await?;
            }
            Ok(fleet::push(&mut outbox, settings, target, || false).await?)
        })?;
        let (parts, seconds) = (pushed.parts, from.elapsed().as_secs_f64());
        out.line(&format!(
            "{}: {parts} parts in {} batches, {seconds:.1} s, {:.0} parts/s",
            target.url,
            pushed.batches,
            parts as f64 / seconds
        ))?;
    }
    Ok(Exit::Done)
}
