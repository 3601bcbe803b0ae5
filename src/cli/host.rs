//! `relayrig host check`: tests whether this computer keeps the timing of the rig.
//!
//! Exit status: 0 yes, 1 no, 2 bad input, 4 stopped by Ctrl-C.

use super::output::{Output, typed};
use super::table::lateness_line;
use super::unless_pipe_closed;
use anyhow::Context;
use app::doctor::Finding;
use app::exit::Exit;
use app::host_check::phase::PhaseResult;
use app::host_check::verdict::Verdict;
use app::host_check::{self, Report, histogram, plot};
use app::order::Files;
use config::Plant;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use units::Span;

/// Tests this computer.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Args {
    /// Measure how late this computer wakes the rig, as it is and under load, and compare with rig.toml
    Check(CheckArgs),
}

/// A latency test of this computer.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig host check
  relayrig host check --seconds 600 --plot lateness.svg
  relayrig --config plant2 host check --json

Waits of 1 ms on the thread and the timer of the rig; half of the time as the computer is, then under load:
two busy threads per CPU, and one that writes and syncs a temporary file beside the history. Run it as the
user of the rig, and not during a lot: the load may delay it. No port is opened.

Exit status: 0 the computer keeps the rig's time, 1 it does not, 2 bad input, 4 stopped by Ctrl-C.")]
pub struct CheckArgs {
    /// Length of the test, s
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=3600))]
    pub seconds: u64,
    /// Also draws both histograms into this file
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// One JSON object per phase and advice, then the verdict
    #[arg(long)]
    pub json: bool,
}

/// Runs `relayrig host check`.
///
/// # Errors
/// Fails on a bad configuration, or when the folder of the history or `--plot` cannot be written.
pub fn run(files: &Files, Args::Check(args): &Args) -> anyhow::Result<Exit> {
    let wiring = Plant::load(&files.config)?.wiring;
    let plot = args.plot.as_ref().map(|path| {
        let file = File::create(path);
        file.with_context(|| format!("--plot {}", path.display()))
    });
    let plot = plot.transpose()?;
    let mut out = Output::stdout();
    let span = Span::ms(args.seconds * 1000);
    let mut ended = |it: &PhaseResult| unless_pipe_closed(print_phase(&mut out, it, args.json), ());
    let Some(report) = host_check::run(&wiring, files.data_folder(), span, &mut ended)? else {
        return Ok(Exit::Stopped);
    };
    if let Some(mut file) = plot {
        let svg = plot::svg(&report.phases, report.verdict.tolerated_ms);
        file.write_all(svg.as_bytes()).context("--plot")?;
    }
    unless_pipe_closed(print(&mut out, &report, args.json), ())?;
    Ok(match report.verdict.is_kept {
        true => Exit::Done,
        false => Exit::AnswerIsNo,
    })
}

fn print_phase(out: &mut Output, it: &PhaseResult, as_json: bool) -> anyhow::Result<()> {
    if as_json {
        return Ok(out.line(&typed("phase", it).to_string())?);
    }
    out.line(&lateness_line(it.phase.name(), &it.lateness))?;
    for row in histogram::bars(&it.lateness) {
        out.line(&row)?;
    }
    let (ms, percent) = (it.cpu_time.stolen_ms, it.cpu_time.stolen_percent());
    let text = format!("stolen by the hypervisor: {ms:.0} ms ({percent:.1} %)\n");
    Ok(out.line(&text)?)
}

fn print(out: &mut Output, report: &Report, as_json: bool) -> anyhow::Result<()> {
    if !as_json {
        out.line(&verdict_text(&report.verdict))?;
    }
    out.lines(
        as_json,
        &report.advice,
        |it| typed("advice", it),
        Finding::to_string,
    )?;
    if as_json {
        out.line(&typed("verdict", &report.verdict).to_string())?;
    }
    Ok(())
}

fn verdict_text(it: &Verdict) -> String {
    let (answer, keeps) = match it.is_kept {
        true => ("yes", "keeps"),
        false => ("no", "does not keep"),
    };
    let mut text = format!(
        "verdict: {answer}, this computer {keeps} the rig's time: worst lateness {:.3} ms, tolerated {:.3} ms\n",
        it.worst_ms, it.tolerated_ms
    );
    for need in &it.needs {
        let kept = if need.is_kept { "kept" } else { "MISSED" };
        text += &format!(
            "  {}: {kept}, tolerated {:.3} ms: {}\n",
            need.key.replace('_', " "),
            need.tolerated_ms,
            need.origin
        );
    }
    text
}
