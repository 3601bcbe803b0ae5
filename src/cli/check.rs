//! `relayrig check`: tells whether moves in a scene collide; needs no rig.
//!
//! Exit status: 0 every move is clear, 1 a move is blocked, 2 bad input (one message, nothing on stdout).

use super::output::input;
use anyhow::{Context, anyhow, bail};
use app::collision::{LoadedScene, MoveAnswer};
use app::exit::Exit;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Tells whether moves in a scene collide, without a rig.
#[derive(Debug, clap::Args)]
#[command(after_help = r#"Examples:
  echo '{"elements": [{"id": "pin", "kind": "cylinder", "radius": 4, "height": 30}],
         "movers": [{"id": "jaw", "kind": "block", "half": [1, 2, 3]}]}' > scene.json
  echo '{"id": "m1", "mover": "jaw", "from": {"position": [-20, 0, 0]}, "to": {}}' > moves.jsonl
  relayrig check --scene scene.json --moves moves.jsonl
  relayrig check --scene scene.json --moves - --json < moves.jsonl

Rules of pairs and strokes of actuators are the guard's: they are checked, and not applied here.

A stop is never late. It is early by less than 1e-6 mm; by up to 1e-4 mm, within a metre, where a
round body that is turned, tilted or kept with a margin is only grazed; by up to 1e-3 mm on a
turning move.

Exit status: 0 every move is clear, 1 a move is blocked, 2 bad input."#)]
pub struct CheckArgs {
    /// Scene, TOML or JSON by its extension
    #[arg(long, value_name = "FILE")]
    pub scene: PathBuf,
    /// Moves, one JSON object per line; `-` reads standard input
    #[arg(long, value_name = "FILE")]
    pub moves: PathBuf,
    /// One JSON object per move instead of text
    #[arg(long)]
    pub json: bool,
    /// Largest clearance to report, mm
    #[arg(long, value_name = "MM", default_value_t = 25.0)]
    pub range: f64,
}

/// Runs the command and returns [`Exit::Done`] or [`Exit::AnswerIsNo`].
///
/// # Errors
/// Fails on bad input before any output; the caller reports the chain and exits with 2.
pub fn run(args: CheckArgs) -> anyhow::Result<Exit> {
    if !(args.range >= 0.0 && args.range.is_finite()) {
        bail!(
            "--range: found {}, expected a distance in mm, 0 or above",
            args.range
        );
    }
    let scene = LoadedScene::load(&args.scene)?;
    let text = read_text(&args.moves)?;
    let named = || args.moves.display().to_string();
    let orders = scene.moves(&text).with_context(named)?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let mut exit = Exit::Done;
    for order in &orders {
        let line = scene.answer(order, args.range);
        if line.verdict == "blocked" {
            exit = Exit::AnswerIsNo;
        }
        match written(&mut out, &line, args.json) {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => return Ok(exit),
            other => other.context("writing the answers")?,
        }
    }
    Ok(exit)
}

fn read_text(path: &Path) -> anyhow::Result<String> {
    let read = input(path).and_then(std::io::read_to_string);
    read.map_err(|error| anyhow!("{}: not readable: {error}", path.display()))
}

fn written(out: &mut impl Write, line: &MoveAnswer, json: bool) -> std::io::Result<()> {
    if json {
        serde_json::to_writer(&mut *out, line)?;
        return writeln!(out);
    }
    let clearance = line
        .clearance_mm
        .map_or("beyond range".to_owned(), |mm| format!("{mm:.6} mm"));
    match (line.t_stop, line.blocker, line.at) {
        (Some(t), Some(blocker), Some([x, y, z])) => writeln!(
            out,
            "{}  blocked by {blocker} at {t:.6} of the move, near [{x:.3}, {y:.3}, {z:.3}], least distance {clearance}",
            line.id
        ),
        _ => writeln!(out, "{}  clear, least distance {clearance}", line.id),
    }
}
