//! Reads move files: one JSON object per line; blank lines are allowed.

use super::field::{Field, SceneError, Table, expected_id, refuse};
use super::node;
use super::{Named, Scene, body, without_mark};
use crate::{LARGEST_COORDINATE_MM, Pose};
use std::collections::HashSet;

/// A move from a file; it refers to mover and elements by their indices in the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveOrder {
    /// Name, unique in the file.
    pub id: String,
    /// Mover, as an index into [`Scene::movers`].
    pub mover: usize,
    /// Pose of the mover at the start.
    pub from: Pose,
    /// Pose of the mover at the end.
    pub to: Pose,
    /// Distance to every element that the mover must exceed during the move, mm, >= 0.
    pub margin_mm: f64,
    /// Elements that the check leaves out, as indices into [`Scene::elements`].
    pub ignore: Vec<usize>,
}

/// Reads and checks a whole move file for a scene.
///
/// # Errors
/// Fails with the first [`SceneError`]; its path begins with `line N: `.
pub fn read_moves(text: &str, scene: &Scene) -> Result<Vec<MoveOrder>, SceneError> {
    let mut known = HashSet::new();
    let mut orders = Vec::new();
    for (index, line) in without_mark(text).lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let place = format!("line {}: ", index + 1);
        let node = node::from_json_line(line).map_err(|cause| SceneError::Syntax {
            place: place.clone(),
            cause,
        })?;
        let order = order(
            &Field {
                node: &node,
                path: place.clone(),
            },
            scene,
        )?;
        if !known.insert(order.id.clone()) {
            let found = format!("\"{}\" again", order.id);
            return refuse(format!("{place}id"), found, "a name that no other move has");
        }
        orders.push(order);
    }
    Ok(orders)
}

fn order(line: &Field, scene: &Scene) -> Result<MoveOrder, SceneError> {
    let table = line.table(&["id", "mover", "from", "to", "margin_mm", "ignore"])?;
    let id = table.required("id", "a name")?.text()?.to_owned();
    let mover = known(
        &table.required("mover", "the id of a mover")?,
        &scene.movers,
        ["a mover of the scene", "movers"],
    )?;
    let from = body::pose(&table.required("from", "a pose {position, rotation}")?)?;
    let to = body::pose(&table.required("to", "a pose {position, rotation}")?)?;
    let margin_mm = table
        .optional("margin_mm")
        .map_or(Ok(0.0), |margin| distance(&margin))?;
    let ignore = ignored(&table, scene)?;
    Ok(MoveOrder {
        id,
        mover,
        from,
        to,
        margin_mm,
        ignore,
    })
}

fn ignored(table: &Table, scene: &Scene) -> Result<Vec<usize>, SceneError> {
    let Some(list) = table.optional("ignore") else {
        return Ok(Vec::new());
    };
    list.list()?
        .iter()
        .map(|id| known(id, &scene.elements, ["an element of the scene", "elements"]))
        .collect()
}

pub(super) fn distance(field: &Field) -> Result<f64, SceneError> {
    let number = field.number()?;
    if (0.0..=LARGEST_COORDINATE_MM).contains(&number) {
        Ok(number)
    } else {
        field.refuse("a distance of 0 to 1e6 mm")
    }
}

/// Returns the index of the body that a field names.
pub(super) fn known(
    field: &Field,
    bodies: &[Named],
    [one, many]: [&str; 2],
) -> Result<usize, SceneError> {
    let id = field.text()?;
    if let Some(index) = bodies.iter().position(|body| body.id == id) {
        return Ok(index);
    }
    let ids: Vec<&str> = bodies.iter().map(|body| body.id.as_str()).collect();
    field.refuse(expected_id(one, many, &ids))
}
