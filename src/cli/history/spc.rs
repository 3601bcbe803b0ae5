//! `history spc`: control charts of a parameter, or of the share of each bin from lot to lot.

use super::filter::{PartArgs, known_parameter};
use super::output::{Output, Table, figure};
use super::paper::PaperArgs;
use crate::history::{Archive, Filter, LotSummary};
use crate::quality::chart::{Chart, individuals, shares, subgroups};
use crate::quality::rules::Rules;
use crate::report::spc::{Named, spc};
use clap::{Args, ValueEnum};
use std::collections::BTreeSet;
use std::io::Write;

#[derive(Debug, Clone, Copy, ValueEnum)]
enum RuleSet {
    /// Nelson, rules 1 to 8
    Nelson,
    /// Western Electric
    WesternElectric,
}

#[derive(Debug, Args)]
pub(super) struct SpcArgs {
    /// Parameter key; without it the share of every bin is charted, run by run
    #[arg(long, value_name = "KEY")]
    param: Option<String>,
    #[command(flatten)]
    parts: PartArgs,
    /// Parts of a subgroup: 1 is individuals and moving range, 2 to 10 means and ranges
    #[arg(long, value_name = "N", default_value_t = 1, requires = "param",
        value_parser = clap::value_parser!(u8).range(1..=10))]
    subgroup: u8,
    /// Rules of runs
    #[arg(long, value_enum, default_value = "nelson")]
    rules: RuleSet,
    /// How many of the last points are drawn; limits come from all
    #[arg(long, value_name = "N", default_value_t = 200)]
    last: usize,
    /// One JSON object per chart
    #[arg(long, conflicts_with = "page")]
    json: bool,
    /// A page with the charts for the wall instead of a table; see --out and --lang
    #[arg(long)]
    page: bool,
    #[command(flatten)]
    paper: PaperArgs,
}

pub(super) fn run(archive: &Archive, args: &SpcArgs) -> anyhow::Result<()> {
    let filter = args.parts.filter();
    let runs = archive.lots(&filter)?;
    let charts = match &args.param {
        Some(param) => of_parameter(archive, args, param, &filter)?,
        None => of_bins(&runs),
    };
    anyhow::ensure!(!charts.is_empty(), "too few parts for a control chart");
    let names = match &args.param {
        Some(_) => Vec::new(),
        None => runs
            .iter()
            .map(|run| format!("{}/{}", run.lot, run.run))
            .collect(),
    };
    if args.page {
        let named: Vec<Named<'_>> = charts
            .iter()
            .map(|(title, chart)| Named {
                title: title.clone(),
                chart,
                names: &names,
            })
            .collect();
        let about = filter.lot.clone().unwrap_or_default();
        return args
            .paper
            .write(&spc(&args.paper.paper(), &about, &named, args.last));
    }
    told(&charts, args)
}

fn of_parameter(
    archive: &Archive,
    args: &SpcArgs,
    param: &str,
    filter: &Filter,
) -> anyhow::Result<Vec<(String, Chart)>> {
    known_parameter(&archive.parameters()?, param)?;
    let values = archive.values(param, filter)?.values;
    let rules = match args.rules {
        RuleSet::Nelson => Rules::Nelson,
        RuleSet::WesternElectric => Rules::WesternElectric,
    };
    let charts = match args.subgroup {
        1 => individuals(&values, rules),
        size => subgroups(&values, usize::from(size), rules),
    };
    let named = |chart| (param.to_owned(), chart);
    Ok(charts.into_iter().flatten().map(named).collect())
}

/// A chart for each bin that any of the runs has parts for.
fn of_bins(runs: &[LotSummary]) -> Vec<(String, Chart)> {
    let bins: BTreeSet<&String> = runs.iter().flat_map(|run| run.bins.keys()).collect();
    let chart = |bin: &String| {
        let groups: Vec<(u64, u64)> = runs
            .iter()
            .map(|run| (run.counts.parts, run.bins.get(bin).copied().unwrap_or(0)))
            .collect();
        shares(&groups).map(|chart| (bin.clone(), chart))
    };
    bins.into_iter().filter_map(chart).collect()
}

fn told(charts: &[(String, Chart)], args: &SpcArgs) -> anyhow::Result<()> {
    let mut out = Output::stdout();
    if args.json {
        for (of, chart) in charts {
            let mut object = serde_json::to_value(chart)?;
            object["of"] = of.as_str().into();
            out.json(&object)?;
        }
        return Ok(out.flush()?);
    }
    let header = [
        "chart", "kind", "points", "centre", "low", "high", "signals",
    ];
    let mut table = Table::new(&header);
    for (of, chart) in charts {
        let last = chart.points.last();
        let row = vec![
            of.clone(),
            chart.kind.to_owned(),
            chart.points.len().to_string(),
            figure(Some(chart.centre)),
            figure(last.map(|it| it.low)),
            figure(last.map(|it| it.high)),
            chart.signals.len().to_string(),
        ];
        table.row(&mut out, row)?;
    }
    table.finish(&mut out)?;
    for (of, chart) in charts {
        for signal in &chart.signals {
            let value = chart.points.get(signal.at).map(|it| it.value);
            writeln!(
                out,
                "{of}, {}: point {} ({}) rule {}",
                chart.kind,
                signal.at + 1,
                figure(value),
                signal.rule
            )?;
        }
    }
    Ok(out.flush()?)
}
