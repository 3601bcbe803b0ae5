//! Moving bodies: each is split into pieces once and checked against the model many times.

use super::interior::Interior;
use super::piece::{Piece, pieces_of};
use super::pose::{Frame, Pose, RoughYaw};
use super::prism::Prism;
use super::shape::{Flaw, Shape};
use super::space::{Boxes, Cover, Four, SLOWEST_MM};
use super::vector::{Vec3, add, length, reach};

/// Maximum number of pieces in a group; a group can be placed at once without heap allocation.
pub(crate) const MOST_OF_A_GROUP: usize = 4;

/// A checked body in its own frame, split into pieces; it serves for any number of questions.
#[derive(Debug, Clone)]
pub struct Mover {
    pub(crate) pieces: Vec<Piece>,
    /// Prism of each piece, if the piece is upright in the frame of the body.
    pub(crate) prisms: Vec<Option<Prism>>,
    pub(crate) groups: Vec<Group>,
    interior: Option<Interior>,
}

/// Up to [`MOST_OF_A_GROUP`] pieces that are tested together, by their boxes in the frame of the body.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    /// Index of the first piece of the group.
    pub(crate) first: usize,
    pub(crate) count: usize,
    /// Centres and half extents, axis by axis, mm; unused places repeat the first piece.
    centres: [[f32; MOST_OF_A_GROUP]; 3],
    halves: [[f32; MOST_OF_A_GROUP]; 3],
    /// Centre and half extents of the box around the group, mm; the fourth members are 0.
    centre: [f32; 4],
    half: [f32; 4],
    /// Largest distance of a point of the group from the origin of the body, rounded outward, mm.
    ball: f64,
    /// Width by which the boxes of the group grow at any place, mm.
    wider: f64,
}

/// Place, orientation and path for which the boxes of a group are computed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Whereabouts<'a> {
    /// Origin of the body at rest or at the start of its path, mm.
    pub(crate) origin: Vec3,
    pub(crate) orientation: Orientation<'a>,
    /// Displacement of the body, mm.
    pub(crate) run: Vec3,
    /// Width by which the boxes grow for the margin, mm.
    pub(crate) margin_mm: f64,
}

/// Orientation of a body on its path.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Orientation<'a> {
    Unturned,
    Yawed(RoughYaw),
    Tilted(&'a Frame),
    /// The orientation changes along the path.
    Turning,
}

/// Rounding bound of the boxes of a placed group, relative to the sizes of group and path along the axis: fewer than
/// ten roundings to single precision, plus the error of a [`RoughYaw`].
const SINGLE: f64 = 1e-6;

impl Mover {
    /// Splits a shape into pieces.
    ///
    /// # Errors
    /// Fails with the [`Flaw`] of the shape.
    pub fn new(shape: &Shape) -> Result<Mover, Flaw> {
        shape.check()?;
        let pieces = pieces_of(shape);
        let chunks = pieces.chunks(MOST_OF_A_GROUP).enumerate();
        let groups = chunks.map(|(index, chunk)| Group::of(index * MOST_OF_A_GROUP, chunk));
        Ok(Mover {
            groups: groups.collect(),
            interior: Interior::of(shape),
            prisms: pieces
                .iter()
                .map(|piece| piece.upright.then(|| Prism::of(piece)))
                .collect(),
            pieces,
        })
    }

    /// Returns true when the body encloses a space in which another body can lie without touching its triangles.
    pub(crate) fn is_hollow(&self) -> bool {
        self.interior
            .as_ref()
            .is_some_and(|interior| !interior.solids.is_empty())
    }

    /// Returns the enclosed spaces of the body at `pose`.
    pub(crate) fn interior_at(&self, pose: &Pose) -> Interior {
        let (frame, position) = (&Frame::of(pose.rotation), pose.position);
        match &self.interior {
            Some(interior) => interior.placed(frame, position),
            None => {
                let centres = self.pieces.iter().map(|piece| piece.centre);
                Interior::around(
                    centres
                        .map(|centre| add(frame.apply(centre), position))
                        .collect(),
                )
            }
        }
    }
}

impl Group {
    fn of(first: usize, pieces: &[Piece]) -> Group {
        let mut group = Group {
            first,
            count: pieces.len(),
            centres: [[0.0; MOST_OF_A_GROUP]; 3],
            halves: [[0.0; MOST_OF_A_GROUP]; 3],
            centre: [0.0; 4],
            half: [0.0; 4],
            ball: 0.0,
            wider: 0.0,
        };
        let mut span = 0.0_f64;
        let (mut least, mut most) = pieces[0].bounds();
        for place in 0..MOST_OF_A_GROUP {
            let piece = pieces.get(place).unwrap_or(&pieces[0]);
            let (low, high) = piece.bounds();
            for axis in 0..3 {
                group.centres[axis][place] = (0.5 * (low[axis] + high[axis])) as f32;
                group.halves[axis][place] = (0.5 * (high[axis] - low[axis])) as f32;
                least[axis] = least[axis].min(low[axis]);
                most[axis] = most[axis].max(high[axis]);
            }
            group.ball = group.ball.max(reach_of(piece));
            span = span.max(2.0 * (piece.span + reach(piece.centre) + piece.radius()));
        }
        group.wider = SINGLE * span + SLOWEST_MM;
        for axis in 0..3 {
            group.centre[axis] = (0.5 * (least[axis] + most[axis])) as f32;
            group.half[axis] = (0.5 * (most[axis] - least[axis])) as f32;
        }
        group
    }

    /// Returns a mask of the places of the group that hold a piece (bit k: place k).
    #[inline]
    pub(crate) fn used(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// Returns the width by which a box grows along each axis, mm: for the margin and for all rounding to single
    /// precision. The rounding along an axis grows with the coordinates along this axis and with the size of the group.
    #[inline(always)]
    fn wider(&self, at: &Whereabouts) -> Four {
        let always = (self.wider + at.margin_mm * (1.0 + SINGLE)) as f32;
        let way = Four::rounded(&at.origin)
            .abs()
            .plus(Four::rounded(&at.run).abs());
        Four::all(always).plus(Four::all(SINGLE as f32).times(way))
    }

    /// Returns the boxes of the pieces at the start of the path, rounded outward and widened by the margin.
    ///
    /// For a turning group, returns the box of the ball in which the group stays during any turn.
    #[inline(always)]
    pub(crate) fn boxes(&self, at: &Whereabouts) -> Boxes<MOST_OF_A_GROUP> {
        let centres = self.centres.each_ref().map(Four::of);
        let halves = self.halves.each_ref().map(Four::of);
        let (centres, halves) = match at.orientation {
            Orientation::Unturned => (centres, halves),
            Orientation::Yawed(yaw) => yawed(yaw, centres, halves),
            Orientation::Tilted(frame) => tilted(frame, centres, halves),
            Orientation::Turning => ([Four::all(0.0); 3], [Four::all(self.ball as f32); 3]),
        };
        let (origin, wider) = (
            Four::rounded(&at.origin).numbers(),
            self.wider(at).numbers(),
        );
        let mut boxes = Boxes::NOWHERE;
        for axis in 0..3 {
            let centre = centres[axis].plus(Four::all(origin[axis]));
            let half = halves[axis].plus(Four::all(wider[axis]));
            boxes.low[axis] = centre.minus(half).numbers();
            boxes.high[axis] = centre.plus(half).numbers();
        }
        boxes
    }

    /// Returns the box around all pieces of the group, rounded outward and widened by the margin.
    #[inline(always)]
    pub(crate) fn hull(&self, at: &Whereabouts) -> Cover {
        let (centre, half) = match at.orientation {
            Orientation::Unturned => (Four::of(&self.centre), Four::of(&self.half)),
            Orientation::Yawed(yaw) => self.yawed_hull(yaw),
            Orientation::Tilted(frame) => self.tilted_hull(frame),
            Orientation::Turning => (Four::all(0.0), Four::all(self.ball as f32)),
        };
        let centre = centre.plus(Four::rounded(&at.origin));
        let half = half.plus(self.wider(at));
        Cover {
            low: centre.minus(half).numbers(),
            high: centre.plus(half).numbers(),
        }
    }

    #[inline(always)]
    fn yawed_hull(&self, yaw: RoughYaw) -> (Four, Four) {
        let RoughYaw { cos, sin } = yaw;
        let ([x, y, z, _], [a, b, c, _]) = (self.centre, self.half);
        let centre = [x * cos - y * sin, x * sin + y * cos, z, 0.0];
        let (cos, sin) = (cos.abs(), sin.abs());
        let half = [a * cos + b * sin, a * sin + b * cos, c, 0.0];
        (Four::of(&centre), Four::of(&half))
    }

    fn tilted_hull(&self, frame: &Frame) -> (Four, Four) {
        let images = [&frame.x, &frame.y, &frame.z].map(Four::rounded);
        let of = |own: usize| {
            let centre = images[own].times(Four::all(self.centre[own]));
            (centre, images[own].abs().times(Four::all(self.half[own])))
        };
        let (x, y, z) = (of(0), of(1), of(2));
        (x.0.plus(y.0).plus(z.0), x.1.plus(y.1).plus(z.1))
    }
}

/// Rotates boxes about z. Returns centres relative to the origin, and half extents along the axes of the parent frame,
/// axis by axis.
#[inline(always)]
fn yawed(yaw: RoughYaw, [x, y, z]: [Four; 3], [a, b, c]: [Four; 3]) -> ([Four; 3], [Four; 3]) {
    let (cos, sin) = (Four::all(yaw.cos), Four::all(yaw.sin));
    let across = x.times(cos).minus(y.times(sin));
    let centres = [across, x.times(sin).plus(y.times(cos)), z];
    let (cos, sin) = (cos.abs(), sin.abs());
    let wide = a.times(cos).plus(b.times(sin));
    (centres, [wide, a.times(sin).plus(b.times(cos)), c])
}

/// Rotates boxes by any frame. Returns centres relative to the origin, and half extents, axis by axis.
fn tilted(frame: &Frame, centres: [Four; 3], halves: [Four; 3]) -> ([Four; 3], [Four; 3]) {
    let images = [frame.x, frame.y, frame.z];
    let sum = |members: [Four; 3], of: fn(f32) -> f32| {
        [0, 1, 2].map(|axis: usize| {
            let part = |own: usize| members[own].times(Four::all(of(images[own][axis] as f32)));
            part(0).plus(part(1)).plus(part(2))
        })
    };
    (sum(centres, |it| it), sum(halves, f32::abs))
}

/// Returns the largest distance of a point of the piece from the origin of its body, mm, rounded outward.
pub(crate) fn reach_of(piece: &Piece) -> f64 {
    (length(piece.centre) + piece.radius()) * (1.0 + 8.0 * f64::EPSILON)
}

/// A body that questions accept: a [`Mover`], or a [`Shape`], which is split into pieces for each question.
pub trait Moving {
    /// Calls `ask` with the body split into pieces; returns `None` when the shape is flawed, which a question must
    /// answer as blocked.
    fn with_mover<A>(&self, ask: impl FnOnce(&Mover) -> A) -> Option<A>;
}

impl Moving for Mover {
    #[inline(always)]
    fn with_mover<A>(&self, ask: impl FnOnce(&Mover) -> A) -> Option<A> {
        Some(ask(self))
    }
}

impl Moving for Shape {
    fn with_mover<A>(&self, ask: impl FnOnce(&Mover) -> A) -> Option<A> {
        Mover::new(self).ok().map(|mover| ask(&mover))
    }
}
