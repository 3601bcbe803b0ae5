//! `relayrig check`: collision answers for a scene, no rig.
//!
//! Exit status: 0 every move is clear, 1 a move is blocked, 2 bad input (one message, nothing on stdout).

use super::output::input;
use anyhow::{Context, anyhow, bail};
use app::exit::Exit;
use lpm::scene::{Format, MeshFault, MoveOrder, RigNames, Scene, read_moves, read_scene_of_rig};
use lpm::{Answer, ElementKey, Model, Move, Mover};
use machine::guard::{Actuator, part_names};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Collision answers for a scene and its moves, without a rig.
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
    /// Clearances are given up to this distance, mm
    #[arg(long, value_name = "MM", default_value_t = 25.0)]
    pub range: f64,
}

/// One line of the answer, as other programs read it.
#[derive(Debug, Serialize)]
struct Line<'a> {
    id: &'a str,
    verdict: &'static str,
    t_stop: Option<f64>,
    blocker: Option<&'a str>,
    clearance_mm: Option<f64>,
    at: Option<[f64; 3]>,
    normal: Option<[f64; 3]>,
}

/// Runs the command and returns [`Exit::Done`] or [`Exit::AnswerIsNo`].
///
/// # Errors
/// Bad input; the caller reports the chain and exits with 2. Nothing has been written then.
pub fn run(args: CheckArgs) -> anyhow::Result<Exit> {
    if !(args.range >= 0.0 && args.range.is_finite()) {
        bail!(
            "--range: found {}, expected a distance in mm, 0 or above",
            args.range
        );
    }
    let scene = load_scene(&args.scene)?;
    let text = read_text(&args.moves)?;
    let orders = read_moves(&text, &scene).with_context(|| args.moves.display().to_string())?;
    let (model, keys) = built(&scene)?;
    let movers = scene
        .movers
        .iter()
        .map(|mover| Mover::new(&mover.carried()).with_context(|| format!("mover {}", mover.id)))
        .collect::<anyhow::Result<Vec<Mover>>>()?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let mut exit = Exit::Done;
    for order in &orders {
        let line = answered(&model, &keys, &movers[order.mover], order, args.range);
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

fn load_scene(path: &Path) -> anyhow::Result<Scene> {
    let is = |known: &str| {
        path.extension()
            .is_some_and(|it| it.eq_ignore_ascii_case(known))
    };
    let format = if is("toml") {
        Format::Toml
    } else if is("json") {
        Format::Json
    } else {
        bail!(
            "{}: found no known extension, expected .toml or .json",
            path.display()
        )
    };
    let text = read_text(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut files = |name: &str| {
        std::fs::read(folder.join(name)).map_err(|error| MeshFault::File(error.to_string()))
    };
    let actuators = [Actuator::names().as_slice(), &Actuator::OTHER_NAMES].concat();
    let elsewhere = RigNames {
        actuators: &actuators,
        bodies: &part_names(),
    };
    read_scene_of_rig(&text, format, &mut files, &elsewhere)
        .with_context(|| path.display().to_string())
}

fn read_text(path: &Path) -> anyhow::Result<String> {
    let read = input(path).and_then(std::io::read_to_string);
    read.map_err(|error| anyhow!("{}: not readable: {error}", path.display()))
}

fn built(scene: &Scene) -> anyhow::Result<(Model, Vec<ElementKey>)> {
    let elements = scene.elements.iter();
    let model = Model::of(elements.map(|it| (it.id.as_str(), &it.shape, &it.pose)));
    let model = model.map_err(|(number, flaw)| {
        anyhow!(flaw).context(format!("element {}", scene.elements[number].id))
    })?;
    let keys = model.keys().collect();
    Ok((model, keys))
}

fn answered<'a>(
    model: &'a Model,
    keys: &[ElementKey],
    mover: &Mover,
    order: &'a MoveOrder,
    range_mm: f64,
) -> Line<'a> {
    let ignore: Vec<ElementKey> = order.ignore.iter().map(|element| keys[*element]).collect();
    let way = Move {
        from: order.from,
        to: order.to,
        margin_mm: order.margin_mm,
        ignore: &ignore,
    };
    let clearance_mm = model
        .clearance(mover, &way, range_mm)
        .map(|least| least.distance_mm);
    let contact = match model.first_contact(mover, &way) {
        Answer::Clear => None,
        Answer::Blocked(contact) => Some(contact),
    };
    Line {
        id: &order.id,
        verdict: if contact.is_some() {
            "blocked"
        } else {
            "clear"
        },
        t_stop: contact.map(|contact| contact.t_stop),
        blocker: contact.map(|contact| model.id(contact.blocker)),
        clearance_mm,
        at: contact.map(|contact| contact.at),
        normal: contact.map(|contact| contact.normal),
    }
}

fn written(out: &mut impl Write, line: &Line, json: bool) -> std::io::Result<()> {
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
