//! Runs a command of the plan and stores what it prints.

use super::Order;
use super::machine;
use super::plan::{Picture, Run};
use super::result::{Head, rows, store};
use anyhow::{Context, bail, ensure};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;
use tempfile::TempDir;

/// Word of a command that means this program.
const OWN: &str = "relayrig";

/// Runs one command of the plan; stores its figures and the pictures that it draws.
///
/// # Errors
/// Fails when the command does not start, ends with another status than 0 or 1 (a missed bar), prints no figure, or
/// lacks a picture. A failure keeps the previous result.
pub fn run(order: &Order, run: &Run) -> anyhow::Result<()> {
    let folder = TempDir::new()?;
    let busy_cores = machine::busy_cores();
    let began = Instant::now();
    let done = command(order, run, folder.path())?
        .output()
        .context(run.command.clone())?;
    let seconds = (began.elapsed().as_secs_f64() * 10.0).round() / 10.0;
    ensure!(
        matches!(done.status.code(), Some(0 | 1)),
        "{}: {}, expected exit status 0 or 1",
        run.command,
        done.status
    );
    let printed = String::from_utf8(done.stdout).context(run.command.clone())?;
    rows(&printed).with_context(|| run.command.clone())?;
    for picture in drawn(run) {
        keep(
            &folder.path().join(&picture.file),
            &order.docs.join("pictures"),
            &picture.file,
        )?;
    }
    let head = Head {
        command: run.command.clone(),
        date: jiff::Timestamp::now().strftime("%Y-%m-%d").to_string(),
        commit: machine::commit(),
        is_changed: machine::is_changed(&order.docs),
        cpu: machine::cpu(),
        cores: crate::pool::cores(),
        busy_cores: busy_cores.map(|it| (it * 100.0).round() / 100.0),
        seconds,
    };
    store(&order.docs, run, &head, &printed)
}

/// Returns the pictures that the study itself draws.
fn drawn(run: &Run) -> impl Iterator<Item = &Picture> {
    run.pictures.iter().filter(|picture| picture.plot.is_none())
}

/// Returns the command that prints the figures of a run as lines of JSON. A command of this program uses a temporary
/// history.
fn command(order: &Order, run: &Run, folder: &Path) -> anyhow::Result<Command> {
    let mut words = run.command.split_whitespace();
    let program = match words.next() {
        Some(OWN) => order.program.as_path(),
        Some(other) => Path::new(other),
        None => bail!("{}: found no command", run.name),
    };
    let mut command = Command::new(program);
    if program == order.program {
        // A run of another rig names its configuration itself.
        if !run.command.contains(" --config ") {
            command.arg("--config").arg(&order.config);
        }
        command.arg("--db").arg(folder.join("history.db"));
        command.args(["--log", "error"]);
    }
    for word in words {
        match word {
            OWN => command.arg(&order.program),
            _ => command.arg(word),
        };
    }
    if drawn(run).next().is_some() {
        command.arg("--out").arg(folder);
    }
    // The options of a benchmark come after those of cargo, separated by `--`.
    let is_bench = program == Path::new("cargo");
    if is_bench && !run.command.contains(" -- ") {
        command.arg("--");
    }
    command
        .arg("--json")
        .stdin(Stdio::null())
        .stderr(Stdio::inherit());
    Ok(command)
}

fn keep(drawn: &Path, pictures: &Path, file: &str) -> anyhow::Result<()> {
    std::fs::create_dir_all(pictures).with_context(|| pictures.display().to_string())?;
    std::fs::copy(drawn, pictures.join(file)).with_context(|| format!("picture {file}"))?;
    Ok(())
}
