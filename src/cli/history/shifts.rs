//! `history shifts`: yield and output by shift.

use super::filter::{RunArgs, SpanArgs};
use crate::cli::output::{Column, FormatArgs, Output, text};
use clap::Args;
use config::{Folder, load_fleet};
use history::inquiry::shifts::{Shift, ShiftYield, by_shift};
use history::{Archive, Filter, Moment};
use jiff::tz::TimeZone;

#[derive(Debug, Args)]
pub(super) struct ShiftsArgs {
    #[command(flatten)]
    runs: RunArgs,
    #[command(flatten)]
    span: SpanArgs,
    #[command(flatten)]
    format: FormatArgs,
}

const COLUMNS: [Column<ShiftYield>; 7] = [
    ("day", |it| it.day.clone()),
    ("shift", |it| it.shift.clone()),
    ("rig", |it| text(it.rig.as_ref())),
    ("parts", |it| it.counts.parts.to_string()),
    ("first_pass", |it| it.counts.first_pass.to_string()),
    ("retest_pass", |it| it.counts.retest_pass.to_string()),
    ("first_pass_percent", |it| {
        let share = 100.0 * it.counts.first_pass as f64 / it.counts.parts as f64;
        text((it.counts.parts > 0).then(|| format!("{share:.2}")))
    }),
];

pub(super) fn run(config: &Folder, archive: &Archive, args: &ShiftsArgs) -> anyhow::Result<()> {
    let fleet = load_fleet(config)?;
    let shifts: Vec<Shift> = fleet
        .shifts
        .iter()
        .map(|it| Shift {
            name: it.name.clone(),
            minutes: it.minutes(),
        })
        .collect();
    let filter = args.span.within(args.runs.filter());
    let filter = Filter {
        since: filter.since.or_else(|| "-7d".parse().ok()),
        until: filter.until.or_else(|| "now".parse::<Moment>().ok()),
        ..filter
    };
    let all = by_shift(archive, &filter, &shifts, &TimeZone::system())?;
    Output::stdout().list(args.format.format(), &all, &COLUMNS)
}
