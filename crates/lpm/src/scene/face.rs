//! Faces of more than three corners: is a fan over the first corner the face itself?

use crate::vector::{Vec3, cross, dot, length, sub, unit};

/// How far a corner may lie off the plane, or inside of where a convex face would have it, as a share of the distance
/// from the first corner to the farthest. Six digits, as most programs write, leave 1e-5 of a face beside the origin
/// and more of one away from it. It is also what two ways of cutting a face that is not flat may differ by: 1 um of
/// 10 mm. What is hollow within it only blocks more, for a fan covers every flat face.
const FLAT: f64 = 1e-4;

/// Also of a face that is no wider than that: a segment or a point has no plane.
pub(super) fn is_flat_and_convex(corners: &[Vec3]) -> bool {
    let from_first: Vec<Vec3> = corners.iter().map(|it| sub(*it, corners[0])).collect();
    let farthest = longest(&from_first);
    let Some(along) = unit(farthest) else {
        return farthest == [0.0; 3];
    };
    let slack = FLAT * length(farthest);
    let off = |it: &Vec3| cross(along, *it);
    let widest = longest(&from_first.iter().map(off).collect::<Vec<_>>());
    if length(widest) <= slack {
        return true;
    }
    // The plane of the first corner, the farthest, and the one farthest off the line between them.
    let Some(normal) = unit(widest) else {
        return false;
    };
    let across = cross(normal, along);
    let flat: Vec<[f64; 2]> = from_first
        .iter()
        .map(|it| [dot(*it, along), dot(*it, across)])
        .collect();
    from_first.iter().all(|it| dot(*it, normal).abs() <= slack)
        && is_walked_once(&flat)
        && (is_left_of_edges(flat.iter(), &flat, slack)
            || is_left_of_edges(flat.iter().rev(), &flat, slack))
}

fn longest(ways: &[Vec3]) -> Vec3 {
    let longer = |a: Vec3, b: &Vec3| if length(*b) > length(a) { *b } else { a };
    ways.iter().fold([0.0; 3], longer)
}

/// Once round a convex face is once there and once back along any direction. Twice round it would be no face at all:
/// edges and crossings are counted by parity (`solid`).
fn is_walked_once(flat: &[[f64; 2]]) -> bool {
    let places = || flat.iter().map(|it| it[0]);
    let span = places().fold(f64::MIN, f64::max) - places().fold(f64::MAX, f64::min);
    let steps = places().zip(places().cycle().skip(1));
    steps.map(|(a, b)| (b - a).abs()).sum::<f64>() <= 3.0 * span
}

/// Whether no corner lies to the right of an edge: by no more than `slack` as the width of the triangle over the edge,
/// for the direction of a short edge is mostly rounding.
fn is_left_of_edges<'a>(
    round: impl Iterator<Item = &'a [f64; 2]> + Clone,
    corners: &[[f64; 2]],
    slack: f64,
) -> bool {
    let mut edges = round.clone().zip(round.cycle().skip(1));
    edges.all(|(a, b)| corners.iter().all(|c| width(*a, *b, *c) >= -slack))
}

/// Of a triangle across its longest side, below 0 when it turns right; 0 of a point.
fn width(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let way = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
    let (ab, ac, bc) = (way(a, b), way(a, c), way(b, c));
    let side = [ab, ac, bc].map(|[x, y]| x.hypot(y)).into_iter();
    let longest = side.fold(0.0, f64::max);
    if longest > 0.0 {
        (ab[0] * ac[1] - ab[1] * ac[0]) / longest
    } else {
        0.0
    }
}
