//! Faces of more than three corners: checks that the triangles from the first corner to each edge cover the face.

use crate::vector::{Vec3, cross, dot, length, sub, unit};

/// Tolerance for a corner that lies off the plane of the face, or dents the outline of a convex face; relative to the
/// distance from the first corner to the farthest. Most programs write six digits, which gives errors of 1e-5 for a
/// face near the origin and larger ones for a face far from it. Two ways of cutting a face that is not flat may differ
/// by as much as the tolerance: 1 um for 10 mm. A dent within the tolerance only blocks more, because the triangles
/// cover every flat face.
const FLAT: f64 = 1e-4;

/// Returns true for a flat convex face, and for a face no wider than the tolerance, since a segment or a point has no
/// plane.
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
    // The plane through the first corner, the farthest corner, and the corner farthest off the line between them.
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

/// Returns true when the corners go round the face once: along any direction, a convex face then runs once forth and
/// once back. A face that goes round twice is not acceptable, because `solid` counts crossings and edges as even or
/// odd.
fn is_walked_once(flat: &[[f64; 2]]) -> bool {
    let places = || flat.iter().map(|it| it[0]);
    let span = places().fold(f64::MIN, f64::max) - places().fold(f64::MAX, f64::min);
    let steps = places().zip(places().cycle().skip(1));
    steps.map(|(a, b)| (b - a).abs()).sum::<f64>() <= 3.0 * span
}

/// Returns true when no corner lies to the right of an edge by more than `slack`. The distance is the width of the
/// triangle over the edge, because the direction of a short edge is mostly rounding.
fn is_left_of_edges<'a>(
    round: impl Iterator<Item = &'a [f64; 2]> + Clone,
    corners: &[[f64; 2]],
    slack: f64,
) -> bool {
    let mut edges = round.clone().zip(round.cycle().skip(1));
    edges.all(|(a, b)| corners.iter().all(|c| width(*a, *b, *c) >= -slack))
}

/// Returns the width of a triangle across its longest side; negative when it turns right, 0 for a point.
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
