//! `fleet status`: what each database has and lacks.

use crate::cli::output::Output;
use app::exit::Exit;
use app::order::Files;
use clap::Args;
use config::{FleetSettings, FleetTarget};
use fleet::Report;
use history::outbox::Outbox;
use serde_json::json;

#[derive(Debug, Args)]
pub(super) struct StatusArgs {
    /// One JSON object per database
    #[arg(long)]
    json: bool,
}

pub(super) fn run(
    files: &Files,
    (settings, targets): (&FleetSettings, &[FleetTarget]),
    args: &StatusArgs,
) -> anyhow::Result<Exit> {
    let reports = reports(files, settings, targets)?;
    let text = |it: &Report| {
        let head = format!(
            "{}: {} parts of {}/{} there, lacks {} parts ({:.0} s); {} rigs, schema {}, partitions for {} months ahead",
            it.url,
            it.parts,
            settings.site,
            settings.rig,
            it.lag_parts,
            it.lag_s,
            it.rigs,
            it.schema,
            it.months_ahead
        );
        it.faults
            .iter()
            .fold(head, |text, fault| format!("{text}\n  {fault}"))
    };
    Output::stdout().lines(args.json, &reports, |it| json!(it), text)?;
    Ok(Exit::Done)
}

/// Asks every database.
pub(super) fn reports(
    files: &Files,
    settings: &FleetSettings,
    targets: &[FleetTarget],
) -> anyhow::Result<Vec<Report>> {
    anyhow::ensure!(files.db.exists(), "no history at {}", files.db.display());
    let outbox = Outbox::open(&files.db)?;
    let ask = |target: &FleetTarget| {
        super::block_on(async { Ok(fleet::report(&outbox, settings, target).await?) })
    };
    targets.iter().map(ask).collect()
}
