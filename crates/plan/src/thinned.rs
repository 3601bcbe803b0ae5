//! Bodies with a depth taken off their faces, so that bodies in contact can slide along each other.
//!
//! The collision core counts touching as contact, so a body that lies on another one could never move along it. Each
//! body gives up half of the contact depth on every face; two bodies then meet only where they press into each other by
//! more than the depth. Blocks, cylinders and compounds become thinner as [`Shape::less`] does it. The faces of a
//! closed mesh move inward: each corner goes to where the moved planes of its triangles meet. An open mesh has no
//! inside and stays as it is, so an open mesh in contact with another one is blocked.

use lpm::{Mesh, Shape};
use std::collections::HashMap;

/// Two normals of triangles around a corner that differ by less count as one plane.
const SAME_PLANE: f64 = 1e-6;

/// Most rounds of projections per corner.
const MOST_ROUNDS: usize = 500;

/// Returns the shape with `depth_mm` taken off every face.
pub(crate) fn thinned(shape: &Shape, depth_mm: f64) -> Shape {
    match shape {
        Shape::Block { .. } | Shape::Cylinder { .. } => shape.less(depth_mm),
        Shape::Compound(parts) => {
            let parts = parts
                .iter()
                .map(|(pose, part)| (*pose, thinned(part, depth_mm)));
            Shape::Compound(parts.collect())
        }
        Shape::Mesh(mesh) => Shape::Mesh(offset(mesh, depth_mm)),
    }
}

fn offset(mesh: &Mesh, depth_mm: f64) -> Mesh {
    if !is_closed(mesh) {
        return mesh.clone();
    }
    let outward = volume(mesh).signum();
    let mut normals: Vec<Vec<[f64; 3]>> = vec![Vec::new(); mesh.vertices.len()];
    for corners in &mesh.triangles {
        let Some(normal) = normal(mesh, corners, outward) else {
            continue;
        };
        for corner in corners {
            let known = &mut normals[*corner];
            let is_new = |it: &[f64; 3]| dot(*it, normal) < 1.0 - SAME_PLANE;
            if known.iter().all(is_new) {
                known.push(normal);
            }
        }
    }
    let moved = mesh.vertices.iter().zip(&normals).map(|(vertex, planes)| {
        let shift = inward(planes, depth_mm);
        [0, 1, 2].map(|axis| vertex[axis] + shift[axis])
    });
    Mesh {
        vertices: moved.collect(),
        triangles: mesh.triangles.clone(),
    }
}

/// Returns true when every edge of the mesh has one triangle on each side.
fn is_closed(mesh: &Mesh) -> bool {
    let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
    for corners in &mesh.triangles {
        for at in 0..3 {
            let (from, to) = (corners[at], corners[(at + 1) % 3]);
            let turn = if from < to { 1 } else { 1 << 16 };
            *edges.entry((from.min(to), from.max(to))).or_default() += turn;
        }
    }
    edges.values().all(|uses| *uses == 1 + (1 << 16))
}

/// Returns six times the volume; negative when the triangles face inward.
fn volume(mesh: &Mesh) -> f64 {
    let Some(origin) = mesh.vertices.first() else {
        return 0.0;
    };
    let cone = |corners: &[usize; 3]| {
        let [a, b, c] = corners.map(|at| sub(mesh.vertices[at], *origin));
        dot(cross(a, b), c)
    };
    mesh.triangles.iter().map(cone).sum()
}

fn normal(mesh: &Mesh, corners: &[usize; 3], outward: f64) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(|at| mesh.vertices[at]);
    let n = cross(sub(b, a), sub(c, a));
    let size = dot(n, n).sqrt();
    (size > 0.0).then(|| n.map(|member| outward * member / size))
}

/// Returns a short shift that brings a corner inside each of its planes by the depth, as nearly as possible.
///
/// Projects onto one plane after the other; neighbouring planes of a hole with 24 sides are 15 degrees apart, which
/// shrinks the rest by 7 % a round.
fn inward(planes: &[[f64; 3]], depth_mm: f64) -> [f64; 3] {
    let mut shift = [0.0; 3];
    for _ in 0..MOST_ROUNDS {
        let mut worst = 0.0_f64;
        for normal in planes {
            let missing = dot(*normal, shift) + depth_mm;
            if missing > 0.0 {
                shift = [0, 1, 2].map(|axis| shift[axis] - missing * normal[axis]);
                worst = worst.max(missing);
            }
        }
        if worst <= 1e-9 * depth_mm {
            break;
        }
    }
    shift
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wedge over the unit square in x and y whose roof rises with x, its triangles facing outward.
    fn wedge() -> Mesh {
        Mesh {
            vertices: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 0.0, 1.0],
                [0.0, 1.0, 0.0],
                [1.0, 1.0, 0.0],
                [1.0, 1.0, 1.0],
            ],
            triangles: vec![
                [0, 1, 2],
                [3, 5, 4],
                [0, 3, 4],
                [0, 4, 1],
                [1, 4, 5],
                [1, 5, 2],
                [0, 2, 5],
                [0, 5, 3],
            ],
        }
    }

    #[test]
    fn the_roof_of_a_wedge_moves_inward_by_the_depth() {
        let depth_mm = 1e-3;
        for flipped in [false, true] {
            let mut mesh = wedge();
            if flipped {
                mesh.triangles
                    .iter_mut()
                    .for_each(|corners| corners.swap(0, 1));
            }
            let thin = offset(&mesh, depth_mm);
            for (before, after) in mesh.vertices.iter().zip(&thin.vertices) {
                let roof = |v: &[f64; 3]| (v[0] - v[2]) / 2.0_f64.sqrt();
                let wanted = roof(before).max(depth_mm);
                if roof(before) == 0.0 {
                    assert!((roof(after) - wanted).abs() < 1e-9, "{before:?} {after:?}");
                }
                assert!(after[1] > 0.9 * depth_mm && after[1] < 1.0 - 0.9 * depth_mm);
            }
        }
    }

    #[test]
    fn an_open_mesh_keeps_its_corners() {
        let mut mesh = wedge();
        mesh.triangles.pop();
        assert_eq!(offset(&mesh, 0.1), mesh);
    }
}
