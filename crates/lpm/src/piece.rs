//! Convex pieces; every placed body consists of them.
//!
//! A block and a cylinder are one piece each, a compound has the pieces of its parts, and a mesh has one piece per
//! triangle. The distance functions need only the support of a piece: how far it reaches along a direction, and a point
//! of it that reaches as far.

use super::pose::{Frame, Pose};
use super::prism::Prism;
use super::shape::Shape;
use super::vector::{Vec3, add, along, cross, dot, length, negate, reach, scale, sub};

/// Relative error bound of the whole computation from the numbers of a scene to one evaluated plane, in units of the
/// sum of all magnitudes that entered.
///
/// The count is generous: a rotation matrix from a quaternion takes 8 roundings; two nested compounds, a turn and a
/// support sum take fewer than 40 more. 96 roundings of 2^-53 each are twice as many. At 1e6 mm this bound is below
/// 1e-7 mm, well inside the 1e-6 mm by which a move may be blocked early.
pub(crate) const NOISE: f64 = 96.0 * (f64::EPSILON / 2.0);

/// Form of a piece, relative to its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// Half extents along the axes of the frame, mm.
    Block(Vec3),
    /// A cylinder about the z axis of the frame.
    Cylinder {
        /// Radius, mm.
        radius: f64,
        /// Half of the height, mm.
        half: f64,
    },
    /// Corners relative to the centre, mm; along the axes of the parent, not of the frame.
    Triangle([Vec3; 3]),
}

/// A convex closed set at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub(crate) centre: Vec3,
    pub(crate) frame: Frame,
    pub(crate) form: Form,
    /// Sum of the magnitudes that were rounded when centre and extents were computed, mm; rounding errors scale with
    /// this sum. A place that exact sums have reached adds nothing.
    pub(crate) span: f64,
    /// True for a block or cylinder whose own z axis is exactly vertical, so that closed forms apply.
    pub(crate) upright: bool,
}

impl Piece {
    fn new(centre: Vec3, frame: Frame, form: Form, span: f64) -> Piece {
        let upright = match form {
            Form::Block(_) => frame.is_upright(),
            Form::Cylinder { .. } => frame.is_vertical(),
            Form::Triangle(_) => false,
        };
        Piece {
            centre,
            frame,
            form,
            span,
            upright,
        }
    }

    /// Returns the piece after its parent frame is turned by `frame` and placed at `position`.
    pub(crate) fn placed(&self, frame: &Frame, position: Vec3) -> Piece {
        let form = match self.form {
            Form::Block(_) | Form::Cylinder { .. } => self.form,
            Form::Triangle(corners) => Form::Triangle(corners.map(|corner| frame.apply(corner))),
        };
        let (centre, span) = self.place(frame, position);
        Piece::new(centre, frame.then(&self.frame), form, span)
    }

    /// Returns centre and span of the piece after its parent frame is turned by `frame` and placed at `position`.
    #[inline]
    pub(crate) fn place(&self, frame: &Frame, position: Vec3) -> (Vec3, f64) {
        let turned = if frame.is_identity() {
            self.centre
        } else {
            frame.apply(self.centre)
        };
        let mut span = self.span;
        if !frame.is_identity() {
            span += reach(self.centre);
        }
        if !is_exact_sum(turned, position) {
            span += reach(position) + reach(turned);
        }
        (add(turned, position), span)
    }

    /// Returns how far the piece reaches along `n` from its centre: the support function.
    pub(crate) fn extent(&self, n: Vec3) -> f64 {
        match self.form {
            Form::Block(half) => {
                half[0] * dot(self.frame.x, n).abs()
                    + half[1] * dot(self.frame.y, n).abs()
                    + half[2] * dot(self.frame.z, n).abs()
            }
            Form::Cylinder { radius, half } => {
                half * dot(self.frame.z, n).abs() + radius * length(cross(self.frame.z, n))
            }
            Form::Triangle([a, b, c]) => dot(a, n).max(dot(b, n)).max(dot(c, n)),
        }
    }

    /// Returns a point of the piece, relative to its centre, that reaches [`Piece::extent`].
    pub(crate) fn farthest(&self, n: Vec3) -> Vec3 {
        match self.form {
            Form::Block(half) => {
                let x = scale(self.frame.x, half[0].copysign(dot(self.frame.x, n)));
                let y = scale(self.frame.y, half[1].copysign(dot(self.frame.y, n)));
                let z = scale(self.frame.z, half[2].copysign(dot(self.frame.z, n)));
                add(add(x, y), z)
            }
            Form::Cylinder { radius, half } => {
                let axis = self.frame.z;
                let cap = scale(axis, half.copysign(dot(axis, n)));
                let outward = cross(cross(axis, n), axis);
                let size = length(outward);
                if size > 1e-150 {
                    along(cap, radius / size, outward)
                } else {
                    cap
                }
            }
            Form::Triangle(corners) => {
                let reaches = corners.map(|corner| dot(corner, n));
                if reaches[0] >= reaches[1] && reaches[0] >= reaches[2] {
                    corners[0]
                } else if reaches[1] >= reaches[2] {
                    corners[1]
                } else {
                    corners[2]
                }
            }
        }
    }

    /// Returns the largest distance of a point of the piece from its centre, mm, rounded outward.
    pub(crate) fn radius(&self) -> f64 {
        let exact = match self.form {
            Form::Block(half) => length(half),
            Form::Cylinder { radius, half } => radius.hypot(half),
            Form::Triangle([a, b, c]) => length(a).max(length(b)).max(length(c)),
        };
        exact * (1.0 + 4.0 * f64::EPSILON)
    }

    /// Returns the bounding box `(low, high)` of the piece at its place, rounded outward by [`NOISE`].
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        if self.upright {
            return Prism::of(self).bounds();
        }
        let noise = NOISE * (self.span + reach(self.centre));
        let mut low = self.centre;
        let mut high = self.centre;
        for axis in 0..3 {
            let mut n = [0.0; 3];
            n[axis] = 1.0;
            high[axis] += self.extent(n) + noise;
            low[axis] -= self.extent(negate(n)) + noise;
        }
        (low, high)
    }
}

/// Returns true when `a + b` is exact in f64 (error term of the sum after Knuth).
#[inline]
pub(crate) fn is_exact_sum(a: Vec3, b: Vec3) -> bool {
    (0..3).all(|axis| {
        let sum = a[axis] + b[axis];
        let second = sum - a[axis];
        (a[axis] - (sum - second)) + (b[axis] - second) == 0.0
    })
}

/// Returns all pieces of a checked shape, in its own frame.
pub(crate) fn pieces_of(shape: &Shape) -> Vec<Piece> {
    let mut pieces = Vec::new();
    each_piece(shape, |piece| pieces.push(piece));
    pieces
}

/// Passes all pieces of a checked shape, in its own frame, to `show`.
pub(crate) fn each_piece(shape: &Shape, mut show: impl FnMut(Piece)) {
    descend(shape, &Frame::IDENTITY, [0.0; 3], 0.0, &mut show);
}

/// Visits a shape and its parts. `span` is the contribution of the parents' positions to [`Piece::span`].
fn descend(shape: &Shape, frame: &Frame, centre: Vec3, span: f64, show: &mut impl FnMut(Piece)) {
    match shape {
        Shape::Block { half } => {
            show(Piece::new(
                centre,
                *frame,
                Form::Block(*half),
                span + reach(*half),
            ));
        }
        Shape::Cylinder { radius, height } => {
            let form = Form::Cylinder {
                radius: *radius,
                half: height / 2.0,
            };
            show(Piece::new(
                centre,
                *frame,
                form,
                span + 2.0 * radius + height,
            ));
        }
        Shape::Compound(parts) => {
            for (Pose { position, rotation }, part) in parts {
                let offset = frame.apply(*position);
                let turned = frame.then(&Frame::of(*rotation));
                let rounded = if frame.is_identity() && is_exact_sum(offset, centre) {
                    0.0
                } else {
                    reach(*position) + reach(centre)
                };
                descend(part, &turned, add(offset, centre), span + rounded, show);
            }
        }
        Shape::Mesh(mesh) => {
            for triangle in &mesh.triangles {
                let corners = triangle.map(|vertex| mesh.vertices[vertex]);
                show(triangle_piece(corners, frame, centre, span));
            }
        }
    }
}

/// Places a triangle; its centre is the middle of its bounding box, so that the corners lie close to it.
fn triangle_piece(corners: [Vec3; 3], frame: &Frame, origin: Vec3, span: f64) -> Piece {
    let placed = corners.map(|corner| add(frame.apply(corner), origin));
    let mut middle = [0.0; 3];
    for (axis, member) in middle.iter_mut().enumerate() {
        let low = placed[0][axis].min(placed[1][axis]).min(placed[2][axis]);
        let high = placed[0][axis].max(placed[1][axis]).max(placed[2][axis]);
        *member = low + (high - low) / 2.0;
    }
    let largest = corners
        .iter()
        .fold(0.0_f64, |most, corner| most.max(reach(*corner)));
    let form = Form::Triangle(placed.map(|corner| sub(corner, middle)));
    Piece::new(middle, Frame::IDENTITY, form, span + 3.0 * largest)
}
