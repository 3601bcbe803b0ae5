//! Exact answers in whole numbers for some bodies: the reference for tests and benchmarks.
//!
//! Bodies are blocks whose orientation is a quaternion of integers, upright cylinders, and triangles. Moves are
//! straight. Sizes, places and moves are integer multiples of a unit that the caller chooses (such as 1/1024 mm). The
//! verdict is therefore the sign of an integer, without rounding, tolerance or search. This module shares no code with
//! the core.
//!
//! - `polytope` handles two polytopes, `round` a cylinder with a cylinder or with an upright block.
//! - The verdict is exact. The time of first contact is accurate to a few units in the last place of an `f64`, because
//!   roots may be irrational.
//! - [`first_contact`] panics for a cylinder with a tilted block or a triangle, which have no closed form in whole
//!   numbers.
//!
//! Range: differences of places, sizes and moves below 2^28 units, quaternions with one-digit members; moves along few
//! axes may be longer. Beyond this range a debug build panics on overflow.

mod polytope;
mod round;
mod times;

use super::{Mesh, Pose, Shape};
use polytope::Polytope;

/// A body at a place; lengths in units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Place of the body's centre, the origin of its form.
    pub centre: [i64; 3],
    /// Form of the body.
    pub form: Form,
}

/// Form of a body; lengths in units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// Block, in any orientation.
    Block {
        /// Half extents in the frame of the block.
        half: [i64; 3],
        /// Quaternion `[w, x, y, z]` of any length but zero.
        rotation: [i64; 4],
    },
    /// Cylinder about z.
    Cylinder {
        /// Radius.
        radius: i64,
        /// Half of the height.
        half: i64,
    },
    /// Triangle: corners relative to the centre; they must not lie on one line.
    Triangle([[i64; 3]; 3]),
}

/// Rotation of an upright body: the identity quaternion.
pub const UPRIGHT: [i64; 4] = [1, 0, 0, 0];

impl Body {
    /// Returns an upright block.
    pub fn block(centre: [i64; 3], half: [i64; 3]) -> Body {
        let rotation = UPRIGHT;
        Body {
            centre,
            form: Form::Block { half, rotation },
        }
    }

    /// Returns an upright cylinder of height `2 * half`.
    pub fn cylinder(centre: [i64; 3], radius: i64, half: i64) -> Body {
        Body {
            centre,
            form: Form::Cylinder { radius, half },
        }
    }

    /// Returns the same body displaced by `by`.
    pub fn moved(self, by: [i64; 3]) -> Body {
        Body {
            centre: [0, 1, 2].map(|axis| self.centre[axis] + by[axis]),
            ..self
        }
    }

    /// Returns the body as a [`Shape`] of the core; with a power of two as `unit_mm` nothing is rounded.
    pub fn shape(&self, unit_mm: f64) -> Shape {
        let mm = |units: i64| units as f64 * unit_mm;
        match self.form {
            Form::Block { half, .. } => Shape::Block { half: half.map(mm) },
            Form::Cylinder { radius, half } => Shape::Cylinder {
                radius: mm(radius),
                height: 2.0 * mm(half),
            },
            Form::Triangle(corners) => Shape::Mesh(Mesh {
                vertices: corners.map(|corner| corner.map(mm)).to_vec(),
                triangles: vec![[0, 1, 2]],
            }),
        }
    }

    /// Returns the place of the body as a [`Pose`] of the core.
    pub fn pose(&self, unit_mm: f64) -> Pose {
        let rotation = match self.form {
            Form::Block { rotation, .. } => rotation,
            Form::Cylinder { .. } | Form::Triangle(_) => UPRIGHT,
        };
        Pose {
            position: self.centre.map(|units| units as f64 * unit_mm),
            rotation: rotation.map(|member| member as f64),
        }
    }
}

/// Returns the fraction of `run` at which `mover` first touches `element`; `None` when it never does.
///
/// # Panics
/// Panics for a cylinder with a tilted block or a triangle, and for a triangle whose corners lie on one line.
pub fn first_contact(element: &Body, mover: &Body, run: [i64; 3]) -> Option<f64> {
    let apart = [0, 1, 2].map(|axis| i128::from(mover.centre[axis] - element.centre[axis]));
    let run = run.map(i128::from);
    match (Polytope::of(&element.form), Polytope::of(&mover.form)) {
        (Some(a), Some(b)) => polytope::first_contact(&a, &b, apart, run),
        _ => round::first_contact(&element.form, &mover.form, apart, run),
    }
}
