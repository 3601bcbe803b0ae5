//! `relayrig doctor`: what is wrong with an installation, and what to do.

use super::output::{Output, typed};
use super::rig::port;
use super::{installed, unless_pipe_closed};
use app::doctor::{Finding, Health, Installation, examine};
use app::exit::Exit;
use app::order::Files;
use app::source::LinePort;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Examines an installation.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig doctor
  relayrig --config config --db relayrig.db doctor --line measure=/dev/ttyUSB0 --json

The rig may work meanwhile: no port is opened and nothing is written.

Exit status: 0 no fault (warnings at most), 1 at least one fault.")]
pub struct DoctorArgs {
    /// Port of a line instead of the one in rig.toml
    #[arg(long, value_name = "NAME=PORT", conflicts_with = "sim")]
    pub line: Vec<String>,
    /// Check for the simulated rig: no ports, no calibration
    #[arg(long)]
    pub sim: bool,
    /// Folder of the backups [default: /var/backups/relayrig of an installed rig]
    #[arg(long, value_name = "DIR")]
    pub backups: Option<PathBuf>,
    /// One JSON object per finding, then a summary
    #[arg(long)]
    pub json: bool,
}

/// Runs `relayrig doctor`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: &DoctorArgs) -> anyhow::Result<Exit> {
    let lines: Vec<LinePort> = args.line.iter().map(port).collect::<anyhow::Result<_>>()?;
    let is_installed = files.db == Path::new(installed::HISTORY);
    let usual = is_installed.then(|| installed::BACKUPS.into());
    let backups = args.backups.clone().or(usual);
    let found = examine(&Installation {
        files,
        lines: (!args.sim).then_some(lines.as_slice()),
        backups: backups.as_deref(),
    });
    let count = |health| found.iter().filter(|it| it.health == health).count();
    let [ok, unknown, warnings, faults] =
        [Health::Ok, Health::Unknown, Health::Warning, Health::Fault].map(count);
    let summary = match args.json {
        true => json!({"type": "summary", "ok": ok, "unknown": unknown, "warning": warnings, "fault": faults})
            .to_string(),
        false => format!("faults {faults}, warnings {warnings}, not checked {unknown}, ok {ok}"),
    };
    unless_pipe_closed(print(&found, &summary, args.json), ())?;
    Ok(match faults {
        0 => Exit::Done,
        _ => Exit::AnswerIsNo,
    })
}

fn print(found: &[Finding], summary: &str, as_json: bool) -> anyhow::Result<()> {
    let mut out = Output::stdout();
    out.lines(as_json, found, |it| typed("check", it), Finding::to_string)?;
    Ok(out.line(summary)?)
}
