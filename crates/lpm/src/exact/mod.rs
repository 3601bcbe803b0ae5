//! Exact truth for a part of the world, in whole numbers: what the core is measured against.
//!
//! Bodies are blocks in any orientation that a quaternion of whole numbers gives, upright cylinders,
//! and triangles; moves are straight; sizes, places and moves are whole multiples of one unit that
//! the asker chooses (1/1024 mm, say). For these the verdict is the sign of whole numbers: no
//! rounding, no tolerance, no search, and not a line shared with the core.
//!
//! - Two polytopes: `polytope`. A cylinder with a cylinder or an upright block: `round`.
//! - The verdict is exact; the time of first contact is its nearest `f64` to a few units in the last
//!   place, because roots are irrational.
//! - A tilted block and a cylinder: [`first_contact`] panics. There is no closed form in whole numbers.
//!
//! Range: differences of places, sizes and moves below 2^28 units, quaternions of single digits;
//! moves along few axes may be longer. Beyond it a debug build panics on overflow.

mod polytope;
mod round;
mod times;

use super::{Mesh, Pose, Shape};
use polytope::Polytope;

/// A body at a place, in units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Where its origin stands.
    pub centre: [i64; 3],
    /// Its form.
    pub form: Form,
}

/// Form of a body, in units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// Half extents in its own frame, and the quaternion `[w, x, y, z]` of that frame.
    Block {
        /// Half extents.
        half: [i64; 3],
        /// Any length but zero.
        rotation: [i64; 4],
    },
    /// About z.
    Cylinder {
        /// Radius.
        radius: i64,
        /// Half of the height.
        half: i64,
    },
    /// Corners relative to the centre; not shrunk to a segment or a point.
    Triangle([[i64; 3]; 3]),
}

/// No turn, as a quaternion.
pub const UPRIGHT: [i64; 4] = [1, 0, 0, 0];

impl Body {
    /// An upright block.
    pub fn block(centre: [i64; 3], half: [i64; 3]) -> Body {
        let rotation = UPRIGHT;
        Body {
            centre,
            form: Form::Block { half, rotation },
        }
    }

    /// An upright cylinder of twice the height `half`.
    pub fn cylinder(centre: [i64; 3], radius: i64, half: i64) -> Body {
        Body {
            centre,
            form: Form::Cylinder { radius, half },
        }
    }

    /// The same body elsewhere.
    pub fn moved(self, by: [i64; 3]) -> Body {
        Body {
            centre: [0, 1, 2].map(|axis| self.centre[axis] + by[axis]),
            ..self
        }
    }

    /// The body as the core knows it; `unit_mm` should be a power of two, so that nothing is rounded.
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

    /// Its place as the core knows it.
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

/// Fraction of `run` at which `mover` first touches `element`; `None` when it never does.
///
/// # Panics
/// A tilted block or a triangle with a cylinder; a triangle shrunk to a segment.
pub fn first_contact(element: &Body, mover: &Body, run: [i64; 3]) -> Option<f64> {
    let apart = [0, 1, 2].map(|axis| i128::from(mover.centre[axis] - element.centre[axis]));
    let run = run.map(i128::from);
    match (Polytope::of(&element.form), Polytope::of(&mover.form)) {
        (Some(a), Some(b)) => polytope::first_contact(&a, &b, apart, run),
        _ => round::first_contact(&element.form, &mover.form, apart, run),
    }
}
