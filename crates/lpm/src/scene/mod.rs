//! Scenes and moves as text: bodies with names, and the ways they should go.
//!
//! A scene is TOML or JSON of the same form; a move file is one JSON object per line. Everything is
//! read and checked before anything is answered. Every complaint names the path of the field
//! (`elements[0].half[1]`, in move files behind the number of the line), what was found and what was
//! expected. No file is opened here: mesh files come through a callback.
//!
//! What only the rig needs (`rides`, `[[actuator]]`, `[[pair]]`, `[[mate]]`, `[guard]`) is checked and not applied.

mod body;
mod face;
mod field;
mod mesh_file;
mod moves;
mod node;
mod obj;
mod rig;
mod stl;
#[cfg(test)]
mod tests;

pub use field::SceneError;
pub use mesh_file::{MeshFault, MeshFiles};
pub use moves::{MoveOrder, read_moves};
pub use node::{At, Unreadable};
pub use rig::Elsewhere;

use super::{Pose, Shape};
use field::{Field, refuse};
use std::collections::HashSet;

/// Form of a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `*.toml`
    Toml,
    /// `*.json`
    Json,
}

/// A body with its name and place.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Unique among its kind (elements or movers).
    pub id: String,
    /// The checked body.
    pub shape: Shape,
    /// Where it stands; of a mover: its place in the frame that moves.
    pub pose: Pose,
    /// Actuator it rides on, if the scene says so.
    pub rides: Option<String>,
}

/// What stands and what may move.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Standing bodies in the order of the file.
    pub elements: Vec<Named>,
    /// Bodies that moves name.
    pub movers: Vec<Named>,
}

impl Named {
    /// The body with its pose folded in: what moves when its frame moves.
    pub fn carried(&self) -> Shape {
        if self.pose == Pose::IDENTITY {
            self.shape.clone()
        } else {
            Shape::Compound(vec![(self.pose, self.shape.clone())])
        }
    }
}

/// Reads and checks a whole scene that names nothing but what it describes.
///
/// # Errors
/// The first [`SceneError`]: bodies in the order of the file, then what the rig needs.
pub fn read_scene(text: &str, format: Format, files: &mut MeshFiles) -> Result<Scene, SceneError> {
    read_scene_of_rig(text, format, files, &Elsewhere::default())
}

/// The same of a scene that may also name what its rig has `elsewhere`.
///
/// # Errors
/// As [`read_scene`].
pub fn read_scene_of_rig(
    text: &str,
    format: Format,
    files: &mut MeshFiles,
    elsewhere: &Elsewhere,
) -> Result<Scene, SceneError> {
    let text = without_mark(text);
    let read = match format {
        Format::Toml => node::from_toml(text),
        Format::Json => node::from_json(text),
    };
    let node = read.map_err(|cause| SceneError::Syntax {
        place: String::new(),
        cause,
    })?;
    let root = Field {
        node: &node,
        path: String::new(),
    };
    let table = root.table(&[
        "units", "elements", "movers", "actuator", "pair", "mate", "guard",
    ])?;
    if let Some(units) = table.optional("units")
        && units.text()? != "mm"
    {
        return units.refuse("\"mm\"");
    }
    let elements = table
        .optional("elements")
        .map_or(Ok(Vec::new()), |list| named(&list, files))?;
    let movers = table
        .optional("movers")
        .map_or(Ok(Vec::new()), |list| named(&list, files))?;
    let scene = Scene { elements, movers };
    rig::check(&table, &scene, elsewhere)?;
    Ok(scene)
}

/// Some editors begin a file with a byte order mark.
fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

fn named(list: &Field, files: &mut MeshFiles) -> Result<Vec<Named>, SceneError> {
    let mut known = HashSet::new();
    let mut bodies = Vec::new();
    for field in list.list()? {
        let (shape, pose, table) = body::body(&field, &["id", "rides"], files)?;
        let id = table.required("id", "a name")?;
        if !known.insert(id.text()?) {
            return refuse(
                id.path.clone(),
                format!("{} again", id.node),
                "a name that no other body has",
            );
        }
        let rides = table
            .optional("rides")
            .map(|rides| rides.text().map(str::to_owned))
            .transpose()?;
        bodies.push(Named {
            id: id.text()?.to_owned(),
            shape,
            pose,
            rides,
        });
    }
    Ok(bodies)
}
