//! `history orders`: orders with person, place and answer.

use super::filter::{RunArgs, SpanArgs};
use crate::cli::output::{Column, FormatArgs, Output, text};
use clap::Args;
use history::{Archive, OrderChoice, OrderEntry};

#[derive(Debug, Args)]
pub(super) struct OrdersArgs {
    #[command(flatten)]
    runs: RunArgs,
    #[command(flatten)]
    span: SpanArgs,
    /// Only this person
    #[arg(long, value_name = "NAME")]
    who: Option<String>,
    /// Only this order, for example `people` (changes of people) or `login` (wrong passwords)
    #[arg(long, value_name = "WORD")]
    order: Option<String>,
    /// Only orders that were refused
    #[arg(long)]
    refused: bool,
    #[command(flatten)]
    format: FormatArgs,
}

pub(super) const COLUMNS: [Column<OrderEntry>; 8] = [
    ("time", |it| it.at.local()),
    ("lot", |it| text(it.lot.as_ref())),
    ("run", |it| text(it.run)),
    ("who", |it| it.who.clone()),
    ("role", |it| it.role.clone()),
    ("from", |it| it.origin.clone()),
    ("order", |it| it.what.to_string()),
    ("refused", |it| text(it.refused.as_ref())),
];

pub(super) fn run(archive: &Archive, args: &OrdersArgs) -> anyhow::Result<()> {
    let filter = args.span.within(args.runs.filter());
    let mut orders = archive.orders(
        &filter,
        &OrderChoice {
            who: args.who.clone(),
            order: args.order.clone(),
            without_people: false,
        },
    )?;
    orders.retain(|it| !args.refused || it.refused.is_some());
    Output::stdout().list(args.format.format(), &orders, &COLUMNS)
}
