//! `history stats`: statistics and capability of one parameter.

use super::filter::PartArgs;
use crate::cli::output::{Column, Output, figure};
use clap::Args;
use history::Archive;
use history::inquiry::figures;
use quality::{Limits, Summary};
use std::io::Write;

#[derive(Debug, Args)]
pub(super) struct StatsArgs {
    /// Parameter key
    #[arg(long, value_name = "KEY")]
    param: String,
    #[command(flatten)]
    parts: PartArgs,
    /// Lower limit for the capability, instead of the stored limits
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    low: Option<f64>,
    /// Upper limit for the capability, instead of the stored limits
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    high: Option<f64>,
    /// One JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(archive: &Archive, args: &StatsArgs) -> anyhow::Result<()> {
    let filter = args.parts.filter();
    let found = figures::figures(archive, &args.param, &filter, limits(args)?)?;
    if found.limits_differ {
        eprintln!("the runs have different limits: no capability (choose a lot, or --low, --high)");
    }
    let mut out = Output::stdout();
    if args.json {
        out.json(&found.summary)?;
    } else {
        table(&found.summary, &mut out)?;
    }
    Ok(out.flush()?)
}

/// Returns the limits of the command line, if given.
fn limits(args: &StatsArgs) -> anyhow::Result<Option<Limits>> {
    let (low, high) = (args.low, args.high);
    if low.is_none() && high.is_none() {
        return Ok(None);
    }
    let finite = [low, high].into_iter().flatten().all(f64::is_finite);
    anyhow::ensure!(finite, "--low and --high must be finite");
    if let (Some(low), Some(high)) = (low, high) {
        anyhow::ensure!(low < high, "--low {low} is not below --high {high}");
    }
    Ok(Some(Limits { low, high }))
}

fn table(it: &Summary, out: &mut Output) -> anyhow::Result<()> {
    let figures = [
        ("mean", it.mean),
        ("sd", it.sd),
        ("min", it.min),
        ("max", it.max),
        ("median", it.median),
        ("lag1", it.lag1),
        ("cp", it.cp),
        ("cpk", it.cpk),
        ("cpk_low95", it.cpk_low95),
        ("ppk", it.ppk),
    ];
    let shown = |value: Option<f64>| value.map_or("-".to_owned(), |it| figure(Some(it)));
    let without = it.without_value.map_or("-".to_owned(), |it| it.to_string());
    let mut rows = vec![("n", it.n.to_string()), ("without_value", without)];
    rows.extend(figures.map(|(name, value)| (name, shown(value))));
    let columns: [Column<(&str, String)>; 2] = [
        ("param", |it| it.0.to_owned()),
        (&it.param, |it| it.1.clone()),
    ];
    Ok(out.table(&rows, &columns)?)
}
