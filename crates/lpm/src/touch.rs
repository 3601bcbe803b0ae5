//! Place and normal of the contact of two upright pieces, in closed form.
//!
//! At the first contact the mover has just reached one of the figures of [`meeting`](super::meeting): a slab of the
//! height, a side, or a round corner. The contact is with the figure that the mover has entered least deeply; for
//! bodies that overlap from the start, this gives the shortest way to separate them.

use super::distance::Gap;
use super::prism::Prism;
use super::vector::{Vec3, add};

/// Side or corner of the footprints that the mover has entered least deeply.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// Distance of the mover beyond the side, mm; negative when it has entered.
    beyond: f64,
    /// Unit vector from the element to the mover.
    normal: [f64; 2],
    /// Point of the element, relative to its centre.
    at: [f64; 2],
}

/// Returns true only when the footprints of two pieces, whose centres lie `apart`, are provably farther from each other
/// than `by` (mm, above 0, rounding included). Compares squares and combines conditions without branches, because a
/// mispredicted branch costs more.
#[inline(always)]
pub(crate) fn lie_apart(element: &Prism, mover: &Prism, apart: Vec3, by: f64) -> bool {
    if are_askew(element, mover) {
        let Askew {
            over_element: [a, b],
            over_mover: [c, d],
            ..
        } = Askew::of(element, mover, apart);
        return (a > by) | (b > by) | (c > by) | (d > by);
    }
    let framed = if element.radius > 0.0 { mover } else { element };
    let p = into(framed, [apart[0], apart[1]]);
    let over = |axis: usize| (p[axis].abs() - element.half[axis] - mover.half[axis]).max(0.0);
    let within = element.radius + mover.radius + by;
    over(0) * over(0) + over(1) * over(1) > within * within
}

/// Returns true when both pieces are rectangles without a common axis.
#[inline(always)]
fn are_askew(element: &Prism, mover: &Prism) -> bool {
    let differ = (element.axis[0] != mover.axis[0]) | (element.axis[1] != mover.axis[1]);
    (element.radius + mover.radius == 0.0) & differ
}

/// Returns the contact of two pieces; `apart` runs from the centre of the element to that of the mover. Selects the
/// side by arithmetic, because branches here are unpredictable.
#[inline(always)]
pub(crate) fn touch(element: &Prism, mover: &Prism, apart: Vec3) -> Gap {
    let side = side(element, mover, apart);
    let height = shared(element.half[2], mover.half[2], apart[2]);
    let up = 1.0f64.copysign(apart[2]);
    let above = apart[2].abs() - element.half[2] - mover.half[2];
    let is_above = above > side.beyond;
    let level = |axis: usize| either(is_above, 0.0, side.normal[axis]);
    let z = either(is_above, element.half[2] * up, height);
    Gap {
        lower: 0.0,
        normal: [level(0), level(1), either(is_above, up, 0.0)],
        on_element: add(element.centre, [side.at[0], side.at[1], z]),
    }
}

/// Returns `a` if `is_so`, else `b`, without a branch.
#[inline(always)]
fn either(is_so: bool, a: f64, b: f64) -> f64 {
    let mask = u64::from(is_so).wrapping_neg();
    f64::from_bits(a.to_bits() & mask | b.to_bits() & !mask)
}

#[inline(always)]
fn side(element: &Prism, mover: &Prism, apart: Vec3) -> Side {
    if are_askew(element, mover) {
        return askew(element, mover, apart);
    }
    let framed = if element.radius > 0.0 { mover } else { element };
    rounded(element, mover, framed, apart)
}

/// Returns the side for rectangles with common axes, discs, or one of each; `framed` is the piece whose axes the
/// computation uses.
#[inline(always)]
fn rounded(element: &Prism, mover: &Prism, framed: &Prism, apart: Vec3) -> Side {
    let p = into(framed, [apart[0], apart[1]]);
    let radius = element.radius + mover.radius;
    let over = |axis: usize| p[axis].abs() - element.half[axis] - mover.half[axis];
    let over = [over(0), over(1)];
    let (beyond, normal) = if (over[0] > 0.0) & (over[1] > 0.0) {
        let size = (over[0] * over[0] + over[1] * over[1]).sqrt();
        let normal = |axis: usize| (over[axis] / size).copysign(p[axis]);
        (size, [normal(0), normal(1)])
    } else {
        let is_across = over[1] > over[0];
        let normal = [
            either(is_across, 0.0, 1.0f64.copysign(p[0])),
            either(is_across, 1.0f64.copysign(p[1]), 0.0),
        ];
        (larger(over[1], over[0]), normal)
    };
    let at = |axis: usize| {
        let middle = shared(element.half[axis], mover.half[axis], p[axis]);
        middle + element.radius * normal[axis]
    };
    Side {
        beyond: beyond - radius,
        normal: out_of(framed, normal),
        at: out_of(framed, [at(0), at(1)]),
    }
}

/// Returns the side for two rectangles turned against each other; each rectangle may touch one of two sides of the
/// other.
#[inline(always)]
fn askew(element: &Prism, mover: &Prism, apart: Vec3) -> Side {
    let seen = Askew::of(element, mover, apart);
    let (own, other) = (seen.over_element, seen.over_mover);
    let is_own = larger(own[0], own[1]) >= larger(other[0], other[1]);
    let (beyond, normal, at) = if is_own {
        seen.on_a_side(element, mover)
    } else {
        seen.on_a_corner(element)
    };
    Side {
        beyond,
        normal: out_of(element, normal),
        at: out_of(element, at),
    }
}

/// Two rectangles turned against each other, described along the axes of both.
struct Askew {
    /// Vector from the element to the mover along the axes of the element, mm.
    in_element: [f64; 2],
    /// Vector from the element to the mover along the axes of the mover, mm.
    in_mover: [f64; 2],
    /// First axis of the mover, along the axes of the element: `cos` is its first component, `sin` its second.
    cos: f64,
    sin: f64,
    /// Distance of the mover beyond the sides of the element, mm.
    over_element: [f64; 2],
    /// Distance of the element beyond the sides of the mover, mm.
    over_mover: [f64; 2],
}

impl Askew {
    #[inline(always)]
    fn of(element: &Prism, mover: &Prism, apart: Vec3) -> Askew {
        let ([a, b, _], [c, d, _]) = (element.half, mover.half);
        let apart = [apart[0], apart[1]];
        let (p, q) = (into(element, apart), into(mover, apart));
        let [cos, sin] = into(element, mover.axis);
        let (wide, narrow) = (cos.abs(), sin.abs());
        Askew {
            in_element: p,
            in_mover: q,
            cos,
            sin,
            over_element: [
                p[0].abs() - a - (c * wide + d * narrow),
                p[1].abs() - b - (c * narrow + d * wide),
            ],
            over_mover: [
                q[0].abs() - c - (a * wide + b * narrow),
                q[1].abs() - d - (a * narrow + b * wide),
            ],
        }
    }

    /// Returns depth, normal and point, along the axes of the element, when a corner of the mover touches a side of the
    /// element.
    #[inline(always)]
    fn on_a_side(&self, element: &Prism, mover: &Prism) -> (f64, [f64; 2], [f64; 2]) {
        let [a, b, _] = element.half;
        let [first, second] = self.over_element;
        // Offset of the touching corner from the centre of the mover, along the side.
        let corner = |sign: f64, towards: [f64; 2], along: [f64; 2]| {
            let of = |axis: usize| along[axis] * mover.half[axis].copysign(sign * towards[axis]);
            -(of(0) + of(1))
        };
        if first >= second {
            let sign = 1.0f64.copysign(self.in_element[0]);
            let tip =
                self.in_element[1] + corner(sign, [self.cos, -self.sin], [self.sin, self.cos]);
            (first, [sign, 0.0], [a * sign, within(tip, b)])
        } else {
            let sign = 1.0f64.copysign(self.in_element[1]);
            let tip =
                self.in_element[0] + corner(sign, [self.sin, self.cos], [self.cos, -self.sin]);
            (second, [0.0, sign], [within(tip, a), b * sign])
        }
    }

    /// Returns depth, normal and point as [`Self::on_a_side`] does, when a corner of the element touches a side of the
    /// mover.
    #[inline(always)]
    fn on_a_corner(&self, element: &Prism) -> (f64, [f64; 2], [f64; 2]) {
        let [first, second] = self.over_mover;
        let (beyond, outward) = if first >= second {
            let sign = 1.0f64.copysign(self.in_mover[0]);
            (first, [self.cos * sign, self.sin * sign])
        } else {
            let sign = 1.0f64.copysign(self.in_mover[1]);
            (second, [-self.sin * sign, self.cos * sign])
        };
        let corner = |axis: usize| element.half[axis].copysign(outward[axis]);
        (beyond, outward, [corner(0), corner(1)])
    }
}

/// Returns the middle of the overlap of two intervals, about 0 and about `apart`; without an overlap, the end of the
/// first interval that is nearer to the second.
#[inline(always)]
fn shared(half: f64, other: f64, apart: f64) -> f64 {
    let low = larger(-half, apart - other);
    let high = smaller(half, apart + other);
    within((low + high) / 2.0, half)
}

/// Limits `x` to the range from `-half` to `half`.
#[inline(always)]
fn within(x: f64, half: f64) -> f64 {
    smaller(larger(x, -half), half)
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Converts a vector from the common frame into the axes of a footprint.
#[inline(always)]
fn into(framed: &Prism, v: [f64; 2]) -> [f64; 2] {
    // Most footprints are aligned with x and y, so this branch predicts well.
    if framed.is_straight() {
        return v;
    }
    let [x, y] = framed.axis;
    [v[0] * x + v[1] * y, v[1] * x - v[0] * y]
}

/// Converts a vector from the axes of a footprint into the common frame.
#[inline(always)]
fn out_of(framed: &Prism, local: [f64; 2]) -> [f64; 2] {
    if framed.is_straight() {
        return local;
    }
    let [x, y] = framed.axis;
    [local[0] * x - local[1] * y, local[0] * y + local[1] * x]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::distance::tests::Dice;
    use crate::prism::Checked;
    use crate::vector::{along, length};
    use crate::{Pose, Shape};

    fn drawn(dice: &mut Dice) -> Prism {
        let size = |dice: &mut Dice| 1.5 + dice.signed();
        let shape = if dice.pick(3) == 0 {
            Shape::Cylinder {
                radius: size(dice),
                height: size(dice),
            }
        } else {
            Shape::Block {
                half: [size(dice), size(dice), size(dice)],
            }
        };
        let yaw = if dice.pick(2) == 0 {
            0.0
        } else {
            3.0 * dice.signed()
        };
        let single = Checked::of(&shape).unwrap().single.unwrap();
        Prism::standing(&single, &Pose::yawed(dice.vector(), yaw)).unwrap()
    }

    fn depth(element: &Prism, mover: &Prism, n: Vec3) -> f64 {
        let apart = [0, 1, 2].map(|axis| mover.centre[axis] - element.centre[axis]);
        let [a, b] = [element.piece(), mover.piece()];
        a.extent(n) + b.extent(n.map(|member| -member))
            - (0..3).map(|axis| apart[axis] * n[axis]).sum::<f64>()
    }

    #[test]
    fn moving_by_the_depth_along_the_normal_separates_bodies() {
        let mut dice = Dice::new(21);
        let mut deep = 0;
        for _ in 0..2_000 {
            let (element, mover) = (drawn(&mut dice), drawn(&mut dice));
            let apart = [0, 1, 2].map(|axis| mover.centre[axis] - element.centre[axis]);
            let gap = touch(&element, &mover, apart);
            assert!((length(gap.normal) - 1.0).abs() < 1e-12);
            let out = depth(&element, &mover, gap.normal);
            let up = [0.0, 0.0, 1.0f64.copysign(apart[2])];
            assert!(out <= depth(&element, &mover, up) + 1e-9);
            deep += u32::from(out > 0.1);
            let moved = along(apart, out + 1e-9, gap.normal);
            let mut shifted = mover;
            shifted.centre = add(element.centre, moved);
            assert!(depth(&element, &shifted, gap.normal) <= 0.0);
            let piece = element.piece();
            let point = [0, 1, 2].map(|axis| gap.on_element[axis] - element.centre[axis]);
            for n in [
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [0.6, 0.8, 0.0],
            ] {
                let reach = (0..3).map(|axis| point[axis] * n[axis]).sum::<f64>();
                assert!(
                    reach.abs() <= piece.extent(n) + 1e-9,
                    "{element:?} {mover:?} {gap:?}"
                );
            }
        }
        assert!(deep > 500, "only {deep}");
    }
}
