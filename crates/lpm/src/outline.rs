//! Silhouettes for a drawing: the outline of a body seen from above or from the front.
//!
//! Every convex piece gives one convex polygon, counter-clockwise. The rim of a cylinder has [`RIM`] corners, which is
//! less than 1 % of its radius off the true outline. The silhouettes are for pictures only; no collision answer uses
//! them.

use super::pose::{Frame, Pose};
use super::shape::Shape;
use super::vector::{Vec3, add};
use std::f64::consts::TAU;

/// Number of corners with which a rim is drawn.
const RIM: usize = 24;

/// Direction from which a drawing shows a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// From above: x to the right, y up.
    Above,
    /// From the front, along +y: x to the right, z up.
    Front,
}

/// Returns the silhouettes of the pieces of `shape` at `pose`, mm.
pub fn outlines(shape: &Shape, pose: Pose, view: View) -> Vec<Vec<[f64; 2]>> {
    let mut pieces = Vec::new();
    collect(
        shape,
        &Frame::of(pose.rotation),
        pose.position,
        &mut |corners| pieces.push(hull(corners.iter().map(|it| flat(*it, view)).collect())),
    );
    pieces
}

fn flat(corner: Vec3, view: View) -> [f64; 2] {
    match view {
        View::Above => [corner[0], corner[1]],
        View::Front => [corner[0], corner[2]],
    }
}

/// Passes the corners of every convex piece of the placed shape to `give`.
fn collect(shape: &Shape, frame: &Frame, position: Vec3, give: &mut impl FnMut(Vec<Vec3>)) {
    let place = |corner: Vec3| add(frame.apply(corner), position);
    match shape {
        Shape::Block { half } => give((0..8).map(|bits| place(corner(bits, *half))).collect()),
        Shape::Cylinder { radius, height } => give(rim(*radius, *height).map(place).collect()),
        Shape::Compound(parts) => {
            for (pose, part) in parts {
                let inner = frame.then(&Frame::of(pose.rotation));
                collect(part, &inner, place(pose.position), give);
            }
        }
        Shape::Mesh(mesh) => {
            for triangle in &mesh.triangles {
                give(triangle.map(|at| place(mesh.vertices[at])).to_vec());
            }
        }
    }
}

fn corner(bits: usize, half: Vec3) -> Vec3 {
    [0, 1, 2].map(|axis| {
        if bits >> axis & 1 == 1 {
            half[axis]
        } else {
            -half[axis]
        }
    })
}

fn rim(radius: f64, height: f64) -> impl Iterator<Item = Vec3> {
    (0..2 * RIM).map(move |at| {
        let (sin, cos) = (TAU * (at / 2) as f64 / RIM as f64).sin_cos();
        let z = if at % 2 == 0 { height } else { -height } / 2.0;
        [radius * cos, radius * sin, z]
    })
}

/// Returns the convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut half = chain(points.iter().copied());
    let upper = chain(points.iter().rev().copied());
    half.pop();
    half.extend(&upper[..upper.len() - 1]);
    half
}

fn chain(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 1e-9
    };
    let mut chain: Vec<[f64; 2]> = Vec::new();
    for point in points {
        while chain.len() > 1 && !left(chain[chain.len() - 2], chain[chain.len() - 1], point) {
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(polygon: &[[f64; 2]], axis: usize) -> (f64, f64) {
        polygon
            .iter()
            .fold((f64::MAX, f64::MIN), |(low, high), it| {
                (low.min(it[axis]), high.max(it[axis]))
            })
    }

    #[test]
    fn a_block_is_a_rectangle_in_both_views() {
        let block = Shape::Block {
            half: [1.0, 2.0, 3.0],
        };
        let pose = Pose::at([10.0, 20.0, 30.0]);
        let above = &outlines(&block, pose, View::Above)[0];
        assert_eq!(above.len(), 4);
        assert_eq!(
            (extent(above, 0), extent(above, 1)),
            ((9.0, 11.0), (18.0, 22.0))
        );
        let front = &outlines(&block, pose, View::Front)[0];
        assert_eq!(
            (extent(front, 0), extent(front, 1)),
            ((9.0, 11.0), (27.0, 33.0))
        );
    }

    #[test]
    fn a_cylinder_is_round_only_from_above() {
        let pin = Shape::Cylinder {
            radius: 4.0,
            height: 30.0,
        };
        let above = &outlines(&pin, Pose::IDENTITY, View::Above)[0];
        assert_eq!(above.len(), RIM);
        assert!(
            above
                .iter()
                .all(|it| (it[0].hypot(it[1]) - 4.0).abs() < 1e-9)
        );
        assert_eq!(outlines(&pin, Pose::IDENTITY, View::Front)[0].len(), 4);
    }

    #[test]
    fn a_compound_gives_one_placed_polygon_per_piece() {
        let block = Shape::Block { half: [1.0; 3] };
        let pair = Shape::Compound(vec![
            (Pose::at([5.0, 0.0, 0.0]), block.clone()),
            (Pose::at([-5.0, 0.0, 0.0]), block),
        ]);
        let turned = Pose::yawed([0.0; 3], std::f64::consts::FRAC_PI_2);
        let above = outlines(&pair, turned, View::Above);
        let (low, high) = extent(&above[0], 1);
        assert!((low - 4.0).abs() < 1e-9 && (high - 6.0).abs() < 1e-9);
        assert_eq!(above.len(), 2);
    }
}
