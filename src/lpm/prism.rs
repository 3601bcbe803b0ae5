//! Upright pieces on a straight way, in closed form: the swept extrusion made exact.
//!
//! Seen from the element, the mover is a point that runs along a line, and the element is grown by
//! the mover: an interval in z times a figure in the plane. Two rectangles with common axes grow to
//! a rectangle, a rectangle and a disc to a rectangle with round corners, two discs to a disc, two
//! rectangles askew to an octagon. Each is an intersection of slabs, with discs for the round
//! corners, and a line crosses all of those in closed form.
//!
//! # Never a false clear
//! Every slab and disc is grown by [`Meeting::slack`]: [`NOISE`] for how the pieces came to their
//! places, [`ROUNDING`] for what is computed here. A line that meets the true figure meets the
//! grown one, earlier by at least that slack divided by its speed; so the fraction that is
//! returned is never late, and `None` is proof. In reverse, whoever is reported has come within
//! three slacks: below 1e-7 mm for coordinates of 1e6 mm.

use super::piece::{Form, NOISE, Piece};
use super::pose::{Frame, Pose};
use super::shape::Shape;
use super::vector::{Vec3, reach};

/// Relative error allowed for what is computed here from the difference of two places and the run:
/// fewer than 16 roundings of 2^-53 each lie between them and a fraction of the way, twice that is paid.
const ROUNDING: f64 = 32.0 * (f64::EPSILON / 2.0);

/// An upright block or cylinder, as far as its own straight ways are concerned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prism {
    centre: Vec3,
    /// Half extents of the footprint along `axis` and across (0 of a disc), and of the height, mm.
    half: Vec3,
    /// Radius of a disc, 0 of a rectangle, mm.
    radius: f64,
    /// First axis of the footprint, within 45 degrees of x.
    axis: [f64; 2],
    /// The scale of rounding errors, mm; see [`Piece::span`].
    span: f64,
}

impl Prism {
    /// Of a piece that is upright.
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

    /// Of a block or a cylinder alone, when it stands upright at `pose`.
    #[inline]
    pub(crate) fn standing(shape: &Shape, pose: &Pose) -> Option<Prism> {
        let (form, span) = match shape {
            Shape::Block { half } => (Form::Block(*half), reach(*half)),
            Shape::Cylinder { radius, height } => (
                Form::Cylinder {
                    radius: *radius,
                    half: height / 2.0,
                },
                2.0 * radius + height,
            ),
            Shape::Compound(_) | Shape::Mesh(_) => return None,
        };
        let [_, x, y, _] = pose.rotation;
        if x != 0.0 || y != 0.0 {
            return None;
        }
        let axis = Frame::of(pose.rotation).x;
        let (half, radius, axis) = footprint(form, [axis[0], axis[1]]);
        Some(Prism {
            centre: pose.position,
            half,
            radius,
            axis,
            span,
        })
    }

    /// Of an upright piece whose parent, turned by the upright `frame`, stands at `position`.
    #[inline]
    pub(crate) fn placed(piece: &Piece, frame: &Frame, position: Vec3) -> Prism {
        let x = frame.apply(piece.frame.x);
        let (half, radius, axis) = footprint(piece.form, [x[0], x[1]]);
        let (centre, span) = piece.place(frame, position);
        Prism {
            centre,
            half,
            radius,
            axis,
            span,
        }
    }

    /// The whole piece again, its footprint perhaps turned by quarters.
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

    /// Bounding box, rounded outward.
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

/// Half extents, radius and first axis; the axis turned by quarters until it lies next to x.
#[inline]
fn footprint(form: Form, x: [f64; 2]) -> (Vec3, f64, [f64; 2]) {
    match form {
        Form::Block([a, b, c]) => {
            let (half, x) = if x[0].abs() >= x[1].abs() {
                ([a, b, c], x)
            } else {
                ([b, a, c], [x[1], -x[0]])
            };
            let axis = if x[0] < 0.0 { [-x[0], -x[1]] } else { x };
            (half, 0.0, axis)
        }
        Form::Cylinder { radius, half } => ([0.0, 0.0, half], radius, [1.0, 0.0]),
        // Triangles are never upright.
        Form::Triangle(_) => ([0.0; 3], f64::INFINITY, [1.0, 0.0]),
    }
}

/// An element and a mover that runs past it, both upright.
pub(crate) struct Meeting<'a> {
    element: &'a Prism,
    mover: &'a Prism,
    /// From the element to the mover at the start.
    apart: Vec3,
    run: Vec3,
    /// Growth of every figure, mm: margin and slack.
    grown: f64,
    slack: f64,
}

/// A part of the move.
type Window = (f64, f64);

impl<'a> Meeting<'a> {
    #[inline]
    pub(crate) fn new(element: &'a Prism, mover: &'a Prism, run: Vec3, margin: f64) -> Meeting<'a> {
        let apart = [0, 1, 2].map(|axis: usize| mover.centre[axis] - element.centre[axis]);
        let slack = NOISE * (element.span + mover.span) + ROUNDING * (reach(apart) + reach(run));
        Meeting {
            element,
            mover,
            apart,
            run,
            grown: margin + slack,
            slack,
        }
    }

    /// First fraction, up to `until`, at which both heights and both footprints are within the
    /// margin. `None` is proof that there is none; NaN comes out as a meeting.
    #[inline]
    pub(crate) fn first(&self, until: f64) -> Option<f64> {
        let heights = self.element.half[2] + self.mover.half[2];
        let window = slab(
            (0.0, until),
            self.apart[2],
            self.run[2],
            heights + self.grown,
        )?;
        match (self.element.radius > 0.0, self.mover.radius > 0.0) {
            (false, false) if self.element.axis != self.mover.axis => self.octagon(window),
            (true, false) => self.rounded(window, self.mover),
            (false, _) | (true, true) => self.rounded(window, self.element),
        }
    }

    /// `framed` gives the axes; at most one of both is a rectangle askew to them.
    #[inline]
    fn rounded(&self, window: Window, framed: &Prism) -> Option<f64> {
        let radius = self.element.radius + self.mover.radius;
        let half = [0, 1].map(|axis: usize| self.element.half[axis] + self.mover.half[axis]);
        let (p, v) = (along(framed, self.apart), along(framed, self.run));
        let reach = radius + self.grown;
        let window = slab(window, p[0], v[0], half[0] + reach)?;
        let window = slab(window, p[1], v[1], half[1] + reach)?;
        if radius == 0.0 && self.grown == self.slack {
            return Some(window.0);
        }
        corner(window, p, v, half, reach + self.slack)
    }

    fn octagon(&self, window: Window) -> Option<f64> {
        let window = self.askew(window, self.element, self.mover)?;
        self.askew(window, self.mover, self.element)
            .map(|window| window.0)
    }

    /// The slabs of one rectangle, grown by the other one.
    fn askew(&self, window: Window, framed: &Prism, other: &Prism) -> Option<Window> {
        let [cos, sin] = along(framed, [other.axis[0], other.axis[1], 0.0]).map(f64::abs);
        let (p, v) = (along(framed, self.apart), along(framed, self.run));
        let [a, b, _] = other.half;
        let window = slab(
            window,
            p[0],
            v[0],
            framed.half[0] + a * cos + b * sin + self.grown,
        )?;
        slab(
            window,
            p[1],
            v[1],
            framed.half[1] + a * sin + b * cos + self.grown,
        )
    }
}

/// In the axes of a footprint.
#[inline]
fn along(framed: &Prism, v: Vec3) -> [f64; 2] {
    let [x, y] = framed.axis;
    if y == 0.0 && x == 1.0 {
        return [v[0], v[1]];
    }
    [v[0] * x + v[1] * y, v[1] * x - v[0] * y]
}

/// The part of `window` in which `|start + t rate| <= half`.
#[inline]
fn slab((low, high): Window, start: f64, rate: f64, half: f64) -> Option<Window> {
    let half = if rate.abs() < 1e-290 {
        // Too slow for a quotient: what it covers at all is added to the slab.
        if start.abs() > half + rate.abs() {
            return None;
        }
        return Some((low, high));
    } else {
        half
    };
    let near = half.copysign(rate);
    let (first, last) = ((-near - start) / rate, (near - start) / rate);
    let low = if first > low { first } else { low };
    let high = if last < high { last } else { high };
    if low > high { None } else { Some((low, high)) }
}

/// First fraction of `window` at which `p + t v`, which is then within the bounding rectangle, is
/// inside the rectangle of `half` with corners of `radius`.
#[inline]
fn corner(
    (low, high): Window,
    p: [f64; 2],
    v: [f64; 2],
    half: [f64; 2],
    radius: f64,
) -> Option<f64> {
    let at = [p[0] + low * v[0], p[1] + low * v[1]];
    let over = [0, 1].map(|axis: usize| (at[axis].abs() - half[axis]).max(0.0));
    if !(over[0] * over[0] + over[1] * over[1] > radius * radius) {
        return Some(low);
    }
    // Outside, so before the disc of a corner: the way in leads through it.
    let w = [0, 1].map(|axis: usize| at[axis] - half[axis].copysign(at[axis]));
    let speed = v[0] * v[0] + v[1] * v[1];
    let nearing = -(w[0] * v[0] + w[1] * v[1]);
    let across = w[0] * v[1] - w[1] * v[0];
    let left = radius * radius * speed - across * across;
    if nearing <= 0.0 || left < 0.0 {
        return None;
    }
    let t = low + (nearing - left.sqrt()) / speed;
    if t > high { None } else { Some(t.max(low)) }
}
