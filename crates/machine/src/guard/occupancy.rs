//! Room of a body that may be anywhere in a span.
//!
//! A body B rides on actuators, each with a span of possible positions. Its offset then lies in the axis-parallel box
//! S that holds the sum of the spans, and its room is B + S = { b + s }. The box bounds(piece) + S covers that room
//! piece by piece: each b of a piece lies in bounds(piece) and each s in S, so b + s lies in the cover. For an upright
//! block the cover *is* B + S; for a cylinder it is the block around it, never less. Where S is a single point the
//! room is the true shape, moved.

use lpm::{Pose, Shape};
use std::borrow::Cow;

/// Added to every cover, mm, so that rounding of the sums (below 1e-11 mm within 1e4 mm) never makes it too small.
const ROUNDING_MM: f64 = 1e-9;

/// Axis-parallel box of offsets, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Offsets {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Offsets {
    /// The zero offset.
    pub const NONE: Offsets = Offsets {
        low: [0.0; 3],
        high: [0.0; 3],
    };

    /// Returns the box around the way from `low_mm` to `high_mm` along `direction`.
    pub fn along(direction: [f64; 3], low_mm: f64, high_mm: f64) -> Offsets {
        let ends = |i: usize| (direction[i] * low_mm, direction[i] * high_mm);
        Offsets {
            low: std::array::from_fn(|i| ends(i).0.min(ends(i).1)),
            high: std::array::from_fn(|i| ends(i).0.max(ends(i).1)),
        }
    }

    /// Returns the box of the sums of one offset from `self` and one from `other`.
    pub fn plus(self, other: Offsets) -> Offsets {
        Offsets {
            low: sum(self.low, other.low),
            high: sum(self.high, other.high),
        }
    }

    /// Returns true when exactly one offset is possible.
    pub fn is_point(&self) -> bool {
        self.low == self.high
    }
}

/// Returns the room of `shape` at `pose` under all `offsets`, as a shape and its pose.
pub(super) fn room<'a>(shape: &'a Shape, pose: &Pose, offsets: &Offsets) -> (Cow<'a, Shape>, Pose) {
    if offsets.is_point() {
        return (
            Cow::Borrowed(shape),
            pose.moved_to(sum(pose.position, offsets.low)),
        );
    }
    let mut covers = Vec::new();
    collect(
        shape,
        &Rotation::of(pose.rotation),
        [0.0; 3],
        offsets,
        &mut covers,
    );
    (Cow::Owned(Shape::Compound(covers)), Pose::at(pose.position))
}

fn collect(
    shape: &Shape,
    turn: &Rotation,
    at: [f64; 3],
    offsets: &Offsets,
    covers: &mut Vec<(Pose, Shape)>,
) {
    let half = match shape {
        Shape::Compound(parts) => {
            for (pose, part) in parts {
                let inner = turn.after(&Rotation::of(pose.rotation));
                collect(
                    part,
                    &inner,
                    sum(at, turn.apply(pose.position)),
                    offsets,
                    covers,
                );
            }
            return;
        }
        Shape::Block { half } => turn.bounds(*half),
        Shape::Cylinder { radius, height } => turn.bounds([*radius, *radius, height / 2.0]),
        Shape::Mesh(mesh) => {
            let far = |i: usize| {
                mesh.vertices
                    .iter()
                    .fold(0.0_f64, |far, v| far.max(v[i].abs()))
            };
            turn.bounds([far(0), far(1), far(2)])
        }
    };
    let low = sum(at, offsets.low);
    let high = sum(at, offsets.high);
    let centre = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
    let half = std::array::from_fn(|i| half[i] + 0.5 * (high[i] - low[i]) + ROUNDING_MM);
    covers.push((Pose::at(centre), Shape::Block { half }));
}

/// A rotation matrix, row by row.
struct Rotation([[f64; 3]; 3]);

impl Rotation {
    fn of(rotation: [f64; 4]) -> Rotation {
        let [w, x, y, z] = rotation;
        let s = 2.0 / (w * w + x * x + y * y + z * z);
        Rotation([
            [
                1.0 - s * (y * y + z * z),
                s * (x * y - w * z),
                s * (x * z + w * y),
            ],
            [
                s * (x * y + w * z),
                1.0 - s * (x * x + z * z),
                s * (y * z - w * x),
            ],
            [
                s * (x * z - w * y),
                s * (y * z + w * x),
                1.0 - s * (x * x + y * y),
            ],
        ])
    }

    fn apply(&self, v: [f64; 3]) -> [f64; 3] {
        self.0
            .map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    fn after(&self, inner: &Rotation) -> Rotation {
        let column = |j: usize| self.apply([inner.0[0][j], inner.0[1][j], inner.0[2][j]]);
        let columns = [column(0), column(1), column(2)];
        Rotation(std::array::from_fn(|i| {
            std::array::from_fn(|j| columns[j][i])
        }))
    }

    /// Returns the half extents along x, y and z of the rotated block with half extents `half`.
    fn bounds(&self, half: [f64; 3]) -> [f64; 3] {
        self.0
            .map(|row| row[0].abs() * half[0] + row[1].abs() * half[1] + row[2].abs() * half[2])
    }
}

pub(super) fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn scaled(v: [f64; 3], factor: f64) -> [f64; 3] {
    v.map(|member| member * factor)
}

#[cfg(test)]
#[path = "tests/room.rs"]
mod tests;
