//! `history spc`: control charts of a parameter, or of the share of each bin from lot to lot.

use super::filter::PartArgs;
use super::paper::PaperArgs;
use crate::cli::output::{Column, Output, figure};
use clap::{Args, ValueEnum};
use history::Archive;
use history::inquiry::charts::{self, Charted, SUBGROUPS};
use quality::rules::Rules;
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
    /// Parameter key; when absent, charts the share of every bin, run by run
    #[arg(long, value_name = "KEY")]
    param: Option<String>,
    #[command(flatten)]
    parts: PartArgs,
    /// Parts of a subgroup: 1 charts individuals and moving ranges, 2 to 10 means and ranges
    #[arg(long, value_name = "N", default_value_t = 1, requires = "param",
        value_parser = clap::value_parser!(u8).range(i64::from(*SUBGROUPS.start())..=i64::from(*SUBGROUPS.end())))]
    subgroup: u8,
    /// Run rules
    #[arg(long, value_enum, default_value = "nelson")]
    rules: RuleSet,
    /// Draw the last N points; the control limits come from all points
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
    let rules = match args.rules {
        RuleSet::Nelson => Rules::Nelson,
        RuleSet::WesternElectric => Rules::WesternElectric,
    };
    let charts = charts::charts(
        archive,
        &filter,
        args.param.as_deref(),
        (args.subgroup, rules),
    )?;
    if args.page {
        let about = filter.lot.clone().unwrap_or_default();
        let paper = args.paper.paper_of(archive, &filter)?;
        return args
            .paper
            .write(&charts::page(&paper, &about, &charts, args.last));
    }
    print(&charts, args)
}

fn print(charts: &[Charted], args: &SpcArgs) -> anyhow::Result<()> {
    let mut out = Output::stdout();
    if args.json {
        charts.iter().try_for_each(|chart| out.json(chart))?;
        return Ok(out.flush()?);
    }
    let columns: [Column<Charted>; 7] = [
        ("chart", |it| it.of.clone()),
        ("kind", |it| it.chart.kind.to_owned()),
        ("points", |it| it.chart.points.len().to_string()),
        ("centre", |it| figure(Some(it.chart.centre))),
        ("low", |it| figure(it.chart.points.last().map(|it| it.low))),
        ("high", |it| {
            figure(it.chart.points.last().map(|it| it.high))
        }),
        ("signals", |it| it.chart.signals.len().to_string()),
    ];
    out.table(charts, &columns)?;
    for Charted { of, chart, .. } in charts {
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
