//! Boxes around bodies: how far they reach along the axes of the frame.
//!
//! Boxes are rounded outward by [`ROUNDING`], so a body is never larger than its box. A body has left the space Omega
//! when its box has; the box extrusion of the paper sweeps boxes in place of bodies.

use lpm::{Pose, Shape};

/// Relative error bound of a box: some forty roundings of 2^-53, doubled.
const ROUNDING: f64 = 96.0 * f64::EPSILON / 2.0;

/// A box along the axes of the frame, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Least coordinates, mm.
    pub low: [f64; 3],
    /// Greatest coordinates, mm.
    pub high: [f64; 3],
}

/// Columns of a rotation: the images of x, y and z.
type Columns = [[f64; 3]; 3];

const UNTURNED: Columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Extent {
    /// A box that contains nothing; joined with another box it gives that box.
    pub const NOTHING: Extent = Extent {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    /// Returns the box around a checked shape at a pose.
    pub fn of(shape: &Shape, pose: &Pose) -> Extent {
        let pieces = pieces(shape, pose);
        pieces.iter().fold(Extent::NOTHING, Extent::joined)
    }

    /// Returns the box around both boxes.
    #[must_use]
    pub fn joined(self, other: &Extent) -> Extent {
        Extent {
            low: [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis])),
            high: [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// Returns true when no point of `other` lies outside by more than `slack_mm`.
    pub fn holds(&self, other: &Extent, slack_mm: f64) -> bool {
        (0..3).all(|axis| {
            other.low[axis] >= self.low[axis] - slack_mm
                && other.high[axis] <= self.high[axis] + slack_mm
        })
    }

    /// Returns the box moved by a displacement, mm.
    #[must_use]
    pub fn moved(self, by: [f64; 3]) -> Extent {
        Extent {
            low: [0, 1, 2].map(|axis| self.low[axis] + by[axis]),
            high: [0, 1, 2].map(|axis| self.high[axis] + by[axis]),
        }
    }

    /// Returns the middle of the box, mm.
    pub fn middle(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * (self.low[axis] + self.high[axis]))
    }
}

/// Returns the boxes of the convex pieces of a shape at a pose; a mesh counts as one piece.
pub(crate) fn pieces(shape: &Shape, pose: &Pose) -> Vec<Extent> {
    let mut found = Vec::new();
    collect(
        shape,
        &columns(pose.rotation),
        pose.position,
        0.0,
        &mut found,
    );
    found
}

fn collect(shape: &Shape, frame: &Columns, at: [f64; 3], span: f64, found: &mut Vec<Extent>) {
    match shape {
        Shape::Block { half } => found.push(around(at, span, |axis| {
            (0..3)
                .map(|own| half[own] * frame[own][axis].abs())
                .sum::<f64>()
        })),
        Shape::Cylinder { radius, height } => found.push(around(at, span, |axis| {
            let along = frame[2][axis];
            let [a, b] = [frame[2][(axis + 1) % 3], frame[2][(axis + 2) % 3]];
            0.5 * height * along.abs() + radius * a.hypot(b)
        })),
        Shape::Compound(parts) => {
            for (pose, part) in parts {
                let offset = turned(frame, pose.position);
                let place = [0, 1, 2].map(|axis| at[axis] + offset[axis]);
                let inner = columns(pose.rotation).map(|column| turned(frame, column));
                let reach = span + largest(at) + largest(offset);
                collect(part, &inner, place, reach, found);
            }
        }
        Shape::Mesh(mesh) => {
            let corners = mesh.vertices.iter().map(|corner| {
                let offset = turned(frame, *corner);
                around(
                    [0, 1, 2].map(|axis| at[axis] + offset[axis]),
                    span + largest(offset),
                    |_| 0.0,
                )
            });
            found.push(corners.fold(Extent::NOTHING, |all, one| all.joined(&one)));
        }
    }
}

fn around(at: [f64; 3], span: f64, half: impl Fn(usize) -> f64) -> Extent {
    let halves = [half(0), half(1), half(2)];
    let noise = |axis: usize| ROUNDING * (span + at[axis].abs() + halves[axis]);
    Extent {
        low: [0, 1, 2].map(|axis| at[axis] - halves[axis] - noise(axis)),
        high: [0, 1, 2].map(|axis| at[axis] + halves[axis] + noise(axis)),
    }
}

fn largest(v: [f64; 3]) -> f64 {
    v.into_iter()
        .fold(0.0, |most, member| most.max(member.abs()))
}

fn turned(frame: &Columns, v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| frame[0][axis] * v[0] + frame[1][axis] * v[1] + frame[2][axis] * v[2])
}

/// Returns the direction of a body's own z axis at a rotation, a unit vector.
pub(crate) fn own_z(rotation: [f64; 4]) -> [f64; 3] {
    columns(rotation)[2]
}

/// Returns a vector after a rotation.
pub(crate) fn rotated(rotation: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    turned(&columns(rotation), v)
}

/// Returns the columns of a quaternion of any length but zero; quarter turns come out exact.
fn columns(rotation: [f64; 4]) -> Columns {
    let [w, x, y, z] = rotation;
    if x == 0.0 && y == 0.0 && z == 0.0 {
        return UNTURNED;
    }
    let twice = 2.0 / (w * w + x * x + y * y + z * z);
    let (xx, yy, zz) = (x * x * twice, y * y * twice, z * z * twice);
    let (xy, xz, yz) = (x * y * twice, x * z * twice, y * z * twice);
    let (wx, wy, wz) = (w * x * twice, w * y * twice, w * z * twice);
    [
        [1.0 - (yy + zz), xy + wz, xz - wy],
        [xy - wz, 1.0 - (xx + zz), yz + wx],
        [xz + wy, yz - wx, 1.0 - (xx + yy)],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(found: [f64; 3], wanted: [f64; 3]) -> bool {
        found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    #[test]
    fn a_turned_cylinder_has_the_box_of_its_axis() {
        let shape = Shape::Cylinder {
            radius: 3.0,
            height: 135.0,
        };
        let lying = Pose {
            position: [-152.5, 0.0, 8.0],
            rotation: [0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt(), 0.0],
        };
        let found = Extent::of(&shape, &lying);
        assert!(is_near(found.low, [-220.0, -3.0, 5.0]), "{found:?}");
        assert!(is_near(found.high, [-85.0, 3.0, 11.0]), "{found:?}");
    }

    #[test]
    fn a_compound_has_the_box_around_its_parts() {
        let cube = Shape::Block { half: [1.0; 3] };
        let inner = Shape::Compound(vec![(Pose::at([0.0, 5.0, 0.0]), cube.clone())]);
        let quarter = Pose::yawed([10.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2);
        let both = Shape::Compound(vec![(quarter, inner), (Pose::IDENTITY, cube)]);
        let found = Extent::of(&both, &Pose::at([0.0, 0.0, 2.0]));
        assert!(is_near(found.low, [-1.0, -1.0, 1.0]), "{found:?}");
        assert!(is_near(found.high, [6.0, 1.0, 3.0]), "{found:?}");
    }
}
