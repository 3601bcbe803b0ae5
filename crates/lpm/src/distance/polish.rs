//! Finds the last digits of a plane by cutting planes in the space of directions.
//!
//! The walk over simplices loses digits when the nearest vector is tiny compared with the pieces (a micrometre to a
//! metre). Directions keep their digits: every support point `w` of `b - a` bounds the separation along any direction
//! `m` by `m·w`, a number without cancellation. In the tangent plane of the current direction the separation is the
//! minimum of such linear functions. The next direction to try is where this minimum, over the support points seen so
//! far, is highest.

use super::simplex::support;
use crate::piece::Piece;
use crate::vector::{Vec3, add, cross, dot, scale, unit};

/// Maximum number of directions to try.
const MOST_TRIALS: usize = 600;
/// Maximum number of support points to keep.
const MOST_CUTS: usize = 18;
/// Size of the first trust region (how far from the current direction a trial may look): tangent of the angle.
const FIRST_REACH: f64 = 1e-2;
/// Trust regions of the further rounds; each begins when a round ended without proof that its direction is the best.
const AGAIN_REACHES: [f64; 3] = [1e-4, 1e-6, 1e-8];
/// Size of the trust region below which a trial changes nothing.
const LAST_REACH: f64 = 1e-15;

/// A linear bound of the separation over the tangent plane: `height + slope·(s, t)`.
#[derive(Debug, Clone, Copy)]
struct Cut {
    height: f64,
    slope: [f64; 2],
}

impl Cut {
    fn at(&self, [s, t]: [f64; 2]) -> f64 {
        self.height + self.slope[0] * s + self.slope[1] * t
    }
}

/// Returns a direction at least as good as `n`; `best` is the separation along `n`, mm.
pub(super) fn polished(a: &Piece, b: &Piece, c: Vec3, n: Vec3, best: f64, resolution: f64) -> Vec3 {
    let (mut n, mut best) = (n, best);
    let mut points = vec![support(a, b, c, n).w];
    let mut reach = FIRST_REACH;
    let mut again = AGAIN_REACHES.iter();
    for _ in 0..MOST_TRIALS {
        let [u, v] = tangents(n);
        let cuts: Vec<Cut> = points
            .iter()
            .map(|w| Cut {
                height: dot(n, *w),
                slope: [dot(u, *w), dot(v, *w)],
            })
            .collect();
        let (place, bound) = highest(&cuts, reach);
        let inside = place.iter().all(|member| member.abs() < reach);
        if inside && bound - best <= resolution {
            break;
        }
        if reach < LAST_REACH {
            let Some(next) = again.next() else {
                break;
            };
            // Cuts from distant directions may have hidden nearby ones, so the next round starts without them.
            reach = *next;
            points = vec![support(a, b, c, n).w];
            continue;
        }
        let Some(trial) = unit(add(n, add(scale(u, place[0]), scale(v, place[1])))) else {
            break;
        };
        let w = support(a, b, c, trial).w;
        points.push(w);
        let found = dot(trial, w);
        if found > best {
            (n, best) = (trial, found);
            reach = (2.0 * reach).min(FIRST_REACH);
        } else {
            reach *= if inside { 0.9 } else { 0.3 };
        }
        forget_slackest(&mut points, n);
    }
    n
}

fn forget_slackest(points: &mut Vec<Vec3>, n: Vec3) {
    while points.len() > MOST_CUTS {
        let newest = points.len() - 1;
        let slack = |index: &usize| dot(n, points[*index]);
        let slackest = (0..newest).max_by(|i, j| slack(i).total_cmp(&slack(j)));
        points.swap_remove(slackest.unwrap_or(0));
    }
}

fn tangents(n: Vec3) -> [Vec3; 2] {
    let least = (0..3).fold(0, |least, axis| {
        if n[axis].abs() < n[least].abs() {
            axis
        } else {
            least
        }
    });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = unit(cross(n, axis)).unwrap_or([1.0, 0.0, 0.0]);
    [u, cross(n, u)]
}

/// Returns the place in the square of half side `reach` at which the minimum of the cuts is highest, and this value.
fn highest(cuts: &[Cut], reach: f64) -> ([f64; 2], f64) {
    let value = |place: [f64; 2]| {
        cuts.iter()
            .fold(f64::INFINITY, |least, cut| least.min(cut.at(place)))
    };
    let mut best = ([0.0; 2], value([0.0; 2]));
    let mut offer = |place: [f64; 2]| {
        if place.iter().all(|member| member.abs() <= reach) {
            let height = value(place);
            if height > best.1 {
                best = (place, height);
            }
        }
    };
    for s in [-reach, reach] {
        for t in [-reach, reach] {
            offer([s, t]);
        }
    }
    for (i, first) in cuts.iter().enumerate() {
        for (j, second) in cuts.iter().enumerate().skip(i + 1) {
            let ridge = difference(first, second);
            for edge in [-reach, reach] {
                offer([
                    edge,
                    -(ridge.height + ridge.slope[0] * edge) / ridge.slope[1],
                ]);
                offer([
                    -(ridge.height + ridge.slope[1] * edge) / ridge.slope[0],
                    edge,
                ]);
            }
            for third in cuts.iter().skip(j + 1) {
                offer(meeting(&ridge, &difference(first, third)));
            }
        }
    }
    best
}

fn difference(a: &Cut, b: &Cut) -> Cut {
    Cut {
        height: a.height - b.height,
        slope: [a.slope[0] - b.slope[0], a.slope[1] - b.slope[1]],
    }
}

/// Returns the point where both cuts are zero; NaN, which is never inside, when their slopes are parallel.
fn meeting(a: &Cut, b: &Cut) -> [f64; 2] {
    let det = a.slope[0] * b.slope[1] - a.slope[1] * b.slope[0];
    [
        (a.slope[1] * b.height - b.slope[1] * a.height) / det,
        (b.slope[0] * a.height - a.slope[0] * b.height) / det,
    ]
}
