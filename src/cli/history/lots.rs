//! `history list`: runs of lots with their counts.

use super::filter::RunArgs;
use crate::cli::output::{Column, FormatArgs, Output, text};
use clap::Args;
use history::{Archive, LotSummary, Moment};

#[derive(Debug, Args)]
pub(super) struct ListArgs {
    #[command(flatten)]
    runs: RunArgs,
    #[command(flatten)]
    format: FormatArgs,
}

pub(super) const COLUMNS: [Column<LotSummary>; 17] = [
    ("lot", |it| it.lot.clone()),
    ("run", |it| it.run.to_string()),
    ("recipe", |it| it.recipe.clone()),
    ("source", |it| it.source.clone()),
    ("seed", |it| text(it.seed.as_ref())),
    ("opened", |it| it.opened.local()),
    ("closed", |it| text(it.closed.map(Moment::local))),
    ("parts", |it| it.counts.parts.to_string()),
    ("pass", |it| it.counts.pass.to_string()),
    ("fail", |it| it.counts.fail.to_string()),
    ("void", |it| it.counts.void.to_string()),
    ("yield_percent", |it| {
        text(it.counts.percent().map(|it| format!("{it:.2}")))
    }),
    ("golden", |it| it.golden.to_string()),
    ("alarms", |it| it.alarms.to_string()),
    ("ended", |it| text(it.ended.as_ref())),
    ("cause", |it| text(it.cause.as_ref())),
    ("external", |it| {
        let word = |acceptable| {
            if acceptable {
                "acceptable"
            } else {
                "not acceptable"
            }
        };
        text(it.external.as_ref().map(|it| word(it.acceptable)))
    }),
];

/// Column that only an answer about many rigs has.
const RIG: Column<LotSummary> = ("rig", |it| text(it.rig.as_ref()));

pub(super) fn run(archive: &Archive, args: &ListArgs) -> anyhow::Result<()> {
    let filter = args.runs.filter();
    super::query::warn_unknown(archive, &filter);
    let lots = archive.lots(&filter)?;
    let of_rigs = lots.iter().any(|it| it.rig.is_some());
    let rig: &[Column<LotSummary>] = if of_rigs { &[RIG] } else { &[] };
    Output::stdout().list(args.format.format(), &lots, &[rig, &COLUMNS].concat())
}
