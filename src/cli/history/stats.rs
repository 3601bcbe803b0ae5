//! `history stats`.

use super::filter::{PartArgs, known_parameter};
use super::output::{Output, Table, figure};
use crate::history::{Archive, Filter, LimitsSeen};
use crate::quality::{Limits, Summary};
use clap::Args;
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
    known_parameter(&archive.parameters()?, &args.param)?;
    let filter = args.parts.filter();
    something(archive, &filter)?;
    let found = archive.values(&args.param, &filter)?;
    let summary = Summary::of(&args.param, &found.values, limits(args, found.limits)?);
    let mut out = Output::stdout();
    if args.json {
        out.json(&summary)?;
    } else {
        table(&summary, &mut out)?;
    }
    Ok(out.flush()?)
}

/// A lot or recipe that never was is a slip of the hand, not an empty answer.
fn something(archive: &Archive, filter: &Filter) -> anyhow::Result<()> {
    let named = filter.lot.is_some() || filter.recipe.is_some() || filter.run.is_some();
    if named && archive.lots(filter)?.is_empty() {
        anyhow::bail!("no run has this lot, run and recipe; `history list` shows those there are");
    }
    Ok(())
}

fn limits(args: &StatsArgs, seen: LimitsSeen) -> anyhow::Result<Limits> {
    if args.low.is_some() || args.high.is_some() {
        let (low, high) = (args.low, args.high);
        let finite = [low, high].into_iter().flatten().all(f64::is_finite);
        anyhow::ensure!(finite, "--low and --high must be finite");
        if let (Some(low), Some(high)) = (low, high) {
            anyhow::ensure!(low < high, "--low {low} is not below --high {high}");
        }
        return Ok(Limits { low, high });
    }
    Ok(match seen {
        LimitsSeen::None => Limits::default(),
        LimitsSeen::Same { low, high } => Limits { low, high },
        LimitsSeen::Differ => {
            eprintln!(
                "the runs have different limits: no capability (choose a lot, or --low, --high)"
            );
            Limits::default()
        }
    })
}

fn table(it: &Summary, out: &mut Output) -> anyhow::Result<()> {
    let mut table = Table::new(&["param", &it.param]);
    table.row(out, vec!["n".to_owned(), it.n.to_string()])?;
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
    for (name, value) in figures {
        table.row(
            out,
            vec![
                name.to_owned(),
                value.map_or("-".to_owned(), |it| figure(Some(it))),
            ],
        )?;
    }
    Ok(table.finish(out)?)
}
