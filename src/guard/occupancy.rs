//! The room a body takes when it may be anywhere in a span.
//!
//! A body B rides on actuators, each known only as a span of its stroke. Its offset then lies in
//! the axis-parallel box S that holds the sum of the spans, and the room it may take is
//! B + S = { b + s }. That room is covered, piece by piece, by the box bounds(piece) + S:
//! each b of a piece lies in bounds(piece) and each s in S, so b + s lies in the cover. For an
//! upright block the cover *is* B + S; for a cylinder it is the block around it, never less.
//! Where S is a single point the true shape is used, moved.

use crate::lpm::{Pose, Shape};
use std::borrow::Cow;

/// Covers are widened by so much, mm, so that the rounding of their sums (below 1e-11 mm within
/// 1e4 mm) can never make them too small.
const ROUNDING_MM: f64 = 1e-9;

/// What `may_touch` leaves of a piece that is thinner than the depth, mm: a core, never nothing.
const CORE_MM: f64 = 1e-3;

/// Axis-parallel box of offsets, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Offsets {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Offsets {
    /// No offset at all.
    pub const NONE: Offsets = Offsets {
        low: [0.0; 3],
        high: [0.0; 3],
    };

    /// The box around the way from `low_mm` to `high_mm` along `direction`.
    pub fn along(direction: [f64; 3], low_mm: f64, high_mm: f64) -> Offsets {
        let ends = |i: usize| (direction[i] * low_mm, direction[i] * high_mm);
        Offsets {
            low: std::array::from_fn(|i| ends(i).0.min(ends(i).1)),
            high: std::array::from_fn(|i| ends(i).0.max(ends(i).1)),
        }
    }

    /// All sums of an offset of each.
    pub fn plus(self, other: Offsets) -> Offsets {
        Offsets {
            low: sum(self.low, other.low),
            high: sum(self.high, other.high),
        }
    }

    fn is_point(&self) -> bool {
        self.low == self.high
    }
}

/// The room of `shape` at `pose` under all `offsets`, as a shape and where it stands.
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
        &Turn::of(pose.rotation),
        [0.0; 3],
        offsets,
        &mut covers,
    );
    (Cow::Owned(Shape::Compound(covers)), Pose::at(pose.position))
}

/// `shape` with `depth_mm` taken off every face of every piece.
pub(super) fn shrunk(shape: &Shape, depth_mm: f64) -> Shape {
    let less = |half: f64| (half - depth_mm).max(CORE_MM.min(half));
    match shape {
        Shape::Block { half } => Shape::Block {
            half: half.map(less),
        },
        Shape::Cylinder { radius, height } => Shape::Cylinder {
            radius: less(*radius),
            height: 2.0 * less(height / 2.0),
        },
        Shape::Compound(parts) => Shape::Compound(
            parts
                .iter()
                .map(|(pose, part)| (*pose, shrunk(part, depth_mm)))
                .collect(),
        ),
        Shape::Mesh(mesh) => Shape::Mesh(mesh.clone()),
    }
}

fn collect(
    shape: &Shape,
    turn: &Turn,
    at: [f64; 3],
    offsets: &Offsets,
    covers: &mut Vec<(Pose, Shape)>,
) {
    let half = match shape {
        Shape::Compound(parts) => {
            for (pose, part) in parts {
                let inner = turn.after(&Turn::of(pose.rotation));
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

/// A rotation as a matrix, row by row.
struct Turn([[f64; 3]; 3]);

impl Turn {
    fn of(rotation: [f64; 4]) -> Turn {
        let [w, x, y, z] = rotation;
        let s = 2.0 / (w * w + x * x + y * y + z * z);
        Turn([
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

    fn after(&self, inner: &Turn) -> Turn {
        let column = |j: usize| self.apply([inner.0[0][j], inner.0[1][j], inner.0[2][j]]);
        let columns = [column(0), column(1), column(2)];
        Turn(std::array::from_fn(|i| {
            std::array::from_fn(|j| columns[j][i])
        }))
    }

    /// Half extents, along x, y and z, of a block of these half extents when it is turned.
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
mod tests {
    use super::*;

    /// Points on the rims of a cylinder and the corners of a block, in their own frame.
    fn extremes(shape: &Shape) -> Vec<[f64; 3]> {
        let signs = |i: usize, bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        match shape {
            Shape::Block { half: [x, y, z] } => (0..8)
                .map(|i| [x * signs(i, 1), y * signs(i, 2), z * signs(i, 4)])
                .collect(),
            Shape::Cylinder { radius, height } => (0..720)
                .map(|i| {
                    let (sin, cos) = f64::from(i).to_radians().sin_cos();
                    [
                        radius * cos,
                        radius * sin,
                        height / 2.0 * signs(i as usize, 1),
                    ]
                })
                .collect(),
            Shape::Compound(parts) => parts
                .iter()
                .flat_map(|(pose, part)| {
                    let turn = Turn::of(pose.rotation);
                    extremes(part)
                        .into_iter()
                        .map(move |p| sum(pose.position, turn.apply(p)))
                })
                .collect(),
            Shape::Mesh(mesh) => mesh.vertices.clone(),
        }
    }

    fn covers(cover: &Shape, origin: [f64; 3], point: [f64; 3]) -> bool {
        match cover {
            Shape::Compound(parts) => parts.iter().any(|(pose, part)| match part {
                Shape::Block { half } => {
                    let centre = sum(origin, pose.position);
                    (0..3).all(|i| (point[i] - centre[i]).abs() <= half[i])
                }
                Shape::Cylinder { .. } | Shape::Compound(_) | Shape::Mesh(_) => false,
            }),
            Shape::Block { .. } | Shape::Cylinder { .. } | Shape::Mesh(_) => false,
        }
    }

    fn turned_pieces() -> Shape {
        let tilted = Pose {
            position: [3.0, -2.0, 1.0],
            rotation: [0.8, 0.3, -0.4, 0.33],
        };
        let flat = Pose {
            position: [-5.0, 0.5, 0.0],
            rotation: [1.0, 1.0, 0.0, 0.0],
        };
        Shape::Compound(vec![
            (
                tilted,
                Shape::Cylinder {
                    radius: 2.0,
                    height: 9.0,
                },
            ),
            (
                flat,
                Shape::Block {
                    half: [1.0, 2.0, 4.0],
                },
            ),
        ])
    }

    #[test]
    fn a_turned_body_lies_in_its_room_wherever_it_is_in_its_span() {
        let shape = turned_pieces();
        let pose = Pose {
            position: [100.0, 20.0, -7.0],
            rotation: [0.2, -0.7, 0.1, 0.6],
        };
        let offsets = Offsets {
            low: [-1.0, 0.0, -40.0],
            high: [350.0, 0.0, 2.0],
        };
        let (cover, stand) = room(&shape, &pose, &offsets);
        let turn = Turn::of(pose.rotation);
        for point in extremes(&shape) {
            let at_rest = sum(pose.position, turn.apply(point));
            for offset in [offsets.low, offsets.high, [17.0, 0.0, -3.0]] {
                let point = sum(at_rest, offset);
                assert!(
                    covers(&cover, stand.position, point),
                    "{point:?} is outside"
                );
            }
        }
    }

    #[test]
    fn a_body_that_stands_keeps_its_true_shape() {
        let shape = Shape::Cylinder {
            radius: 2.0,
            height: 9.0,
        };
        let offsets = Offsets::along([0.0, 0.0, -1.0], 40.0, 40.0);
        let (same, stand) = room(&shape, &Pose::at([1.0, 2.0, 3.0]), &offsets);
        assert_eq!(
            (same.as_ref(), stand),
            (&shape, Pose::at([1.0, 2.0, -37.0]))
        );
    }

    #[test]
    fn what_may_touch_never_shrinks_to_nothing() {
        assert_eq!(
            shrunk(
                &Shape::Block {
                    half: [2.0, 0.05, 1.0]
                },
                0.1
            ),
            Shape::Block {
                half: [1.9, CORE_MM, 0.9]
            }
        );
        assert_eq!(
            shrunk(
                &Shape::Cylinder {
                    radius: 3.0,
                    height: 4.0
                },
                0.5
            ),
            Shape::Cylinder {
                radius: 2.5,
                height: 3.0
            }
        );
    }
}
