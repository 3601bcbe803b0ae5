//! Reads bodies and poses of a scene.

use super::field::{Field, SceneError, Table, refuse};
use super::mesh_file::{self, MeshFiles};
use super::node::shown;
use crate::shape::DEEPEST_COMPOUND;
use crate::{Flaw, LARGEST_COORDINATE_MM, Mesh, Pose, Shape};

const KINDS: &str = "\"block\", \"cylinder\", \"compound\" or \"mesh\"";

/// Returns the keys that a body of this kind may have, and the `extra` keys that its place in the file allows; `None`
/// for an unknown kind.
fn keys<'a>(kind: &str, extra: &[&'a str]) -> Option<Vec<&'a str>> {
    let own: &[&str] = match kind {
        "block" => &["kind", "half", "pose"],
        "cylinder" => &["kind", "radius", "height", "pose"],
        "compound" => &["kind", "parts", "pose"],
        "mesh" => &["kind", "file", "scale", "vertices", "triangles", "pose"],
        _ => return None,
    };
    Some([own, extra].concat())
}

/// Reads a body and its pose; the table may also hold the `extra` keys.
pub(super) fn body<'a>(
    field: &Field<'a>,
    extra: &[&str],
    files: &mut MeshFiles,
) -> Result<(Shape, Pose, Table<'a>), SceneError> {
    nested(field, extra, files, 0)
}

fn nested<'a>(
    field: &Field<'a>,
    extra: &[&str],
    files: &mut MeshFiles,
    depth: usize,
) -> Result<(Shape, Pose, Table<'a>), SceneError> {
    let kind = kind_of(field)?;
    let Some(known) = keys(kind.1, extra) else {
        return kind.0.refuse(KINDS);
    };
    let table = field.table(&known)?;
    let shape = match kind.1 {
        "block" => Shape::Block {
            half: table.required("half", "three half extents")?.numbers()?,
        },
        "cylinder" => Shape::Cylinder {
            radius: table.required("radius", "a radius in mm")?.number()?,
            height: table.required("height", "a height in mm")?.number()?,
        },
        "compound" => Shape::Compound(parts(&table, files, depth)?),
        _ => Shape::Mesh(mesh(&table, field, files)?),
    };
    located(shape.check(), field)?;
    let pose = table
        .optional("pose")
        .map_or(Ok(Pose::IDENTITY), |at| pose(&at))?;
    Ok((shape, pose, table))
}

fn kind_of<'a>(field: &Field<'a>) -> Result<(Field<'a>, &'a str), SceneError> {
    let super::node::Node::Table(members) = field.node else {
        return field.refuse("a body");
    };
    let Some((_, node)) = members.iter().find(|(key, _)| key == "kind") else {
        return refuse(field.below("kind"), "nothing".into(), KINDS);
    };
    let kind = Field {
        node,
        path: field.below("kind"),
    };
    let text = kind.text()?;
    Ok((kind, text))
}

fn parts(
    table: &Table,
    files: &mut MeshFiles,
    depth: usize,
) -> Result<Vec<(Pose, Shape)>, SceneError> {
    let list = table.required("parts", "a list of bodies")?;
    if depth >= DEEPEST_COMPOUND {
        return list.refuse("compounds nested at most 16 deep");
    }
    let mut parts = Vec::new();
    for part in list.list()? {
        let (shape, pose, _) = nested(&part, &[], files, depth + 1)?;
        parts.push((pose, shape));
    }
    Ok(parts)
}

/// Reads `{position, rotation}`; both are optional.
pub(super) fn pose(field: &Field) -> Result<Pose, SceneError> {
    let table = field.table(&["position", "rotation"])?;
    let mut pose = Pose::IDENTITY;
    if let Some(position) = table.optional("position") {
        pose.position = position.numbers()?;
    }
    if let Some(rotation) = table.optional("rotation") {
        pose.rotation = rotation.numbers()?;
    }
    let pose = pose.rescaled();
    located(pose.check(), field)?;
    Ok(pose)
}

/// Converts a [`Flaw`] of a body into a [`SceneError`] whose path begins with that of the body.
pub(super) fn located(checked: Result<(), Flaw>, field: &Field) -> Result<(), SceneError> {
    let Err(flaw) = checked else { return Ok(()) };
    let (path, found, expected) = match flaw {
        Flaw::Size { path, found } => (
            path,
            shown(found),
            "a size above 0 and at most 1e6 mm".to_owned(),
        ),
        Flaw::Coordinate { path, found } => (
            path,
            shown(found),
            format!("a coordinate within +-{LARGEST_COORDINATE_MM} mm"),
        ),
        Flaw::Rotation { path, found } => (
            path,
            format!("{found:?}"),
            "a non-zero quaternion [w, x, y, z]".into(),
        ),
        Flaw::Index {
            path,
            found,
            vertices,
        } => (
            path,
            found.to_string(),
            format!("an index below the {vertices} vertices"),
        ),
        Flaw::Structure {
            path,
            found,
            expected,
        } => (path, found.to_owned(), expected.to_owned()),
    };
    refuse(field.below(&path), found, expected)
}

fn mesh(table: &Table, field: &Field, files: &mut MeshFiles) -> Result<Mesh, SceneError> {
    if let Some(file) = table.optional("file") {
        for key in ["vertices", "triangles"] {
            if let Some(inline) = table.optional(key) {
                return inline.refuse("either a file or an inline mesh");
            }
        }
        let scale = table
            .optional("scale")
            .map_or(Ok(1.0), |scale| positive(&scale))?;
        return mesh_file::load(&file, scale, files);
    }
    if let Some(scale) = table.optional("scale") {
        return scale.refuse("no scale on an inline mesh");
    }
    let vertices = table
        .required("vertices", "a file, or vertices and triangles")?
        .list()?;
    let triangles = table
        .required(
            "triangles",
            &format!("triangles for the mesh {}", field.path),
        )?
        .list()?;
    Ok(Mesh {
        vertices: vertices
            .iter()
            .map(Field::numbers)
            .collect::<Result<_, _>>()?,
        triangles: triangles.iter().map(corners).collect::<Result<_, _>>()?,
    })
}

fn positive(field: &Field) -> Result<f64, SceneError> {
    let number = field.number()?;
    if number > 0.0 {
        Ok(number)
    } else {
        field.refuse("a scale above 0")
    }
}

fn corners(field: &Field) -> Result<[usize; 3], SceneError> {
    let members = field.list()?;
    if members.len() != 3 {
        return field.refuse("three vertex numbers");
    }
    let mut corners = [0; 3];
    for (corner, member) in corners.iter_mut().zip(&members) {
        let number = member.number()?;
        if number < 0.0 || number.fract() != 0.0 || number > f64::from(u32::MAX) {
            return member.refuse("a vertex number, 0 or above");
        }
        *corner = number as usize;
    }
    Ok(corners)
}
