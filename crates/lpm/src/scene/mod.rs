//! Reads scenes and moves from text: named bodies, and the moves to check.
//!
//! A scene is TOML, or JSON of the same structure; a move file has one JSON object per line. The whole text is read and
//! checked before any question is answered. Every error names the path of the field (`elements[0].half[1]`, in move
//! files after the line number), the value found and the value expected. This module opens no file: a function of the
//! caller supplies mesh files.
//!
//! The reader checks the parts that only the rig needs (`rides`, `[[actuator]]`, `[[pair]]`, `[[mate]]`, `[guard]`),
//! but does not apply them.

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
pub use rig::RigNames;

use super::{Pose, Shape};
use field::{Field, refuse};
use std::collections::HashSet;

/// Format of a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// TOML, for files named `*.toml`.
    Toml,
    /// JSON, for files named `*.json`.
    Json,
}

/// A body with its name and pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Name, unique among the elements or among the movers.
    pub id: String,
    /// Shape of the body, checked.
    pub shape: Shape,
    /// Pose of the body; for a mover, its pose in the moving frame.
    pub pose: Pose,
    /// Actuator that carries the body, if the scene names one.
    pub rides: Option<String>,
}

/// A scene: stationary bodies and movers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Stationary bodies in the order of the file.
    pub elements: Vec<Named>,
    /// Movers: the bodies that moves may name.
    pub movers: Vec<Named>,
}

impl Named {
    /// Returns the shape with the pose of the body applied, in the frame that moves.
    pub fn carried(&self) -> Shape {
        if self.pose == Pose::IDENTITY {
            self.shape.clone()
        } else {
            Shape::Compound(vec![(self.pose, self.shape.clone())])
        }
    }
}

/// Reads and checks a scene that refers to nothing outside itself; `files` supplies its mesh files.
///
/// # Errors
/// Fails with the first [`SceneError`]: bodies in the order of the file come first, then the parts for the rig.
pub fn read_scene(text: &str, format: Format, files: &mut MeshFiles) -> Result<Scene, SceneError> {
    read_scene_of_rig(text, format, files, &RigNames::default())
}

/// Reads and checks a scene that may also refer to actuators and bodies of its rig; `rig_names` lists these.
///
/// # Errors
/// Fails as [`read_scene`] does.
pub fn read_scene_of_rig(
    text: &str,
    format: Format,
    files: &mut MeshFiles,
    rig_names: &RigNames,
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
    rig::check(&table, &scene, rig_names)?;
    Ok(scene)
}

/// Removes the byte order mark that some editors put at the beginning of a file.
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
