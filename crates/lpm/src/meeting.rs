//! First contact of upright pieces on a straight path, in closed form and for the whole path at once.
//!
//! In the frame of the element the mover becomes a point that runs along a line, and the element grows by the shape of
//! the mover (Minkowski sum) to an interval in z times a figure in the plane. The figure of two rectangles with common
//! axes is a rectangle, that of a rectangle and a disc is a rectangle with round corners, that of two discs is a disc,
//! and that of two rectangles turned against each other is an octagon. Each figure is an intersection of slabs, with
//! discs for round corners, and where a line crosses a slab or a disc has a closed form.
//!
//! # Never a false clear
//! Every slab and disc is grown by [`Meeting::slack`]: by [`NOISE`] for the rounding of the pieces' places, and by
//! [`ROUNDING`] for the rounding of this computation. A line that meets the true figure meets the grown one, earlier by
//! at least this slack divided by its speed; so the returned fraction is never late, and `None` is proof. Where a
//! corner is grazed and the places have no rounding, [`grazing`] may move the fraction later, to the true one rounded
//! down. Conversely, a reported pair comes within three slacks of contact: below 1e-7 mm for coordinates of 1e6 mm.

use super::grazing::{self, Twofold};
use super::path::Path;
use super::piece::NOISE;
use super::prism::Prism;
use super::vector::{Vec3, reach, sub};

/// Relative error bound of this computation, from the difference of two places and the run to a fraction of the path:
/// fewer than 16 roundings of 2^-53 each; the bound allows twice that.
const ROUNDING: f64 = 32.0 * (f64::EPSILON / 2.0);

/// Greatest distance by which a grazing contact may come early without refinement, mm: a tenth of the promised 1e-6 mm.
const GRAZED_MM: f64 = 1e-7;

/// Distance from the end of a round corner within which a contact is not refined, mm, because beyond that end a side
/// may come first; larger than all rounding.
const ROUND_MM: f64 = 1e-3;

/// A straight path, with the reciprocals of its displacement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) way: Vec3,
    /// Fraction of the path per millimetre along each axis; 0 for an axis without motion.
    pace: Vec3,
    path: &'a Path,
}

impl<'a> Run<'a> {
    /// Computes the reciprocals for a straight path.
    #[inline]
    pub(crate) fn of(path: &'a Path) -> Run<'a> {
        let way = path.displacement;
        Run {
            way,
            pace: [pace(way[0]), pace(way[1]), pace(way[2])],
            path,
        }
    }
}

/// Returns the reciprocal of a rate; 0 for a rate whose reciprocal is not usable.
#[inline]
fn pace(rate: f64) -> f64 {
    if rate.abs() < 1e-290 { 0.0 } else { 1.0 / rate }
}

/// An element and a mover on a straight path past it, both upright.
pub(crate) struct Meeting<'a> {
    element: &'a Prism,
    mover: &'a Prism,
    /// Vector from the element to the mover at the start.
    apart: Vec3,
    run: &'a Run<'a>,
    /// Width by which every figure is grown, mm: margin plus slack.
    grown: f64,
    slack: f64,
}

/// An interval of fractions of the path.
type Window = (f64, f64);

impl<'a> Meeting<'a> {
    #[inline]
    pub(crate) fn new(
        element: &'a Prism,
        mover: &'a Prism,
        run: &'a Run<'a>,
        margin: f64,
    ) -> Meeting<'a> {
        let apart = sub(mover.centre, element.centre);
        let slack = slack(element, mover, apart) + ROUNDING * reach(run.way);
        Meeting {
            element,
            mover,
            apart,
            run,
            grown: margin + slack,
            slack,
        }
    }

    /// Returns the first fraction, up to `until`, at which heights and footprints are both within the margin. `None` is
    /// proof that there is none; NaN counts as contact.
    #[inline]
    pub(crate) fn first(&self, until: f64) -> Option<f64> {
        let window = self.heights(until)?;
        match self.framed() {
            Some(framed) => self.rounded(window, framed),
            None => self.octagon(window),
        }
    }

    /// Returns true when [`Self::first`] finds a fraction on the whole path.
    #[inline]
    pub(crate) fn is_any(&self) -> bool {
        let found = |window| match self.framed() {
            Some(framed) => self.grown_figures(window, framed),
            None => self.octagon(window),
        };
        self.heights(1.0).and_then(found).is_some()
    }

    /// Returns the part of the path, up to `until`, on which the heights are within the margin.
    #[inline]
    fn heights(&self, until: f64) -> Option<Window> {
        let heights = self.element.half[2] + self.mover.half[2];
        slab(
            (0.0, until),
            self.apart[2],
            (self.run.way[2], self.run.pace[2]),
            heights + self.grown,
        )
    }

    /// Returns the footprint whose axes the sum of both footprints has; `None` for two rectangles turned against each
    /// other.
    #[inline]
    fn framed(&self) -> Option<&'a Prism> {
        match (self.element.radius > 0.0, self.mover.radius > 0.0) {
            (false, false) if self.element.axis != self.mover.axis => None,
            (true, false) => Some(self.mover),
            (false, _) | (true, true) => Some(self.element),
        }
    }

    /// Returns the first fraction in `window` at which footprints with common axes, those of `framed`, are within the
    /// margin.
    #[inline]
    fn rounded(&self, window: Window, framed: &Prism) -> Option<f64> {
        let t = self.grown_figures(window, framed)?;
        let radius = self.element.radius + self.mover.radius;
        if radius == 0.0 && self.grown == self.slack {
            return Some(t);
        }
        Some(self.grazed(framed, t).unwrap_or(t))
    }

    /// Returns the fraction that [`Self::rounded`] returns, but without refining a grazing contact.
    #[inline]
    fn grown_figures(&self, window: Window, framed: &Prism) -> Option<f64> {
        let radius = self.element.radius + self.mover.radius;
        let half = self.halves();
        let p = framed.along(self.apart);
        let rates = self.rates(framed);
        let reach = radius + self.grown;
        let window = slab(window, p[0], rates[0], half[0] + reach)?;
        let window = slab(window, p[1], rates[1], half[1] + reach)?;
        if radius == 0.0 && self.grown == self.slack {
            return Some(window.0);
        }
        let v = [rates[0].0, rates[1].0];
        corner(window, p, v, half, reach + self.slack)
    }

    /// Returns the fraction in double-double precision, never before `t`, at which the grown figures meet. `None`
    /// unless a round corner is grazed and the places have no rounding.
    fn grazed(&self, framed: &Prism, t: f64) -> Option<f64> {
        let at = [0, 1].map(|axis: usize| self.apart[axis] + t * self.run.way[axis]);
        let half = self.halves();
        let w = [0, 1].map(|axis: usize| at[axis] - half[axis].copysign(at[axis]));
        let [u, v, _] = self.run.way;
        let (radius, speed) = (
            self.element.radius + self.mover.radius,
            (u * u + v * v).sqrt(),
        );
        let closing = (w[0] * u + w[1] * v).abs();
        // The slack, divided by the sine of the grazing angle, shifts the contact along the path; at rest there is no
        // grazing.
        let is_graze = closing * GRAZED_MM < self.slack * radius * speed;
        if !is_graze {
            return None;
        }
        // On a path along an axis no side comes before the end of its round corner.
        let on_corner = |axis: usize| {
            let beyond = at[axis].abs() - half[axis];
            half[axis] == 0.0 || self.run.way[1 - axis] == 0.0 || beyond > ROUND_MM
        };
        let unrounded =
            self.run.path.is_exact() && self.element.is_exact() && self.mover.is_exact();
        let alone = self.grown == self.slack && framed.is_straight();
        if !(unrounded && alone && on_corner(0) && on_corner(1)) {
            return None;
        }
        let from = [0, 1].map(|axis: usize| {
            let apart = Twofold::sum(self.mover.centre[axis], -self.element.centre[axis]);
            let half = Twofold::sum(self.element.half[axis], self.mover.half[axis]);
            if at[axis] > 0.0 {
                apart.minus(half)
            } else {
                apart.plus(half)
            }
        });
        let radius = Twofold::sum(self.element.radius, self.mover.radius);
        Some(grazing::first(from, [u, v], radius)?.max(t))
    }

    /// Returns the sums of the half extents of two footprints with common axes.
    #[inline]
    fn halves(&self) -> [f64; 2] {
        let half = |axis: usize| self.element.half[axis] + self.mover.half[axis];
        [half(0), half(1)]
    }

    /// Returns the displacement along the axes of a footprint, with its reciprocals.
    #[inline]
    fn rates(&self, framed: &Prism) -> [(f64, f64); 2] {
        let (way, pace_of) = (&self.run.way, &self.run.pace);
        if framed.is_straight() {
            return [(way[0], pace_of[0]), (way[1], pace_of[1])];
        }
        let [x, y] = framed.along(*way);
        [(x, pace(x)), (y, pace(y))]
    }

    fn octagon(&self, window: Window) -> Option<f64> {
        let window = self.askew(window, self.element, self.mover)?;
        self.askew(window, self.mover, self.element)
            .map(|window| window.0)
    }

    /// Intersects the window with the slabs of one rectangle, which is grown by the other.
    fn askew(&self, window: Window, framed: &Prism, other: &Prism) -> Option<Window> {
        let [cos, sin] = framed
            .along([other.axis[0], other.axis[1], 0.0])
            .map(f64::abs);
        let p = framed.along(self.apart);
        let rates = self.rates(framed);
        let [a, b, _] = other.half;
        let window = slab(
            window,
            p[0],
            rates[0],
            framed.half[0] + a * cos + b * sin + self.grown,
        )?;
        slab(
            window,
            p[1],
            rates[1],
            framed.half[1] + a * sin + b * cos + self.grown,
        )
    }
}

/// Returns an upper bound of the rounding error, mm, for an element and a piece of a mover whose centres lie `apart`:
/// the error of both positions, plus that of the distances computed from `apart`.
#[inline]
pub(crate) fn slack(element: &Prism, mover: &Prism, apart: Vec3) -> f64 {
    NOISE * (element.span + mover.span) + ROUNDING * reach(apart)
}

/// Returns the part of `window` in which `|start + t rate| <= half`; `pace` is the reciprocal of `rate`.
#[inline]
fn slab((low, high): Window, start: f64, (rate, pace): (f64, f64), half: f64) -> Option<Window> {
    if pace == 0.0 {
        // Without a usable reciprocal, the slab is widened by the whole displacement across it.
        if start.abs() > half + rate.abs() {
            return None;
        }
        return Some((low, high));
    }
    let near = half.copysign(rate);
    let (first, last) = ((-near - start) * pace, (near - start) * pace);
    let low = if first > low { first } else { low };
    let high = if last < high { last } else { high };
    if low > high { None } else { Some((low, high)) }
}

/// Returns the first fraction in `window` at which the point `p + t v` is inside the rectangle of `half` with corners
/// of `radius`; during all of `window` the point is within the rectangle that bounds this figure.
#[inline]
fn corner(
    (low, high): Window,
    p: [f64; 2],
    v: [f64; 2],
    half: [f64; 2],
    radius: f64,
) -> Option<f64> {
    let at = [p[0] + low * v[0], p[1] + low * v[1]];
    let over = |axis: usize| (at[axis].abs() - half[axis]).max(0.0);
    if !(over(0) * over(0) + over(1) * over(1) > radius * radius) {
        return Some(low);
    }
    // The point is outside and near a corner, so it can enter only through the disc of this corner.
    let w = |axis: usize| at[axis] - half[axis].copysign(at[axis]);
    let w = [w(0), w(1)];
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
