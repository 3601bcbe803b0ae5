//! The bodies of the machine: block, cylinder, compound (block-cylinder elements) and mesh.
//!
//! Bodies are closed sets: their surface belongs to them, so touching is contact.

use super::pose::Pose;

/// Largest coordinate or size the arithmetic is proven for, mm.
pub const LARGEST_COORDINATE_MM: f64 = 1e6;

/// Compounds may hold compounds this deep; deeper ones are refused.
const DEEPEST_COMPOUND: usize = 16;

/// A solid body in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Cuboid centred at the origin.
    Block {
        /// Half extents along x, y, z, mm, > 0.
        half: [f64; 3],
    },
    /// Cylinder about z, centred at the origin.
    Cylinder {
        /// Radius, mm, > 0.
        radius: f64,
        /// Whole height along z, mm, > 0.
        height: f64,
    },
    /// Several bodies in one frame that move as one; parts may overlap.
    Compound(
        /// Parts with their place in the frame of the compound.
        Vec<(Pose, Shape)>,
    ),
    /// Triangles.
    Mesh(Mesh),
}

/// Triangles over shared vertices. A closed surface is solid, an open one is its triangles only.
/// Slivers and triangles shrunk to a segment or a point are legal.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Corners, mm.
    pub vertices: Vec<[f64; 3]>,
    /// Three indices into `vertices` each.
    pub triangles: Vec<[usize; 3]>,
}

/// Why a body or a pose is not accepted; the path inside the body is part of the message.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Flaw {
    /// A size is not a finite number above zero (or beyond what the arithmetic covers).
    #[error("{path}: size is {found}, expected above 0 and at most 1e6 mm")]
    Size {
        /// Member of the shape.
        path: String,
        /// What it holds.
        found: f64,
    },
    /// A coordinate is NaN, infinite or beyond 1e6 mm.
    #[error("{path}: coordinate is {found}, expected a finite number within +-1e6 mm")]
    Coordinate {
        /// Member of the pose or vertex.
        path: String,
        /// What it holds.
        found: f64,
    },
    /// A quaternion has no direction.
    #[error(
        "{path}: rotation {found:?} is no rotation, expected a finite non-zero quaternion [w, x, y, z], its squared length above 1e-200 and at most 1e200"
    )]
    Rotation {
        /// Member of the pose.
        path: String,
        /// What it holds.
        found: [f64; 4],
    },
    /// A triangle names a vertex that does not exist.
    #[error("{path}: vertex {found} does not exist, expected below {vertices}")]
    Index {
        /// Member of the mesh.
        path: String,
        /// The index.
        found: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A compound without parts, a mesh without triangles, or nesting without end.
    #[error("{path}: {found}, expected {expected}")]
    Structure {
        /// Member of the shape.
        path: String,
        /// What is wrong.
        found: &'static str,
        /// What is right.
        expected: &'static str,
    },
}

impl Shape {
    /// Accepts exactly the bodies the arithmetic is proven for.
    ///
    /// # Errors
    /// The first [`Flaw`] with its path inside the shape (`half[1]`, `parts[2].radius`).
    #[inline]
    pub fn check(&self) -> Result<(), Flaw> {
        match self {
            // Words are made only where there is something to complain of.
            Shape::Block { half: [a, b, c] } if is_size(a) & is_size(b) & is_size(c) => Ok(()),
            Shape::Cylinder { radius, height } if is_size(radius) & is_size(height) => Ok(()),
            _ => check_shape(self, "", 0),
        }
    }
}

impl Pose {
    /// Accepts positions within 1e6 mm and quaternions with a squared length above 1e-200 and at most 1e200:
    /// [`Pose::rescaled`] brings any other that is finite and not zero there.
    ///
    /// # Errors
    /// [`Flaw::Coordinate`] or [`Flaw::Rotation`].
    #[inline]
    pub fn check(&self) -> Result<(), Flaw> {
        if self.is_sound() {
            Ok(())
        } else {
            check_pose(self, "")
        }
    }

    /// The same pose; a quaternion that is too long or too short for [`Pose::check`] is scaled, by a power of two: it
    /// turns everything exactly as before. Zero and what is not finite stay what they are.
    #[must_use]
    pub fn rescaled(self) -> Pose {
        let [w, x, y, z] = self.rotation;
        if is_turn(w * w + x * x + y * y + z * z) {
            return self;
        }
        let largest = self.rotation.map(f64::abs).into_iter().fold(0.0, f64::max);
        // Exponents are counted from 1023 on: this one makes the largest member 1 to 4 (a subnormal one at least 2^-51).
        let exponent = (2046 - (largest.to_bits() >> 52).min(2046)).max(1);
        let scale = f64::from_bits(exponent << 52);
        Pose {
            rotation: self.rotation.map(|member| member * scale),
            ..self
        }
    }

    /// What [`Pose::check`] accepts.
    #[inline]
    pub(crate) fn is_sound(&self) -> bool {
        let [w, x, y, z] = self.rotation;
        self.is_placed() & is_turn(w * w + x * x + y * y + z * z)
    }

    /// The same of the position alone.
    #[inline]
    pub(crate) fn is_placed(&self) -> bool {
        let [x, y, z] = self.position.map(f64::abs);
        (x <= LARGEST_COORDINATE_MM) & (y <= LARGEST_COORDINATE_MM) & (z <= LARGEST_COORDINATE_MM)
    }
}

fn check_shape(shape: &Shape, path: &str, depth: usize) -> Result<(), Flaw> {
    match shape {
        Shape::Block { half } => {
            for (axis, size) in half.iter().enumerate() {
                check_size(*size, || format!("{path}half[{axis}]"))?;
            }
            Ok(())
        }
        Shape::Cylinder { radius, height } => {
            check_size(*radius, || format!("{path}radius"))?;
            check_size(*height, || format!("{path}height"))
        }
        Shape::Compound(parts) => check_compound(parts, path, depth),
        Shape::Mesh(mesh) => check_mesh(mesh, path),
    }
}

fn check_compound(parts: &[(Pose, Shape)], path: &str, depth: usize) -> Result<(), Flaw> {
    let flaw = |found, expected| Flaw::Structure {
        path: format!("{path}parts"),
        found,
        expected,
    };
    if parts.is_empty() {
        return Err(flaw("no parts", "at least one part"));
    }
    if depth >= DEEPEST_COMPOUND {
        return Err(flaw("compounds nested too deep", "at most 16 levels"));
    }
    for (index, (pose, part)) in parts.iter().enumerate() {
        check_shape(part, &format!("{path}parts[{index}]."), depth + 1)?;
        check_pose(pose, &format!("{path}parts[{index}].pose."))?;
    }
    Ok(())
}

fn check_mesh(mesh: &Mesh, path: &str) -> Result<(), Flaw> {
    if mesh.triangles.is_empty() {
        return Err(Flaw::Structure {
            path: format!("{path}triangles"),
            found: "no triangles",
            expected: "at least one triangle",
        });
    }
    for (index, vertex) in mesh.vertices.iter().enumerate() {
        check_point(*vertex, &format!("{path}vertices[{index}]"))?;
    }
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        for (corner, vertex) in triangle.iter().enumerate() {
            if *vertex >= mesh.vertices.len() {
                return Err(Flaw::Index {
                    path: format!("{path}triangles[{index}][{corner}]"),
                    found: *vertex,
                    vertices: mesh.vertices.len(),
                });
            }
        }
    }
    Ok(())
}

/// Whether a quaternion of this squared length is a turn: outside this range it has lost its digits to under- or
/// overflow; what is not finite is outside, too.
#[inline(always)]
pub(crate) fn is_turn(squared: f64) -> bool {
    is_between(squared, [1e-200, 1e200])
}

#[inline(always)]
fn is_size(found: &f64) -> bool {
    is_between(*found, [0.0, LARGEST_COORDINATE_MM])
}

/// Above the first number, which is not negative, and at most the second, by one comparison: bits of numbers are in the
/// order of the numbers, and those of negative ones and of what is no number come after all others.
#[inline(always)]
fn is_between(found: f64, [above, most]: [f64; 2]) -> bool {
    let first = above.to_bits() + 1;
    found.to_bits().wrapping_sub(first) <= most.to_bits() - first
}

fn check_size(found: f64, path: impl Fn() -> String) -> Result<(), Flaw> {
    if is_size(&found) {
        Ok(())
    } else {
        Err(Flaw::Size {
            path: path(),
            found,
        })
    }
}

fn check_point(point: [f64; 3], path: &str) -> Result<(), Flaw> {
    match point
        .iter()
        .position(|member| !(member.abs() <= LARGEST_COORDINATE_MM))
    {
        None => Ok(()),
        Some(axis) => Err(Flaw::Coordinate {
            path: format!("{path}[{axis}]"),
            found: point[axis],
        }),
    }
}

fn check_pose(pose: &Pose, path: &str) -> Result<(), Flaw> {
    check_point(pose.position, &format!("{path}position"))?;
    if pose.is_sound() {
        Ok(())
    } else {
        Err(Flaw::Rotation {
            path: format!("{path}rotation"),
            found: pose.rotation,
        })
    }
}
