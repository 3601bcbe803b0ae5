//! A body lies in the room that the guard computes for it.

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
                let turn = Rotation::of(pose.rotation);
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
fn a_rotated_body_lies_in_its_room() {
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
    let turn = Rotation::of(pose.rotation);
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
fn a_resting_body_keeps_its_true_shape() {
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
