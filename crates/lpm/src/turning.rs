//! Turning moves: advances by steps that a second-order bound proves clear (conservative advancement).
//!
//! Let a mover turn by `theta` about the unit axis `u` during the whole move. For a point `y` of the mover, relative to
//! its origin, a further fraction `h` of the move gives `n·y(t+h) >= n·y + h theta (n x u)·y - h^2 theta^2 rho / 2`,
//! where `rho` is the distance of `y` from the axis. The least value of the first two terms over the whole piece is
//! again a value of the support function, in the direction `n + h theta (n x u)`. So one plane clears a whole stretch
//! of the move, and on a grazing pass a step is as long as the square root of the gap, not as the gap itself.
//!
//! A distance within [`band_mm`] of the margin counts as contact; this band is between 1e-7 and 5e-4 mm wide. Running
//! out of steps counts as contact too.

use super::distance::{Gap, gap, noise};
use super::path::Path;
use super::piece::{NOISE, Piece};
use super::pose::Turn;
use super::straight::Hit;
use super::vector::{Vec3, along, cross, dot, length, negate, scale, sub};

/// Maximum number of planes per pair. Because of [`band_mm`], 20,000 are enough for any turn.
const MOST_PLANES: usize = 40_000;
/// Rounds of chord and bisection per stretch; after each round the lower end is still proven.
const STRETCH_ROUNDS: usize = 8;
/// Resolution to which the least distance of a turning move is found, mm.
const LEAST_RESOLUTION_MM: f64 = 2e-4;

/// Spacing of the first samples in the search for a least distance, as a fraction of the move.
const SAMPLE: f64 = 1.0 / 32.0;
/// Rounds of ternary search in a valley two samples wide; each round removes a third, which leaves 1e-8 of the move.
const VALLEY_ROUNDS: usize = 40;

/// Returns the distance beyond the margin that counts as contact, mm; with this band, no step of a grazing pass is
/// shorter than a ten-thousandth of the move.
fn band_mm(turn: &Turn, rho: f64) -> f64 {
    (0.5e-8 * turn.angle * turn.angle * rho).clamp(1e-7, 5e-4)
}

/// A piece of an element and a piece of a turning mover.
pub(crate) struct Turning<'a> {
    pub(crate) element: &'a Piece,
    /// Piece of the mover, in the frame of the mover.
    pub(crate) local: &'a Piece,
    pub(crate) path: &'a Path,
    pub(crate) turn: &'a Turn,
}

impl Turning<'_> {
    /// Returns the largest distance of a point of the piece from the axis through the origin, mm.
    fn rho(&self) -> f64 {
        let placed = self.path.piece_at(self.local, 0.0);
        let arm = sub(placed.centre, self.path.origin(0.0));
        (length(cross(self.turn.axis, arm)) + self.local.radius()) * (1.0 + 16.0 * f64::EPSILON)
    }

    /// Returns the first fraction `t` up to `until` at which the distance is within `margin` (mm) plus the band; `None`
    /// is proof that there is none.
    pub(crate) fn first_within(&self, margin: f64, until: f64) -> Option<Hit> {
        let rho = self.rho();
        let band = band_mm(self.turn, rho);
        let mut t = 0.0;
        let mut hint = None;
        for _ in 0..MOST_PLANES {
            let (mover, gap) = self.gap_at(t, hint);
            if !(gap.lower > margin + band) {
                return Some(Hit { t, gap });
            }
            let stretch = self.stretch(&mover, &gap, rho, t, margin);
            if t + stretch > until {
                return None;
            }
            if !(t + stretch > t) {
                return Some(Hit { t, gap });
            }
            t += stretch;
            hint = Some(gap.normal);
        }
        let (_, gap) = self.gap_at(t, hint);
        Some(Hit { t, gap })
    }

    /// Returns the least distance over the move as `(t, distance)`; `None` when it exceeds `cutoff`. The error is at
    /// most [`LEAST_RESOLUTION_MM`] or the band, whichever is larger.
    ///
    /// The search starts from a good guess and proves, in one sweep over the move, that no distance is lower than the
    /// guess by more than the resolution. A distance lower than the guess by more than half the resolution becomes the
    /// new guess, so that every plane has the other half left for its step.
    pub(crate) fn least(&self, cutoff: f64) -> Option<(f64, f64)> {
        let rho = self.rho();
        let resolution = LEAST_RESOLUTION_MM.max(band_mm(self.turn, rho));
        let mut best = self.guess();
        let mut t = 0.0;
        let mut hint = None;
        for _ in 0..MOST_PLANES {
            let (mover, gap) = self.gap_at(t, hint);
            if !(gap.lower > 0.0) {
                return Some((t, 0.0));
            }
            if gap.lower < best.1.min(cutoff + resolution) - resolution / 2.0 {
                best = self.descended(t - SAMPLE, t + SAMPLE, (t, gap.lower));
            }
            if best.1 <= 0.0 {
                return Some(best);
            }
            let threshold = (best.1.min(cutoff + resolution) - resolution).max(0.0);
            let stretch = self.stretch(&mover, &gap, rho, t, threshold);
            if t + stretch > 1.0 {
                return (best.1 <= cutoff).then_some(best);
            }
            if !(t + stretch > t) {
                break;
            }
            t += stretch;
            hint = Some(gap.normal);
        }
        // The planes are used up: the true least distance may be anywhere below the values seen.
        Some((t, 0.0))
    }

    fn lower_at(&self, t: f64) -> (f64, f64) {
        (t, self.gap_at(t, None).1.lower.max(0.0))
    }

    /// Returns a guess of `t` and the least distance: the lowest of evenly spaced samples, improved by a descent into
    /// its valley.
    fn guess(&self) -> (f64, f64) {
        let steps = (1.0 / SAMPLE) as usize;
        let samples = (0..=steps).map(|step| self.lower_at(step as f64 * SAMPLE));
        let best = samples.fold((0.0, f64::INFINITY), |best, next| {
            if next.1 < best.1 { next } else { best }
        });
        self.descended(best.0 - SAMPLE, best.0 + SAMPLE, best)
    }

    /// Descends into a valley by ternary search, without derivatives, because the valley may have a sharp bottom.
    fn descended(&self, from: f64, to: f64, start: (f64, f64)) -> (f64, f64) {
        let (mut from, mut to, mut best) = (from.max(0.0), to.min(1.0), start);
        for _ in 0..VALLEY_ROUNDS {
            let third = (to - from) / 3.0;
            let (left, right) = (self.lower_at(from + third), self.lower_at(to - third));
            for found in [left, right] {
                if found.1 < best.1 {
                    best = found;
                }
            }
            if left.1 < right.1 {
                to -= third
            } else {
                from += third
            }
        }
        best
    }

    fn gap_at(&self, t: f64, hint: Option<Vec3>) -> (Piece, Gap) {
        let mover = self.path.piece_at(self.local, t);
        let gap = gap(self.element, &mover, [0.0; 3], hint);
        (mover, gap)
    }

    /// Returns the fraction by which the move can continue while the plane of `gap` proves more than `margin`.
    fn stretch(&self, mover: &Piece, gap: &Gap, rho: f64, t: f64, margin: f64) -> f64 {
        let plane = Plane::new(self, mover, gap, rho, t);
        let mut low = (0.0, plane.proves(0.0) - margin);
        let mut high = (2.0 - t, plane.proves(2.0 - t) - margin);
        if high.1 > 0.0 {
            return high.0;
        }
        for _ in 0..STRETCH_ROUNDS {
            // The bound is concave in h, so it lies above every chord.
            let chord = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
            for h in [chord, (low.0 + high.0) / 2.0] {
                let left = plane.proves(h) - margin;
                if left > 0.0 && h > low.0 {
                    low = (h, left);
                } else if left <= 0.0 && h < high.0 {
                    high = (h, left);
                }
            }
        }
        low.0
    }
}

/// One plane, and how the pair moves relative to it.
struct Plane<'a> {
    mover: &'a Piece,
    normal: Vec3,
    /// Separation of the plane from the origin of the mover at `h = 0`, minus the rounding bound, mm.
    base: f64,
    /// Vector from the origin of the mover to the centre of its piece, mm.
    arm: Vec3,
    /// Change of `base` per unit of `h`, mm.
    rate: f64,
    /// Change of the direction of support per unit of `h`.
    swing: Vec3,
    /// Bound of the second-order term, mm per unit of `h^2`.
    bend: f64,
}

impl<'a> Plane<'a> {
    fn new(turning: &Turning, mover: &'a Piece, gap: &Gap, rho: f64, t: f64) -> Plane<'a> {
        let (n, turn, path) = (gap.normal, turning.turn, turning.path);
        let origin = path.origin(t);
        let slack = noise(turning.element, mover, path.displacement)
            + NOISE * (path.span() + turn.angle * rho);
        Plane {
            mover,
            normal: n,
            base: dot(n, sub(origin, turning.element.centre)) - turning.element.extent(n) - slack,
            arm: sub(mover.centre, origin),
            rate: dot(n, path.displacement),
            swing: scale(cross(n, turn.axis), turn.angle),
            bend: turn.angle * turn.angle * rho / 2.0,
        }
    }

    /// Returns the proven separation after a further fraction `h` of the move, mm.
    fn proves(&self, h: f64) -> f64 {
        let support = along(self.normal, h, self.swing);
        let nearest = dot(support, self.arm) - self.mover.extent(negate(support));
        self.base + h * self.rate + nearest - h * h * self.bend
    }
}
