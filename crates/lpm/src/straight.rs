//! Straight moves: first contact and least distance of two convex pieces, for the whole path at once.
//!
//! While one convex piece is translated past another, their distance is a convex function of the path. Each separating
//! plane that the search finds gives a tangent below this function, because the separation by a fixed plane is linear
//! along the move. So Newton's method from the left never oversteps the first contact ([`first_within`]), and the
//! crossing of a falling and a rising tangent is a proven lower bound of the least distance ([`least`]). No step has a
//! fixed size: a move of ten metres over a foil costs the same as a short one.

use super::distance::{Gap, RESOLUTION_MM, gap};
use super::piece::{NOISE, Piece};
use super::vector::{Vec3, dot, reach, scale};

/// Maximum number of tangents per pair. Newton's method needs 3 to 8; a grazing pass, which has a double root, up to
/// 30.
const MOST_TANGENTS: usize = 128;

/// First contact of a pair within the margin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    /// Fraction of the move, never later than the true one.
    pub(crate) t: f64,
    pub(crate) gap: Gap,
}

impl Hit {
    /// Returns a contact at the start of the move for two bodies, one of which lies inside the other.
    pub(crate) fn inside(point: Vec3) -> Hit {
        let gap = Gap {
            lower: 0.0,
            normal: [0.0, 0.0, 1.0],
            on_element: point,
        };
        Hit { t: 0.0, gap }
    }
}

/// A translated pair: the values that stay constant along its move.
struct Slope {
    displacement: Vec3,
    /// Rounding bound of the separation by a plane, for its shift along the move, mm.
    slack: f64,
}

impl Slope {
    fn of(displacement: Vec3) -> Slope {
        Slope {
            displacement,
            slack: NOISE * reach(displacement),
        }
    }

    /// Returns the decrease of the separation by this plane over the whole move, mm.
    fn closing(&self, gap: &Gap) -> f64 {
        -dot(gap.normal, self.displacement)
    }
}

/// Returns the first fraction `t` from `start` to `until` at which the distance is within `margin` (mm); `None` is
/// proof that there is none. An undecidable case counts as a hit. The caller must have proven that there is no contact
/// before `start`.
pub(crate) fn first_within(
    element: &Piece,
    mover: &Piece,
    displacement: Vec3,
    margin: f64,
    start: f64,
    until: f64,
) -> Option<Hit> {
    let slope = Slope::of(displacement);
    let mut t = start;
    let mut hint = None;
    for _ in 0..MOST_TANGENTS {
        let gap = gap(element, mover, scale(displacement, t), hint);
        let excess = gap.lower - margin - slope.slack;
        // NaN counts as a hit.
        if !(excess > 0.0) {
            return Some(Hit { t, gap });
        }
        let closing = slope.closing(&gap) + slope.slack;
        // When the separation grows, or shrinks too slowly to reach the margin before `until`, this plane proves the
        // rest of the move clear.
        let next = t + excess / closing * (1.0 - 4.0 * f64::EPSILON);
        if closing <= 0.0 || next > until {
            return None;
        }
        if !(next > t) {
            return Some(Hit { t, gap });
        }
        t = next;
        hint = Some(gap.normal);
    }
    let gap = gap(element, mover, scale(displacement, t), hint);
    Some(Hit { t, gap })
}

/// Returns the least distance over the move as `(t, distance)`; `None` when it is proven to exceed `cutoff` (mm).
pub(crate) fn least(
    element: &Piece,
    mover: &Piece,
    displacement: Vec3,
    cutoff: f64,
) -> Option<(f64, f64)> {
    let slope = Slope::of(displacement);
    let at = |t: f64, hint| gap(element, mover, scale(displacement, t), hint);
    let mut left = Tangent::at(0.0, &at(0.0, None), &slope);
    if left.value.max(left.value - left.fall) <= 0.0 {
        return Some((0.0, 0.0));
    }
    if left.value - left.fall.max(0.0) > cutoff {
        return None;
    }
    let mut best = left.point();
    if left.fall <= 0.0 {
        return within(best, cutoff);
    }
    let mut right = Tangent::at(1.0, &at(1.0, None), &slope);
    best = nearer(best, right.point());
    if right.fall >= 0.0 {
        return within(best, cutoff);
    }
    for _ in 0..MOST_TANGENTS {
        let (t, bound) = left.crossing(&right);
        if bound > cutoff {
            return None;
        }
        if best.1 - bound <= RESOLUTION_MM || !(t > left.t && t < right.t) {
            break;
        }
        let middle = Tangent::at(t, &at(t, Some(left.normal)), &slope);
        best = nearer(best, middle.point());
        if middle.value <= 0.0 {
            return Some((t, 0.0));
        }
        if middle.fall > 0.0 {
            left = middle;
        } else {
            right = middle;
        }
    }
    within(best, cutoff)
}

/// Separation by one plane along the move: it is `value` at `t` and falls by `fall` over the whole move.
#[derive(Debug, Clone, Copy)]
struct Tangent {
    t: f64,
    value: f64,
    fall: f64,
    normal: Vec3,
}

impl Tangent {
    fn at(t: f64, gap: &Gap, slope: &Slope) -> Tangent {
        Tangent {
            t,
            value: gap.lower,
            fall: slope.closing(gap),
            normal: gap.normal,
        }
    }

    fn point(&self) -> (f64, f64) {
        (self.t, self.value.max(0.0))
    }

    /// Returns fraction and height at which the falling tangent crosses the rising one.
    fn crossing(&self, right: &Tangent) -> (f64, f64) {
        let width = right.t - self.t;
        let drop = self.fall - right.fall;
        let t = self.t + (self.value - right.value - right.fall * width) / drop;
        (t, self.value - self.fall * (t - self.t))
    }
}

fn nearer(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.1 < a.1 { b } else { a }
}

fn within(best: (f64, f64), cutoff: f64) -> Option<(f64, f64)> {
    (best.1 <= cutoff).then_some(best)
}
