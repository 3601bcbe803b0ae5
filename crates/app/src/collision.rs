//! Answers whether moves collide with the bodies of a scene file; needs no rig.

use anyhow::{Context, anyhow, bail};
use lpm::scene::{Format, MeshFault, MoveOrder, RigNames, Scene, read_moves, read_scene_of_rig};
use lpm::{Answer, ElementKey, Model, Move, Mover};
use machine::guard::{Actuator, part_names};
use serde::Serialize;
use std::path::Path;

/// Answer about one move.
#[derive(Debug, Serialize)]
pub struct MoveAnswer<'a> {
    /// Name of the move.
    pub id: &'a str,
    /// `clear` or `blocked`.
    pub verdict: &'static str,
    /// Fraction of the move, 0 to 1 and rounded down, at which the distance falls to the safety margin; `None` when the
    /// move is clear.
    pub t_stop: Option<f64>,
    /// Element that stops the move at `t_stop`.
    pub blocker: Option<&'a str>,
    /// Least distance over the whole move, mm; `None` when this distance exceeds the range of the search.
    pub clearance_mm: Option<f64>,
    /// Nearest point of the blocker at `t_stop`, mm.
    pub at: Option<[f64; 3]>,
    /// Unit vector from the blocker to the mover at `t_stop`.
    pub normal: Option<[f64; 3]>,
}

/// A loaded scene with its movers.
pub struct LoadedScene {
    scene: Scene,
    model: Model,
    keys: Vec<ElementKey>,
    movers: Vec<Mover>,
}

impl LoadedScene {
    /// Loads a scene file; the extension selects TOML or JSON.
    ///
    /// # Errors
    /// Fails on an invalid file; the error names the file and the path of the field.
    pub fn load(path: &Path) -> anyhow::Result<Self> {
        let (scene, _, _) = load_scene(path)?;
        let (model, keys) = built(&scene)?;
        let movers = scene.movers.iter().map(|mover| {
            Mover::new(&mover.carried()).with_context(|| format!("mover {}", mover.id))
        });
        let movers = movers.collect::<anyhow::Result<_>>()?;
        Ok(Self {
            scene,
            model,
            keys,
            movers,
        })
    }

    /// Reads moves, one JSON object per line.
    ///
    /// # Errors
    /// Fails on an invalid move; the error names the line and the path of the field.
    pub fn moves(&self, text: &str) -> anyhow::Result<Vec<MoveOrder>> {
        Ok(read_moves(text, &self.scene)?)
    }

    /// Answers about one move; finds clearances up to `range_mm` millimetres.
    pub fn answer<'a>(&'a self, order: &'a MoveOrder, range_mm: f64) -> MoveAnswer<'a> {
        let mover = &self.movers[order.mover];
        let ignore: Vec<ElementKey> = order
            .ignore
            .iter()
            .map(|element| self.keys[*element])
            .collect();
        let way = Move {
            from: order.from,
            to: order.to,
            margin_mm: order.margin_mm,
            ignore: &ignore,
        };
        let clearance_mm = self
            .model
            .clearance(mover, &way, range_mm)
            .map(|least| least.distance_mm);
        let contact = match self.model.first_contact(mover, &way) {
            Answer::Clear => None,
            Answer::Blocked(contact) => Some(contact),
        };
        MoveAnswer {
            id: &order.id,
            verdict: if contact.is_some() {
                "blocked"
            } else {
                "clear"
            },
            t_stop: contact.map(|contact| contact.t_stop),
            blocker: contact.map(|contact| self.model.id(contact.blocker)),
            clearance_mm,
            at: contact.map(|contact| contact.at),
            normal: contact.map(|contact| contact.normal),
        }
    }
}

/// Loads a scene file and returns it with its text and format; the extension selects TOML or JSON.
pub(crate) fn load_scene(path: &Path) -> anyhow::Result<(Scene, String, Format)> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| anyhow!("{}: not readable: {error}", path.display()))?;
    let (scene, format) = read_scene(path, &text)?;
    Ok((scene, text, format))
}

/// Reads the text of the scene file `path`; the folder of the file holds its meshes.
pub(crate) fn read_scene(path: &Path, text: &str) -> anyhow::Result<(Scene, Format)> {
    let format = format_of(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut files = |name: &str| {
        std::fs::read(folder.join(name)).map_err(|error| MeshFault::File(error.to_string()))
    };
    let actuators = [Actuator::names().as_slice(), &Actuator::OTHER_NAMES].concat();
    let elsewhere = RigNames {
        actuators: &actuators,
        bodies: &part_names(),
    };
    let scene = read_scene_of_rig(text, format, &mut files, &elsewhere)
        .with_context(|| path.display().to_string())?;
    Ok((scene, format))
}

fn format_of(path: &Path) -> anyhow::Result<Format> {
    let is = |known: &str| {
        path.extension()
            .is_some_and(|it| it.eq_ignore_ascii_case(known))
    };
    if is("toml") {
        Ok(Format::Toml)
    } else if is("json") {
        Ok(Format::Json)
    } else {
        bail!(
            "{}: found no known extension, expected .toml or .json",
            path.display()
        )
    }
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
