//! `history compare`: one parameter of several lots, with tests of equality.

use super::paper::PaperArgs;
use crate::cli::output::{Column, Output, figure};
use clap::Args;
use history::inquiry::comparison::{ComparedLot, Comparison, compare};
use history::report::comparison::comparison;
use history::{Archive, Filter};
use quality::equality::Equality;
use std::io::Write;

#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// Names of two to eight lots
    #[arg(required = true, num_args = 2..=8, value_name = "LOT")]
    lots: Vec<String>,
    /// Parameter key
    #[arg(long, value_name = "KEY")]
    param: String,
    /// One JSON object
    #[arg(long, conflicts_with = "page")]
    json: bool,
    /// An HTML page instead of text, with the histograms of all lots in one chart; see --out and --lang
    #[arg(long)]
    page: bool,
    #[command(flatten)]
    paper: PaperArgs,
}

pub(super) fn run(archive: &Archive, args: &CompareArgs) -> anyhow::Result<()> {
    let compared = compare(archive, &args.param, &args.lots)?;
    if args.page {
        let paper = args.paper.paper_of(archive, &Filter::default())?;
        return args.paper.write(&comparison(&paper, &compared));
    }
    let mut out = Output::stdout();
    match args.json {
        true => out.json(&compared)?,
        false => print(&compared, &mut out)?,
    }
    Ok(out.flush()?)
}

fn print(it: &Comparison, out: &mut Output) -> anyhow::Result<()> {
    let columns: [Column<ComparedLot>; 8] = [
        ("lot", |it| it.lot.clone()),
        ("n", |it| it.summary.n.to_string()),
        ("mean", |it| figure(it.summary.mean)),
        ("sd", |it| figure(it.summary.sd)),
        ("min", |it| figure(it.summary.min)),
        ("median", |it| figure(it.summary.median)),
        ("max", |it| figure(it.summary.max)),
        ("cpk", |it| figure(it.summary.cpk)),
    ];
    out.table(&it.lots, &columns)?;
    for (name, test) in [
        ("equal means (Welch)", it.means),
        ("equal spreads (Brown and Forsythe)", it.spreads),
    ] {
        writeln!(out, "{name}: {}", described(test))?;
    }
    Ok(())
}

fn described(test: Option<Equality>) -> String {
    let Some(Equality { f, df1, df2, p }) = test else {
        return "no test, because a lot has too few values or no spread".to_owned();
    };
    let [f, df1, df2, p] = [f, df1, df2, p].map(|it| figure(Some(it)));
    format!("F = {f} with {df1} and {df2} degrees of freedom, p = {p}")
}
