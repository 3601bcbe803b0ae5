//! Closed meshes are solid: is a point inside?
//!
//! Surfaces are compared by their triangles. Only a body that lies wholly inside a closed mesh
//! (or around it) escapes those, and then it stays there as long as no surfaces meet; so one point
//! of each connected piece, asked once at the start of a move, is enough.
//!
//! The answer counts crossings of a ray (parity does not depend on the winding of the file). A
//! ray that passes an edge or a corner within rounding is thrown away for another direction; when
//! every direction fails the point counts as inside.

use super::pose::{Frame, Pose};
use super::shape::{Mesh, Shape};
use super::vector::{Vec3, add, cross, dot, reach, sub};
use std::collections::HashMap;

/// Directions of rays, chosen without any symmetry a machine part might share.
const RAYS: [Vec3; 6] = [
    [0.842_713, 0.311_907, 0.438_851],
    [-0.237_119, 0.915_203, 0.325_741],
    [0.171_803, -0.402_917, 0.898_963],
    [-0.693_401, -0.541_177, -0.475_583],
    [0.519_683, 0.108_359, -0.847_433],
    [-0.078_511, 0.337_639, -0.938_001],
];

/// Relative rounding of one signed volume (five products and sums of differences).
const VOLUME_NOISE: f64 = 32.0 * f64::EPSILON;

/// A closed surface, in the frame of its body or placed.
#[derive(Debug, Clone)]
pub(crate) struct Solid {
    triangles: Vec<[Vec3; 3]>,
    low: Vec3,
    high: Vec3,
}

impl Solid {
    fn of(triangles: Vec<[Vec3; 3]>) -> Solid {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for corner in triangles.iter().flatten() {
            for axis in 0..3 {
                low[axis] = low[axis].min(corner[axis]);
                high[axis] = high[axis].max(corner[axis]);
            }
        }
        Solid {
            triangles,
            low,
            high,
        }
    }

    pub(crate) fn placed(&self, frame: &Frame, position: Vec3) -> Solid {
        let place = |corner: Vec3| add(frame.apply(corner), position);
        Solid::of(
            self.triangles
                .iter()
                .map(|corners| corners.map(place))
                .collect(),
        )
    }

    /// Whether the solid holds `point`; points nearer to the surface than rounding count as inside.
    pub(crate) fn holds(&self, point: Vec3) -> bool {
        let outside =
            (0..3).any(|axis| point[axis] < self.low[axis] || point[axis] > self.high[axis]);
        if outside {
            return false;
        }
        RAYS.iter()
            .find_map(|ray| self.odd_crossings(point, *ray))
            .unwrap_or(true)
    }

    fn odd_crossings(&self, point: Vec3, ray: Vec3) -> Option<bool> {
        let mut odd = false;
        for corners in &self.triangles {
            odd ^= crosses(corners.map(|corner| sub(corner, point)), ray)?;
        }
        Some(odd)
    }
}

/// Whether the ray from the origin crosses the triangle; `None` within rounding of its rim.
fn crosses([a, b, c]: [Vec3; 3], ray: Vec3) -> Option<bool> {
    let size = reach(a).max(reach(b)).max(reach(c));
    let noise = VOLUME_NOISE * size * size;
    let sides = [
        dot(cross(a, b), ray),
        dot(cross(b, c), ray),
        dot(cross(c, a), ray),
    ];
    let left = sides.iter().any(|side| *side > noise);
    let right = sides.iter().any(|side| *side < -noise);
    if left && right {
        return Some(false);
    }
    if sides.iter().any(|side| side.abs() <= noise) {
        return None;
    }
    // All on one side: the line crosses; ahead when the triangle's plane lies ahead.
    let volume = dot(cross(a, b), c);
    let ahead = volume * (sides[0] + sides[1] + sides[2]);
    if volume.abs() <= noise * size {
        None
    } else {
        Some(ahead > 0.0)
    }
}

/// What a body needs besides its pieces.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interior {
    /// Closed surfaces of the body.
    pub(crate) solids: Vec<Solid>,
    /// One point of each connected piece.
    pub(crate) witnesses: Vec<Vec3>,
}

impl Interior {
    /// Of a checked shape, in its own frame. `None` without a mesh: then the centres of the pieces
    /// are witnesses enough ([`Interior::around`]).
    pub(crate) fn of(shape: &Shape) -> Option<Interior> {
        if !has_mesh(shape) {
            return None;
        }
        let mut interior = Interior::default();
        interior.collect(shape, &Frame::IDENTITY, [0.0; 3]);
        Some(interior)
    }

    /// Of a body without a mesh, by the centres of its pieces.
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

    /// A point that lies inside the other body although no surfaces need to meet.
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
                let (welded, closed) = weld(mesh);
                self.witnesses
                    .extend(connected(mesh, &welded).into_iter().map(place));
                if closed {
                    let area =
                        |corners: &&[usize; 3]| !shrunk(corners.map(|vertex| welded[vertex]));
                    let proper = mesh.triangles.iter().filter(area);
                    self.solids.push(Solid::of(
                        proper.map(|corners| corners.map(place)).collect(),
                    ));
                }
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

/// Gives equal positions one number, and tells whether every edge is shared by an even number of
/// triangles (those shrunk to a segment or a point do not count).
fn weld(mesh: &Mesh) -> (Vec<usize>, bool) {
    let mut first = HashMap::new();
    let key = |vertex: &Vec3| vertex.map(|member| (member + 0.0).to_bits());
    let welded: Vec<usize> = mesh
        .vertices
        .iter()
        .enumerate()
        .map(|(index, vertex)| *first.entry(key(vertex)).or_insert(index))
        .collect();
    let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|vertex| welded[vertex]);
        if shrunk([a, b, c]) {
            continue;
        }
        for (p, q) in [(a, b), (b, c), (c, a)] {
            *edges.entry((p.min(q), p.max(q))).or_default() += 1;
        }
    }
    let closed = !edges.is_empty() && edges.values().all(|uses| uses % 2 == 0);
    (welded, closed)
}

/// A triangle that is only a segment or a point: it closes nothing.
fn shrunk([a, b, c]: [usize; 3]) -> bool {
    a == b || b == c || c == a
}

/// One vertex of each connected set of triangles.
fn connected(mesh: &Mesh, welded: &[usize]) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..mesh.vertices.len()).collect();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|vertex| welded[vertex]);
        for other in [b, c] {
            let (p, q) = (root(&mut parent, a), root(&mut parent, other));
            parent[p] = q;
        }
    }
    let used = mesh
        .triangles
        .iter()
        .flatten()
        .map(|vertex| welded[*vertex]);
    let mut roots: Vec<usize> = used.map(|vertex| root(&mut parent, vertex)).collect();
    roots.sort_unstable();
    roots.dedup();
    roots
}

fn root(parent: &mut [usize], mut vertex: usize) -> usize {
    while parent[vertex] != vertex {
        parent[vertex] = parent[parent[vertex]];
        vertex = parent[vertex];
    }
    vertex
}
