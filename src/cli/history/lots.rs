//! `history list`.

use super::filter::RunArgs;
use super::output::{Format, FormatArgs, Output, Table, text};
use clap::Args;
use history::{Archive, LotSummary, csv};
use std::io::Write;

#[derive(Debug, Args)]
pub(super) struct ListArgs {
    #[command(flatten)]
    runs: RunArgs,
    #[command(flatten)]
    format: FormatArgs,
}

const HEADER: [&str; 16] = [
    "lot",
    "run",
    "recipe",
    "source",
    "seed",
    "opened",
    "closed",
    "parts",
    "pass",
    "fail",
    "void",
    "yield_percent",
    "golden",
    "alarms",
    "ended",
    "cause",
];

pub(super) fn run(archive: &Archive, args: &ListArgs) -> anyhow::Result<()> {
    let filter = args.runs.filter();
    super::query::remark_unknown(archive, &filter);
    let lots = archive.lots(&filter)?;
    write(&lots, args.format.format(), &mut Output::stdout())
}

pub(super) fn write(lots: &[LotSummary], format: Format, out: &mut Output) -> anyhow::Result<()> {
    match format {
        Format::Json => lots.iter().try_for_each(|lot| out.json(lot))?,
        Format::Csv => {
            csv::write(out, HEADER)?;
            for lot in lots {
                csv::write(out, cells(lot).iter().map(|cell| csv::escape_formula(cell)))?;
            }
        }
        Format::Table => {
            let mut table = Table::new(&HEADER);
            lots.iter().try_for_each(|lot| table.row(out, cells(lot)))?;
            table.finish(out)?;
        }
    }
    Ok(out.flush()?)
}

fn cells(lot: &LotSummary) -> Vec<String> {
    let counts = &lot.counts;
    vec![
        lot.lot.clone(),
        lot.run.to_string(),
        lot.recipe.clone(),
        lot.source.clone(),
        text(lot.seed.as_ref()),
        lot.opened.to_string(),
        text(lot.closed),
        counts.parts.to_string(),
        counts.pass.to_string(),
        counts.fail.to_string(),
        counts.void.to_string(),
        text(counts.percent().map(|it| format!("{it:.2}"))),
        lot.golden.to_string(),
        lot.alarms.to_string(),
        text(lot.ended.as_ref()),
        text(lot.cause.as_ref()),
    ]
}
