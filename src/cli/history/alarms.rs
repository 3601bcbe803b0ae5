//! `history alarms`: every occurrence of an alarm, with its state.

use super::filter::{RunArgs, SpanArgs};
use crate::cli::output::{Column, FormatArgs, Output, text};
use clap::Args;
use history::{Alarm, Archive};

#[derive(Debug, Args)]
pub(super) struct AlarmsArgs {
    #[command(flatten)]
    runs: RunArgs,
    #[command(flatten)]
    span: SpanArgs,
    /// Only this code
    #[arg(long, value_name = "CODE")]
    code: Option<String>,
    #[command(flatten)]
    format: FormatArgs,
}

const COLUMNS: [Column<Alarm>; 7] = [
    ("raised", |it| it.raised.to_string()),
    ("cleared", |it| text(it.cleared)),
    ("acknowledged_by", |it| text(it.acknowledged_by.as_ref())),
    ("lot", |it| text(it.lot.as_ref())),
    ("run", |it| text(it.run)),
    ("code", |it| it.code.clone()),
    ("text", |it| it.text.clone()),
];

pub(super) fn run(archive: &Archive, args: &AlarmsArgs) -> anyhow::Result<()> {
    let mut alarms = archive.alarms(&args.span.within(args.runs.filter()))?;
    alarms.retain(|it| args.code.as_ref().is_none_or(|code| *code == it.code));
    Output::stdout().list(args.format.format(), &alarms, &COLUMNS)
}
