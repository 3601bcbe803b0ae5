//! `history orders`: orders with person, place and answer.

use super::filter::RunArgs;
use crate::cli::output::{Column, FormatArgs, Output, text};
use clap::Args;
use history::{Archive, Filter, Moment, OrderEntry};

#[derive(Debug, Args)]
pub(super) struct OrdersArgs {
    #[command(flatten)]
    runs: RunArgs,
    /// Answered at this time or later (RFC 3339)
    #[arg(long, value_name = "TIME")]
    since: Option<Moment>,
    /// Answered before this time (RFC 3339)
    #[arg(long, value_name = "TIME")]
    until: Option<Moment>,
    /// Only this person
    #[arg(long, value_name = "NAME")]
    who: Option<String>,
    /// Only orders that were refused
    #[arg(long)]
    refused: bool,
    #[command(flatten)]
    format: FormatArgs,
}

pub(super) const COLUMNS: [Column<OrderEntry>; 8] = [
    ("time", |it| it.at.to_string()),
    ("lot", |it| text(it.lot.as_ref())),
    ("run", |it| text(it.run)),
    ("who", |it| it.who.clone()),
    ("role", |it| it.role.clone()),
    ("from", |it| it.origin.clone()),
    ("order", |it| it.what.to_string()),
    ("refused", |it| text(it.refused.as_ref())),
];

pub(super) fn run(archive: &Archive, args: &OrdersArgs) -> anyhow::Result<()> {
    let filter = Filter {
        since: args.since,
        until: args.until,
        ..args.runs.filter()
    };
    let mut orders = archive.orders(&filter, args.who.as_deref())?;
    orders.retain(|it| !args.refused || it.refused.is_some());
    Output::stdout().list(args.format.format(), &orders, &COLUMNS)
}
