//! Straight moves: first contact and least distance of two convex pieces, exact and continuous.
//!
//! While a convex piece is translated past another one, their distance is a convex function of the
//! way, and each separating plane found on the way is a tangent below it: along the move the
//! separation by a fixed plane is linear. So Newton's method from the left never oversteps the
//! first contact ([`first_within`]), and the crossing of a falling and a rising tangent is a proven
//! lower bound of the least distance ([`least`]). Nothing is stepped; a ten metre move over a foil
//! costs the same as a short one.

use super::distance::{Gap, RESOLUTION_MM, gap};
use super::piece::{NOISE, Piece};
use super::vector::{Vec3, dot, reach, scale};

/// Tangents per query. Newton needs 3 to 8, a grazing pass (double root) up to 30.
const MOST_TANGENTS: usize = 128;

/// When a pair first comes within the margin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    /// Fraction of the move, never later than the true one.
    pub(crate) t: f64,
    pub(crate) gap: Gap,
}

impl Hit {
    /// At the start, one body around the other.
    pub(crate) fn inside(point: Vec3) -> Hit {
        let gap = Gap {
            lower: 0.0,
            normal: [0.0, 0.0, 1.0],
            on_element: point,
        };
        Hit { t: 0.0, gap }
    }
}

/// Numbers of one translated pair that stay the same along the move.
struct Slope {
    displacement: Vec3,
    /// Rounding of a shifted plane, mm.
    slack: f64,
}

impl Slope {
    fn of(displacement: Vec3) -> Slope {
        Slope {
            displacement,
            slack: NOISE * reach(displacement),
        }
    }

    /// Distance lost along the whole move by this plane, mm.
    fn closing(&self, gap: &Gap) -> f64 {
        -dot(gap.normal, self.displacement)
    }
}

/// First `t` up to `until` where the distance is within `margin` (mm); `None` is proof that there
/// is none. Whatever cannot be decided is a hit. Before `start` there is none, as the caller has proven.
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
        // NaN is a hit, too.
        if !(excess > 0.0) {
            return Some(Hit { t, gap });
        }
        let closing = slope.closing(&gap) + slope.slack;
        // A plane that the mover leaves, or does not reach in time, keeps it away for good.
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

/// Least distance over the move as `(t, distance)`, or `None` when it is proven to be above `cutoff` (mm).
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

/// Separation by one plane along the move: `value` at `t`, falling by `fall` per whole move.
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

    /// Where the falling tangent meets the rising one, and how high.
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
