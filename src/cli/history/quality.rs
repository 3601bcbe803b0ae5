//! `quality`: figures from a file of readings, no history needed.

use crate::cli::output::{Column, Output, figure, input};
use anyhow::Context;
use app::exit::Exit;
use clap::{Args, Subcommand};
use history::inquiry::gauge::read_csv;
use quality::average_range::average_and_range;
use quality::gauge_rr::{GaugeRr, anova};
use std::io::{self, Write};
use std::path::PathBuf;

/// Arguments of `quality`.
#[derive(Debug, Args)]
pub struct QualityArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Gauge repeatability and reproducibility from columns part, operator, trial, value
    #[command(after_help = "Example: relayrig quality grr study.csv --json")]
    Grr {
        /// CSV file; - is stdin
        file: PathBuf,
        /// One JSON object
        #[arg(long)]
        json: bool,
    },
}

/// Runs `relayrig quality`; an error is bad input (exit status 2).
pub fn run_quality(args: QualityArgs) -> anyhow::Result<Exit> {
    super::super::unless_pipe_closed(dispatch(&args.command), Exit::Done)
}

fn dispatch(command: &Command) -> anyhow::Result<Exit> {
    let Command::Grr { file, json } = command;
    let name = file.display().to_string();
    let text = input(file).and_then(io::read_to_string);
    let text = text.with_context(|| format!("reading {name}"))?;
    let readings = read_csv(&text).with_context(|| name.clone())?;
    let result = anova(&readings).context(name)?;
    let mut out = Output::stdout();
    if *json {
        out.json(&result)?;
    } else {
        table(&result, &mut out)?;
        // For larger studies the average and range method has no published factors.
        if let Ok(by_ranges) = average_and_range(&readings) {
            writeln!(out)?;
            table(&by_ranges, &mut out)?;
        }
    }
    out.flush()?;
    Ok(Exit::Done)
}

fn table(it: &GaugeRr, out: &mut Output) -> anyhow::Result<()> {
    let share = |sd: f64| (it.total > 0.0).then(|| format!("{:.2}", 100.0 * sd / it.total));
    let sources = [
        ("repeatability", it.repeatability),
        ("reproducibility", it.reproducibility),
        ("interaction", it.interaction),
        ("gauge r&r", it.grr),
        ("part", it.part),
        ("total", it.total),
    ]
    .map(|(source, sd)| (source, sd, share(sd).unwrap_or_default()));
    let columns: [Column<(&str, f64, String)>; 3] = [
        (it.method, |it| it.0.to_owned()),
        ("sd", |it| figure(Some(it.1))),
        ("percent of total", |it| it.2.clone()),
    ];
    out.table(&sources, &columns)?;
    let ndc = it.ndc.map_or("unlimited".to_owned(), |ndc| ndc.to_string());
    Ok(writeln!(out, "distinct categories: {ndc}")?)
}
