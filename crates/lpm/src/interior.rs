//! Enclosed spaces of a body, and points of the body that may lie inside another one.
//!
//! Triangles show where surfaces meet; this module finds a body that lies wholly inside a closed mesh.

use std::collections::BTreeSet;

use super::closed::parts;
use super::pose::{Frame, Pose};
use super::shape::Shape;
use super::solid::Solid;
use super::vector::{Vec3, add};

/// What a body has besides its pieces: enclosed spaces and test points.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interior {
    /// Closed surfaces of the body, as solids.
    pub(crate) solids: Vec<Solid>,
    /// One point of each connected part, to test whether the part lies inside another body.
    pub(crate) witnesses: Vec<Vec3>,
}

impl Interior {
    /// Builds the interior of a checked shape, in the frame of the shape. Returns `None` for a shape without a mesh:
    /// the centres of its pieces then suffice as test points ([`Interior::around`]).
    pub(crate) fn of(shape: &Shape) -> Option<Interior> {
        if !has_mesh(shape) {
            return None;
        }
        let mut interior = Interior::default();
        interior.collect(shape, &Frame::IDENTITY, [0.0; 3]);
        Some(interior)
    }

    /// Builds the interior of a body without a mesh; the test points are the centres of its pieces.
    pub(crate) fn around(witnesses: Vec<Vec3>) -> Interior {
        Interior {
            solids: Vec::new(),
            witnesses,
        }
    }

    pub(crate) fn placed(&self, frame: &Frame, position: Vec3) -> Interior {
        Interior {
            solids: self
                .solids
                .iter()
                .map(|solid| solid.placed(frame, position))
                .collect(),
            witnesses: self
                .witnesses
                .iter()
                .map(|point| add(frame.apply(*point), position))
                .collect(),
        }
    }

    /// Returns a test point of one body that lies inside the other body, although their surfaces need not meet.
    pub(crate) fn shared_with(&self, other: &Interior) -> Option<Vec3> {
        let inside = |solids: &[Solid], points: &[Vec3]| {
            let held = |point: &&Vec3| solids.iter().any(|solid| solid.holds(**point));
            if solids.is_empty() {
                None
            } else {
                points.iter().find(held).copied()
            }
        };
        inside(&self.solids, &other.witnesses).or_else(|| inside(&other.solids, &self.witnesses))
    }

    fn collect(&mut self, shape: &Shape, frame: &Frame, origin: Vec3) {
        match shape {
            Shape::Block { .. } | Shape::Cylinder { .. } => self.witnesses.push(origin),
            Shape::Compound(parts) => {
                for (Pose { position, rotation }, part) in parts {
                    let place = add(frame.apply(*position), origin);
                    self.collect(part, &frame.then(&Frame::of(*rotation)), place);
                }
            }
            Shape::Mesh(mesh) => {
                let place = |vertex: usize| add(frame.apply(mesh.vertices[vertex]), origin);
                let parts = parts(mesh);
                let witnesses = parts.iter().filter_map(BTreeSet::first);
                self.witnesses
                    .extend(witnesses.map(|[vertex, ..]| place(*vertex)));
                let solid = Solid::of(&mesh.vertices, &parts);
                self.solids
                    .extend(solid.map(|solid| solid.placed(frame, origin)));
            }
        }
    }
}

fn has_mesh(shape: &Shape) -> bool {
    match shape {
        Shape::Block { .. } | Shape::Cylinder { .. } => false,
        Shape::Compound(parts) => parts.iter().any(|(_, part)| has_mesh(part)),
        Shape::Mesh(_) => true,
    }
}
