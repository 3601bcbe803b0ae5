//! `history orders`: who ordered what, and whether it was taken.

use super::filter::RunArgs;
use super::output::{Format, FormatArgs, Output, Table, text};
use clap::Args;
use history::{Archive, Filter, Moment, OrderEntry, csv};
use std::io::Write;

#[derive(Debug, Args)]
pub(super) struct OrdersArgs {
    #[command(flatten)]
    runs: RunArgs,
    /// AnsweredOrder at this time or later (RFC 3339)
    #[arg(long, value_name = "TIME")]
    since: Option<Moment>,
    /// AnsweredOrder before this time (RFC 3339)
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

const HEADER: [&str; 8] = [
    "time", "lot", "run", "who", "role", "from", "order", "refused",
];

pub(super) fn run(archive: &Archive, args: &OrdersArgs) -> anyhow::Result<()> {
    let filter = Filter {
        since: args.since,
        until: args.until,
        ..args.runs.filter()
    };
    let mut orders = archive.orders(&filter, args.who.as_deref())?;
    orders.retain(|it| !args.refused || it.refused.is_some());
    write(&orders, args.format.format(), &mut Output::stdout())
}

pub(super) fn write(orders: &[OrderEntry], format: Format, out: &mut Output) -> anyhow::Result<()> {
    match format {
        Format::Json => orders.iter().try_for_each(|it| out.json(it))?,
        Format::Csv => {
            csv::write(out, HEADER)?;
            for it in orders {
                csv::write(out, cells(it).iter().map(|cell| csv::escape_formula(cell)))?;
            }
        }
        Format::Table => {
            let mut table = Table::new(&HEADER);
            orders.iter().try_for_each(|it| table.row(out, cells(it)))?;
            table.finish(out)?;
        }
    }
    Ok(out.flush()?)
}

fn cells(it: &OrderEntry) -> Vec<String> {
    vec![
        it.at.to_string(),
        text(it.lot.as_ref()),
        text(it.run),
        it.who.clone(),
        it.role.clone(),
        it.origin.clone(),
        it.what.to_string(),
        text(it.refused.as_ref()),
    ]
}
