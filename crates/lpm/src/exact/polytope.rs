//! Contact of two convex polytopes whose corners are whole numbers.
//!
//! Two polytopes meet exactly when the vector between them lies in their Minkowski difference. This difference is
//! bounded by planes normal to their faces and normal to the cross products of their edges. Along a translation each
//! pair of parallel planes restricts the contact to an interval of time; the bodies meet in the intersection of all
//! intervals. Superfluous planes do no harm, because the difference lies between them as well.

use super::Form;
use super::times::Stretch;

type Vector = [i128; 3];

/// Corners (multiplied by `scale`), normals of the faces, and directions of the edges.
#[derive(Debug)]
pub(super) struct Polytope {
    scale: i128,
    corners: Vec<Vector>,
    normals: Vec<Vector>,
    edges: Vec<Vector>,
}

impl Polytope {
    /// Converts a form; `None` for a cylinder.
    pub(super) fn of(form: &Form) -> Option<Polytope> {
        match form {
            Form::Block { half, rotation } => Some(block(half.map(i128::from), *rotation)),
            Form::Cylinder { .. } => None,
            Form::Triangle(corners) => Some(triangle(corners.map(|it| it.map(i128::from)))),
        }
    }

    /// Returns the least and the greatest reach of the corners, times `factor`, along `axis`.
    fn reach(&self, axis: Vector, factor: i128) -> (i128, i128) {
        let mut reaches = self
            .corners
            .iter()
            .map(|corner| factor * dot(*corner, axis));
        let first = reaches.next().unwrap_or(0);
        reaches.fold((first, first), |(low, high), it| {
            (low.min(it), high.max(it))
        })
    }
}

fn block(half: Vector, rotation: [i64; 4]) -> Polytope {
    let [w, x, y, z] = rotation.map(i128::from);
    let axes = [
        [
            w * w + x * x - y * y - z * z,
            2 * (x * y + w * z),
            2 * (x * z - w * y),
        ],
        [
            2 * (x * y - w * z),
            w * w - x * x + y * y - z * z,
            2 * (y * z + w * x),
        ],
        [
            2 * (x * z + w * y),
            2 * (y * z - w * x),
            w * w - x * x - y * y + z * z,
        ],
    ];
    let corner = |index: usize| {
        let side = |axis: usize| {
            if index >> axis & 1 == 1 {
                half[axis]
            } else {
                -half[axis]
            }
        };
        [0, 1, 2].map(|member| (0..3).map(|axis| side(axis) * axes[axis][member]).sum())
    };
    Polytope {
        scale: w * w + x * x + y * y + z * z,
        corners: (0..8).map(corner).collect(),
        normals: axes.to_vec(),
        edges: axes.to_vec(),
    }
}

fn triangle(corners: [Vector; 3]) -> Polytope {
    let [a, b, c] = corners;
    let edges = vec![sub(b, a), sub(c, b), sub(a, c)];
    let normal = cross(edges[0], edges[1]);
    assert_ne!(
        normal, [0; 3],
        "a triangle that is a segment has no exact truth here"
    );
    // The rims of a flat body count as faces: their planes separate it from another body in its own plane.
    let rims = edges.iter().map(|edge| cross(*edge, normal));
    Polytope {
        scale: 1,
        corners: corners.to_vec(),
        normals: std::iter::once(normal).chain(rims).collect(),
        edges,
    }
}

/// Returns the first fraction of the move at which `b`, which lies `apart` from `a` and moves by `run`, touches `a`.
pub(super) fn first_contact(a: &Polytope, b: &Polytope, apart: Vector, run: Vector) -> Option<f64> {
    let products = a
        .edges
        .iter()
        .flat_map(|e| b.edges.iter().map(|f| cross(*e, *f)));
    let axes = a.normals.iter().chain(&b.normals).copied().chain(products);
    let common = a.scale * b.scale;
    let mut stretch = Stretch::WHOLE;
    for axis in axes {
        let (a_low, a_high) = a.reach(axis, b.scale);
        let (b_low, b_high) = b.reach(axis, a.scale);
        let (start, speed) = (common * dot(apart, axis), common * dot(run, axis));
        stretch = stretch.while_within(start, speed, a_low - b_high, a_high - b_low)?;
    }
    Some(stretch.from.value())
}

fn dot(a: Vector, b: Vector) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
