//! Bodies: block, cylinder, compound (several bodies as one) and mesh.
//!
//! Bodies are closed sets: their surface belongs to them, so touching is contact.

use super::pose::Pose;

/// Largest coordinate or size for which the error bounds hold, mm.
pub const LARGEST_COORDINATE_MM: f64 = 1e6;

/// Greatest nesting depth of compounds; [`Shape::check`] refuses deeper ones.
pub(crate) const DEEPEST_COMPOUND: usize = 16;

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
        /// Parts, each with its pose in the frame of the compound.
        Vec<(Pose, Shape)>,
    ),
    /// A body made of triangles.
    Mesh(Mesh),
}

/// Triangles over shared vertices. A closed surface is solid; an open one consists of its triangles only. Thin
/// triangles are legal, even those that degenerate to a segment or a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Vertices, mm.
    pub vertices: Vec<[f64; 3]>,
    /// Triangles, each as three indices into `vertices`.
    pub triangles: Vec<[usize; 3]>,
}

/// Reason why a body or a pose is refused; `path` names the member at fault inside it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Flaw {
    /// A size is not a finite number above 0 and at most 1e6 mm.
    #[error("{path}: size is {found}, expected above 0 and at most 1e6 mm")]
    Size {
        /// Path of the member of the shape.
        path: String,
        /// Value found.
        found: f64,
    },
    /// A coordinate is NaN, infinite or beyond 1e6 mm.
    #[error("{path}: coordinate is {found}, expected a finite number within +-1e6 mm")]
    Coordinate {
        /// Path of the member of the pose or of the vertex.
        path: String,
        /// Value found.
        found: f64,
    },
    /// A quaternion is zero, not finite, or of extreme length.
    #[error(
        "{path}: rotation is {found:?}, expected a finite non-zero quaternion [w, x, y, z], its squared length above 1e-200 and at most 1e200"
    )]
    Rotation {
        /// Path of the member of the pose.
        path: String,
        /// Value found.
        found: [f64; 4],
    },
    /// A triangle names a vertex that does not exist.
    #[error("{path}: vertex {found} does not exist, expected below {vertices}")]
    Index {
        /// Path of the member of the mesh.
        path: String,
        /// Index that the triangle names.
        found: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A compound has no parts, a mesh has no triangles, or compounds are nested too deep.
    #[error("{path}: {found}, expected {expected}")]
    Structure {
        /// Path of the member of the shape.
        path: String,
        /// What was found.
        found: &'static str,
        /// What was expected.
        expected: &'static str,
    },
}

impl Shape {
    /// Checks that the error bounds hold for this body.
    ///
    /// # Errors
    /// Fails with the first [`Flaw`] and its path inside the shape (`half[1]`, `parts[2].radius`).
    #[inline]
    pub fn check(&self) -> Result<(), Flaw> {
        match self {
            // Decides the common case first, without building strings for paths.
            Shape::Block { half } if are_sizes(*half) => Ok(()),
            Shape::Cylinder { radius, height } if are_sizes([*radius, *height]) => Ok(()),
            _ => check_shape(self, "", 0),
        }
    }
}

impl Pose {
    /// Checks that the position is within 1e6 mm, and that the squared length of the quaternion is above 1e-200 and at
    /// most 1e200. [`Pose::rescaled`] scales any other finite non-zero quaternion into this range.
    ///
    /// # Errors
    /// Fails with [`Flaw::Coordinate`] or [`Flaw::Rotation`].
    #[inline]
    pub fn check(&self) -> Result<(), Flaw> {
        if self.is_sound() {
            Ok(())
        } else {
            check_pose(self, "")
        }
    }

    /// Scales a quaternion that is too long or too short for [`Pose::check`] by a power of two, which leaves the
    /// rotation exactly the same. Zero and non-finite quaternions stay unchanged.
    #[must_use]
    pub fn rescaled(self) -> Pose {
        let [w, x, y, z] = self.rotation;
        if is_turn(w * w + x * x + y * y + z * z) {
            return self;
        }
        let largest = self.rotation.map(f64::abs).into_iter().fold(0.0, f64::max);
        // The exponent in IEEE 754 has a bias of 1023: this factor scales the largest member to 1 to 4 (a subnormal one
        // to at least 2^-51).
        let exponent = (2046 - (largest.to_bits() >> 52).min(2046)).max(1);
        let scale = f64::from_bits(exponent << 52);
        Pose {
            rotation: self.rotation.map(|member| member * scale),
            ..self
        }
    }

    /// Returns true when [`Pose::check`] accepts the pose.
    #[inline]
    pub(crate) fn is_sound(&self) -> bool {
        let [w, x, y, z] = self.rotation;
        self.is_placed() & is_turn(w * w + x * x + y * y + z * z)
    }

    /// Returns true when [`Pose::check`] accepts the position.
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

/// Returns true when a quaternion of this squared length is a usable rotation. Outside the range the squared length has
/// lost digits to underflow or overflow; NaN and infinity lie outside as well.
#[inline(always)]
pub(crate) fn is_turn(squared: f64) -> bool {
    is_between(squared, [1e-200, 1e200])
}

/// Returns true when [`Shape::check`] accepts all of these sizes.
#[inline(always)]
pub(crate) fn are_sizes<const N: usize>(found: [f64; N]) -> bool {
    found
        .into_iter()
        .fold(true, |sound, size| sound & is_size(size))
}

#[inline(always)]
fn is_size(found: f64) -> bool {
    is_between(found, [0.0, LARGEST_COORDINATE_MM])
}

/// Returns true when a number lies above the first bound, which is not negative, and is at most the second. One
/// comparison decides: the bit patterns of non-negative numbers sort like the numbers, and those of negative numbers
/// and NaN sort after all others.
#[inline(always)]
fn is_between(found: f64, [above, most]: [f64; 2]) -> bool {
    let first = above.to_bits() + 1;
    found.to_bits().wrapping_sub(first) <= most.to_bits() - first
}

fn check_size(found: f64, path: impl Fn() -> String) -> Result<(), Flaw> {
    if is_size(found) {
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
