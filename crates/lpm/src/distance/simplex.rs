//! Nearest points of any two convex pieces: a walk over simplices of their difference (GJK).
//!
//! The method is that of Gilbert, Johnson and Keerthi on `b - a`, with three differences: the normal of a triangle
//! comes from its edges, not from the (tiny) nearest vector; a nearest vector on an edge is made orthogonal twice; and
//! the walk keeps the best plane so far, so that further steps never worsen the answer.

use super::polish::polished;
use super::{Proposal, RESOLUTION_MM};
use crate::piece::{NOISE, Piece};
use crate::vector::{Vec3, add, along, cross, dot, length, negate, scale, sub, unit};

/// Maximum number of steps of the walk. Polytopes need fewer than 20, two tilted rims up to 60.
const MOST_STEPS: usize = 128;

/// Maximum number of steps in which the nearest vector does not get shorter. The length converges to second order, the
/// plane only to first order: the plane may still improve when the length has no digits left.
const MOST_STALLS: usize = 12;

/// Depth below which an overlap is checked again, mm, because a flat simplex may seem to contain the origin.
const DOUBTFUL_MM: f64 = 1e-3;

/// A corner of the simplex: a point of `b - a` and the point of `a` from which it was computed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub(super) w: Vec3,
    a: Vec3,
}

/// Point of a simplex that is nearest to the origin.
#[derive(Debug, Clone, Copy)]
struct Nearest {
    /// Vector from the origin to the nearest point, mm.
    v: Vec3,
    /// A direction along `v` that keeps its digits when `v` is tiny.
    normal: Vec3,
    corners: [Corner; 3],
    weights: [f64; 3],
    count: usize,
}

impl Nearest {
    /// Returns the distance of the nearest point from the origin, mm. Computes it from corners and weights, because `v`
    /// may be inaccurate when the simplex is thin.
    fn distance(&self) -> f64 {
        let weighted =
            |sum: Vec3, index: usize| along(sum, self.weights[index], self.corners[index].w);
        length((0..self.count).fold([0.0; 3], weighted))
    }
}

/// Returns the best plane between `a` and `b`; `c` is the vector between their centres.
pub(crate) fn propose(a: &Piece, b: &Piece, c: Vec3, hint: Option<Vec3>) -> Proposal {
    let mut walk = Walk::begin(a, b, c, hint);
    for _ in 0..MOST_STEPS {
        if !walk.step() {
            break;
        }
    }
    let upper = walk.nearest.distance();
    if upper - walk.best > walk.resolution && (!walk.meets || walk.best > -DOUBTFUL_MM) {
        let (n, best) = (walk.best_normal, walk.best);
        walk.best_normal = polished(a, b, c, n, best, walk.resolution);
    }
    walk.proposal()
}

struct Walk<'a> {
    a: &'a Piece,
    b: &'a Piece,
    c: Vec3,
    nearest: Nearest,
    best: f64,
    best_normal: Vec3,
    resolution: f64,
    stalls: usize,
    /// True once a simplex contained the origin, which means that the pieces meet.
    meets: bool,
}

impl<'a> Walk<'a> {
    fn begin(a: &'a Piece, b: &'a Piece, c: Vec3, hint: Option<Vec3>) -> Walk<'a> {
        let n = hint.or_else(|| unit(c)).unwrap_or([0.0, 0.0, 1.0]);
        let corner = support(a, b, c, n);
        Walk {
            a,
            b,
            c,
            nearest: vertex(corner, n),
            best: dot(n, corner.w),
            best_normal: n,
            resolution: RESOLUTION_MM.max(NOISE * (a.span + b.span)) / 4.0,
            stalls: 0,
            meets: false,
        }
    }

    /// Takes one step; returns false when no improvement is left.
    fn step(&mut self) -> bool {
        let Some(n) = unit(self.nearest.normal) else {
            return false;
        };
        let corner = support(self.a, self.b, self.c, n);
        let lower = dot(n, corner.w);
        if lower > self.best {
            (self.best, self.best_normal) = (lower, n);
        }
        let upper = self.nearest.distance();
        if upper - self.best <= self.resolution {
            return false;
        }
        match refined(&self.nearest, corner) {
            None => {
                self.meets = true;
                false
            }
            Some(nearer) => {
                if !(nearer.distance() < upper) {
                    self.stalls += 1;
                }
                self.nearest = nearer;
                self.stalls < MOST_STALLS
            }
        }
    }

    fn proposal(&self) -> Proposal {
        let mut on_a = [0.0; 3];
        for index in 0..self.nearest.count {
            on_a = along(
                on_a,
                self.nearest.weights[index],
                self.nearest.corners[index].a,
            );
        }
        Proposal {
            normal: self.best_normal,
            on_a,
        }
    }
}

/// Returns the point of `b - a` with the least coordinate along `n`.
pub(super) fn support(a: &Piece, b: &Piece, c: Vec3, n: Vec3) -> Corner {
    let on_a = a.farthest(n);
    Corner {
        w: sub(add(c, b.farthest(negate(n))), on_a),
        a: on_a,
    }
}

/// Returns the nearest point after adding `corner` to the simplex; `None` when the origin is inside.
fn refined(nearest: &Nearest, corner: Corner) -> Option<Nearest> {
    let [p, q, r] = nearest.corners;
    match nearest.count {
        1 => Some(on_segment(p, corner)),
        2 => Some(on_triangle(p, q, corner)),
        _ => on_tetrahedron(p, q, r, corner),
    }
}

fn vertex(corner: Corner, fallback: Vec3) -> Nearest {
    let normal = if length(corner.w) > 0.0 {
        corner.w
    } else {
        fallback
    };
    Nearest {
        v: corner.w,
        normal,
        corners: [corner; 3],
        weights: [1.0, 0.0, 0.0],
        count: 1,
    }
}

fn on_segment(p: Corner, q: Corner) -> Nearest {
    let edge = sub(q.w, p.w);
    let squared = dot(edge, edge);
    let t = -dot(p.w, edge) / squared;
    // When the corners are equal, `t` is NaN, which selects the first corner.
    if !(t > 0.0) {
        return vertex(p, p.w);
    }
    if t >= 1.0 {
        return vertex(q, q.w);
    }
    let v = along(p.w, t, edge);
    let v = along(v, -dot(v, edge) / squared, edge);
    Nearest {
        v,
        normal: v,
        corners: [p, q, q],
        weights: [1.0 - t, t, 0.0],
        count: 2,
    }
}

fn on_triangle(p: Corner, q: Corner, r: Corner) -> Nearest {
    let normal = cross(sub(q.w, p.w), sub(r.w, p.w));
    let squared = dot(normal, normal);
    let areas = [
        dot(cross(q.w, r.w), normal),
        dot(cross(r.w, p.w), normal),
        dot(cross(p.w, q.w), normal),
    ];
    if squared > 0.0 && areas.iter().all(|area| *area > 0.0) {
        let height = dot(normal, p.w) / squared;
        let total = areas[0] + areas[1] + areas[2];
        let normal = if height < 0.0 { negate(normal) } else { normal };
        return Nearest {
            v: scale(normal, height.abs()),
            normal,
            corners: [p, q, r],
            weights: areas.map(|area| area / total),
            count: 3,
        };
    }
    nearer(on_segment(p, q), nearer(on_segment(q, r), on_segment(r, p)))
}

fn on_tetrahedron(p: Corner, q: Corner, r: Corner, s: Corner) -> Option<Nearest> {
    if encloses_origin([p.w, q.w, r.w, s.w]) {
        return None;
    }
    let with_new = nearer(
        on_triangle(p, q, s),
        nearer(on_triangle(q, r, s), on_triangle(r, p, s)),
    );
    Some(nearer(with_new, on_triangle(p, q, r)))
}

/// Returns true when the origin lies inside all four faces by more than rounding.
fn encloses_origin([p, q, r, s]: [Vec3; 4]) -> bool {
    let volume = dot(cross(sub(q, p), sub(r, p)), sub(s, p));
    let parts = [
        dot(cross(q, r), s),
        -dot(cross(p, r), s),
        dot(cross(p, q), s),
        -dot(cross(p, q), r),
    ];
    parts.iter().all(|part| part * volume > 0.0)
}

fn nearer(first: Nearest, second: Nearest) -> Nearest {
    if dot(second.v, second.v) < dot(first.v, first.v) {
        second
    } else {
        first
    }
}
