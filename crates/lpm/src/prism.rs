//! Upright blocks and cylinders: each is an interval in z times a rectangle or a disc. [`meeting`](super::meeting)
//! computes when two of them meet on a path, [`touch`](super::touch) computes where they touch.

use super::piece::{Form, NOISE, Piece, is_exact_sum};
use super::pose::{Frame, Pose, Yaw};
use super::shape::{self, Flaw, Shape};
use super::vector::{Vec3, add, reach};

/// An upright block or cylinder, reduced to the numbers that closed forms need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prism {
    pub(crate) centre: Vec3,
    /// Half extents, mm: of the footprint along `axis` and across it (both 0 for a disc), and of the height.
    pub(crate) half: Vec3,
    /// Radius of a disc, mm; 0 for a rectangle.
    pub(crate) radius: f64,
    /// First axis of the footprint, within 45 degrees of x.
    pub(crate) axis: [f64; 2],
    /// Scale of rounding errors, mm; see [`Piece::span`].
    pub(crate) span: f64,
}

/// A single block or cylinder, reduced to the numbers of its [`Prism`] that do not depend on its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Single {
    half: Vec3,
    radius: f64,
    span: f64,
}

/// A shape that [`Shape::check`] accepts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Checked<'a> {
    pub(crate) shape: &'a Shape,
    /// The shape as a single block or cylinder; `None` for any other shape.
    pub(crate) single: Option<Single>,
}

impl Checked<'_> {
    /// Checks a shape.
    ///
    /// # Errors
    /// Fails as [`Shape::check`] does.
    #[inline(always)]
    pub(crate) fn of(shape: &Shape) -> Result<Checked<'_>, Flaw> {
        // Nearly every element is a single body; one look at its kind serves check and conversion.
        let single = match shape {
            Shape::Block { half } if shape::are_sizes(*half) => Single {
                half: *half,
                radius: 0.0,
                span: reach(*half),
            },
            Shape::Cylinder { radius, height } if shape::are_sizes([*radius, *height]) => Single {
                half: [0.0, 0.0, height / 2.0],
                radius: *radius,
                span: 2.0 * radius + height,
            },
            _ => {
                shape.check()?;
                let single = None;
                return Ok(Checked { shape, single });
            }
        };
        let single = Some(single);
        Ok(Checked { shape, single })
    }
}

impl Prism {
    /// Converts a piece, which must be upright.
    #[inline]
    pub(crate) fn of(piece: &Piece) -> Prism {
        let (half, radius, axis) = footprint(piece.form, [piece.frame.x[0], piece.frame.x[1]]);
        Prism {
            centre: piece.centre,
            half,
            radius,
            axis,
            span: piece.span,
        }
    }

    /// Places a single block or cylinder; returns `None` when it is not upright at `pose`.
    #[inline(always)]
    pub(crate) fn standing(single: &Single, pose: &Pose) -> Option<Prism> {
        let Single { half, radius, span } = *single;
        let [w, x, y, z] = pose.rotation;
        if (x != 0.0) | (y != 0.0) {
            return None;
        }
        let (half, axis) = if (z == 0.0) | (radius > 0.0) {
            (half, [1.0, 0.0])
        } else {
            let yaw = Yaw::of(w, z);
            beside_x(half, [yaw.cos, yaw.sin])
        };
        Some(Prism {
            centre: pose.position,
            half,
            radius,
            axis,
            span,
        })
    }

    /// Returns the prism after its parent is placed at `position` and, if `frame` is given, turned by this upright
    /// frame.
    #[inline(always)]
    pub(crate) fn carried(&self, frame: Option<&Frame>, position: Vec3) -> Prism {
        let mut placed = frame.map_or(*self, |frame| self.turned(frame));
        if !is_exact_sum(placed.centre, position) {
            placed.span += reach(position) + reach(placed.centre);
        }
        placed.centre = add(placed.centre, position);
        placed
    }

    /// Returns the prism after its parent is turned by an upright frame.
    #[inline(always)]
    pub(crate) fn turned(&self, frame: &Frame) -> Prism {
        let mut turned = *self;
        turned.span += reach(self.centre);
        turned.centre = frame.apply(self.centre);
        if self.radius == 0.0 {
            let [x, y] = self.axis;
            let [x, y, _] = frame.apply([x, y, 0.0]);
            (turned.half, turned.axis) = beside_x(self.half, [x, y]);
        }
        turned
    }

    /// Returns the prism after its parent is turned about z; its first axis may then be far from x.
    #[inline(always)]
    pub(crate) fn yawed(&self, yaw: Yaw) -> Prism {
        let [x, y, z] = self.centre;
        let [turned_x, turned_y] = yaw.apply([x, y]);
        Prism {
            centre: [turned_x, turned_y, z],
            axis: yaw.apply(self.axis),
            span: self.span + reach(self.centre),
            ..*self
        }
    }

    /// Returns this prism as a general piece; quarter turns may have exchanged the axes of its footprint.
    pub(crate) fn piece(&self) -> Piece {
        let [x, y] = self.axis;
        let frame = Frame {
            x: [x, y, 0.0],
            y: [-y, x, 0.0],
            z: [0.0, 0.0, 1.0],
        };
        let form = if self.radius > 0.0 {
            Form::Cylinder {
                radius: self.radius,
                half: self.half[2],
            }
        } else {
            Form::Block(self.half)
        };
        Piece {
            centre: self.centre,
            frame,
            form,
            span: self.span,
            upright: true,
        }
    }

    /// Returns true when the coordinates of the prism are exactly the numbers of the scene, without rounding.
    pub(crate) fn is_exact(&self) -> bool {
        let [a, b, c] = self.half;
        let own = if self.radius > 0.0 {
            2.0 * self.radius + 2.0 * c
        } else {
            a + b + c
        };
        self.span == own && self.is_straight()
    }

    /// Returns true when the footprint is aligned with x and y.
    #[inline]
    pub(crate) fn is_straight(&self) -> bool {
        self.axis == [1.0, 0.0]
    }

    /// Returns the components of a vector along the axes of the footprint.
    #[inline]
    pub(crate) fn along(&self, v: Vec3) -> [f64; 2] {
        if self.is_straight() {
            return [v[0], v[1]];
        }
        let [x, y] = self.axis;
        [v[0] * x + v[1] * y, v[1] * x - v[0] * y]
    }

    /// Returns the bounding box, rounded outward.
    #[inline]
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        let [u, v] = self.axis.map(f64::abs);
        let noise = NOISE * (self.span + reach(self.centre));
        let half = [
            self.half[0] * u + self.half[1] * v + self.radius + noise,
            self.half[0] * v + self.half[1] * u + self.radius + noise,
            self.half[2] + noise,
        ];
        let side = |sign: f64| [0, 1, 2].map(|axis: usize| self.centre[axis] + sign * half[axis]);
        (side(-1.0), side(1.0))
    }
}

/// Returns half extents, radius and first axis of a footprint.
#[inline]
fn footprint(form: Form, x: [f64; 2]) -> (Vec3, f64, [f64; 2]) {
    match form {
        Form::Block(half) => {
            let (half, axis) = beside_x(half, x);
            (half, 0.0, axis)
        }
        Form::Cylinder { radius, half } => ([0.0, 0.0, half], radius, [1.0, 0.0]),
        // Triangles are never upright.
        Form::Triangle(_) => ([0.0; 3], f64::INFINITY, [1.0, 0.0]),
    }
}

/// Exchanges the axes of a rectangle by quarter turns so that the first axis lies nearest to x.
#[inline]
fn beside_x([a, b, c]: Vec3, x: [f64; 2]) -> (Vec3, [f64; 2]) {
    let (half, x) = if x[0].abs() >= x[1].abs() {
        ([a, b, c], x)
    } else {
        ([b, a, c], [x[1], -x[0]])
    };
    (half, if x[0] < 0.0 { [-x[0], -x[1]] } else { x })
}
