//! Distance between two convex pieces, with a proof of its lower bound.
//!
//! **Proof.** For a direction `n` (any non-zero vector), the plane normal to `n` separates the pieces by at least
//! `(n·c - extent_a(n) - extent_b(-n)) / |n|`, where `c` is the vector between their centres. [`separation`] evaluates
//! exactly this and subtracts a forward error bound ([`NOISE`]). Every *clear* of this module
//! follows from planes evaluated in this way, and not from iteration counts, convergence or a simplex. The searches
//! below only propose planes. A search that fails proposes a poor plane, whose bound is low, and that means blocked.
//!
//! **Search.** [`upright`] proposes the best plane of two upright pieces in closed form. [`simplex`] walks to the best
//! plane of any two convex pieces, and [`polish`] finds its last digits.

mod polish;
pub(crate) mod simplex;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod upright;

use super::piece::{NOISE, Piece};
use super::vector::{Vec3, add, dot, length, negate, reach, scale, sub};

/// Difference of lower and upper bound at which a search stops, mm: a thousandth of the distance by which a move may be
/// blocked early.
pub(crate) const RESOLUTION_MM: f64 = 1e-9;

/// Lower bound of the distance between an element and a mover, with its plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    /// Proven separation along `normal`, mm; a value of 0 or less proves nothing.
    pub(crate) lower: f64,
    /// Normal of the best plane: unit vector from the element to the mover.
    pub(crate) normal: Vec3,
    /// Nearest point of the element.
    pub(crate) on_element: Vec3,
}

/// A proposed plane, and a point that supports it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Proposal {
    /// Unit vector from `a` to `b`.
    pub(crate) normal: Vec3,
    /// Point of `a`, relative to its centre.
    pub(crate) on_a: Vec3,
}

/// Returns the rounding bound of one evaluated plane between two pieces, mm.
///
/// Only the difference of the positions counts: an offset of a kilometre that both pieces share costs no digit.
pub(crate) fn noise(a: &Piece, b: &Piece, shift: Vec3) -> f64 {
    NOISE * (a.span + b.span + reach(shift) + reach(between(a, b, shift)))
}

/// Returns the vector from the centre of `a` to the centre of `b` after `shift`.
pub(crate) fn between(a: &Piece, b: &Piece, shift: Vec3) -> Vec3 {
    add(sub(b.centre, a.centre), shift)
}

/// Returns the proven separation along `n`, mm; negative when this plane proves nothing.
pub(crate) fn separation(a: &Piece, b: &Piece, shift: Vec3, n: Vec3) -> f64 {
    let apart = dot(n, between(a, b, shift)) - a.extent(n) - b.extent(negate(n));
    let proven = apart / length(n) - noise(a, b, shift);
    if proven.is_nan() {
        f64::NEG_INFINITY
    } else {
        proven
    }
}

/// Returns a lower bound of the distance of `mover`, displaced by `shift`, from `element`.
///
/// `hint` is a direction that may already be good, such as the best plane of an earlier call for the same pair.
pub(crate) fn gap(element: &Piece, mover: &Piece, shift: Vec3, hint: Option<Vec3>) -> Gap {
    let c = between(element, mover, shift);
    let (proposal, lower) = if element.upright && mover.upright {
        closed_form(element, mover, shift, c)
    } else {
        let proposal = simplex::propose(element, mover, c, hint);
        (proposal, separation(element, mover, shift, proposal.normal))
    };
    Gap {
        lower,
        normal: scale(proposal.normal, 1.0 / length(proposal.normal)),
        on_element: add(element.centre, proposal.on_a),
    }
}

/// Returns the proposal of the closed form, refined by the general search when its direction is the difference of large
/// numbers (two corners a micrometre apart).
fn closed_form(element: &Piece, mover: &Piece, shift: Vec3, c: Vec3) -> (Proposal, f64) {
    let (proposal, distance) = upright::propose(element, mover, c);
    let lower = separation(element, mover, shift, proposal.normal);
    let lost = distance - lower - 2.0 * noise(element, mover, shift);
    if lost <= RESOLUTION_MM || distance <= RESOLUTION_MM {
        return (proposal, lower);
    }
    let sharper = simplex::propose(element, mover, c, Some(proposal.normal));
    let better = separation(element, mover, shift, sharper.normal);
    if better > lower {
        (sharper, better)
    } else {
        (proposal, lower)
    }
}
