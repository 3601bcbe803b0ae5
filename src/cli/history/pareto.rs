//! `history pareto`: reasons of rejects or alarms, the most frequent first.

use super::filter::{RunArgs, SpanArgs};
use crate::cli::output::{Column, FormatArgs, Output, text};
use clap::Args;
use history::Archive;
use history::inquiry::pareto::{self, Ranked};

#[derive(Debug, Args)]
pub(super) struct ParetoArgs {
    #[command(flatten)]
    runs: RunArgs,
    #[command(flatten)]
    span: SpanArgs,
    /// Alarms instead of reasons
    #[arg(long)]
    alarms: bool,
    #[command(flatten)]
    format: FormatArgs,
}

const COLUMNS: [Column<Ranked>; 4] = [
    ("n", |it| it.n.to_string()),
    ("running_percent", |it| {
        format!("{:.1}", 100.0 * it.cumulative)
    }),
    ("active_s", |it| {
        text(it.active_s.map(|it| format!("{it:.0}")))
    }),
    ("what", |it| it.en.clone()),
];

pub(super) fn run(archive: &Archive, args: &ParetoArgs) -> anyhow::Result<()> {
    let filter = args.span.within(args.runs.filter());
    let ranked = match args.alarms {
        true => pareto::alarms(archive, &filter)?,
        false => pareto::rejects(archive, &filter, 0)?.reasons,
    };
    Output::stdout().list(args.format.format(), &ranked, &COLUMNS)
}
