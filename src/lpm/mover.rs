//! Bodies that move: taken apart once, asked about often.

use super::path::Path;
use super::piece::{Piece, pieces_of};
use super::pose::Frame;
use super::prism::Prism;
use super::shape::{Flaw, Shape};
use super::solid::Interior;
use super::space::{Boxes, Cover, SLOWEST_MM};
use super::vector::{add, length, reach};

/// Pieces of a group: as many as are placed at once without asking for memory.
pub(crate) const MOST_OF_A_GROUP: usize = 4;

/// A checked body in its own frame, ready for many questions.
#[derive(Debug, Clone)]
pub struct Mover {
    pub(crate) pieces: Vec<Piece>,
    /// Of those pieces that are upright in the frame of the body.
    pub(crate) prisms: Vec<Option<Prism>>,
    pub(crate) groups: Vec<Group>,
    interior: Option<Interior>,
}

/// A few pieces that are asked about at once, by the boxes around them in the frame of the body.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    /// Of the first piece.
    pub(crate) first: usize,
    pub(crate) count: usize,
    /// Centres and half extents, member by member, mm; unused places repeat the first piece.
    centres: [[f32; MOST_OF_A_GROUP]; 3],
    halves: [[f32; MOST_OF_A_GROUP]; 3],
    /// The box around all of them, likewise.
    centre: [f32; 3],
    half: [f32; 3],
    /// Largest distance of a point from the origin of the body, rounded outward, mm.
    ball: f64,
    /// How far the boxes of the group are widened wherever it stands, mm.
    wider: f64,
}

/// Relative error allowed for the boxes of a group at their place: fewer than ten roundings to
/// single precision, of magnitudes that sum up to those of group and way along the axis.
const SINGLE: f64 = 1e-6;

impl Mover {
    /// Takes a shape apart.
    ///
    /// # Errors
    /// [`Flaw`] of the shape.
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

    /// True when the body holds space that others can be inside of without touching its triangles.
    pub(crate) fn is_hollow(&self) -> bool {
        self.interior
            .as_ref()
            .is_some_and(|interior| !interior.solids.is_empty())
    }

    /// The inside where the way begins.
    pub(crate) fn interior_at_start(&self, path: &Path) -> Interior {
        let (frame, position) = (path.start(), path.origin(0.0));
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
            centre: [0.0; 3],
            half: [0.0; 3],
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

    /// Bits of the places that are in use.
    #[inline]
    pub(crate) fn used(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// How far beyond its size a box is widened along each axis for `margin` and all rounding to single
    /// precision, mm. What is rounded along an axis is of the magnitude of places along it, and of the group.
    #[inline]
    fn wider(&self, path: &Path, margin: f64) -> [f32; 3] {
        let always = (self.wider + margin * (1.0 + SINGLE)) as f32;
        let on = |axis: usize| {
            let way = (path.from[axis] as f32).abs() + (path.displacement[axis] as f32).abs();
            always + SINGLE as f32 * way
        };
        [on(0), on(1), on(2)]
    }

    /// The boxes of the pieces where the way begins, rounded outward and widened by `margin` (mm).
    ///
    /// Of a turning group: the box of the ball it stays in, whatever the turn.
    #[inline]
    pub(crate) fn boxes(&self, path: &Path, margin: f64) -> Boxes<MOST_OF_A_GROUP> {
        self.placed(path, margin, &self.centres, &self.halves)
    }

    /// The box around all of them, likewise.
    #[inline(always)]
    pub(crate) fn hull(&self, path: &Path, margin: f64) -> Cover {
        let (centre, half) = (self.centre.map(|it| [it]), self.half.map(|it| [it]));
        self.placed(path, margin, &centre, &half).cover(0)
    }

    #[inline(always)]
    fn placed<const N: usize>(
        &self,
        path: &Path,
        margin: f64,
        centres: &[[f32; N]; 3],
        halves: &[[f32; N]; 3],
    ) -> Boxes<N> {
        let oriented;
        let (centres, halves) = if path.is_unturned() && path.turn.is_none() {
            (centres, halves)
        } else {
            oriented = match path.turn {
                Some(_) => ([[0.0; N]; 3], [[self.ball as f32; N]; 3]),
                None => turned(path.start(), centres, halves),
            };
            (&oriented.0, &oriented.1)
        };
        let wider = self.wider(path, margin);
        let mut boxes = Boxes::NOWHERE;
        for axis in 0..3 {
            let (origin, wider) = (path.from[axis] as f32, wider[axis]);
            for place in 0..N {
                let (centre, half) = (centres[axis][place] + origin, halves[axis][place] + wider);
                boxes.low[axis][place] = centre - half;
                boxes.high[axis][place] = centre + half;
            }
        }
        boxes
    }
}

/// Centres, as seen from the origin, and half extents along the axes of the parent frame.
#[inline]
fn turned<const N: usize>(
    frame: &Frame,
    centres: &[[f32; N]; 3],
    halves: &[[f32; N]; 3],
) -> ([[f32; N]; 3], [[f32; N]; 3]) {
    if frame.is_yaw() {
        let (mut centre, mut half) = along_axes::<N, 2>(frame, centres, halves);
        (centre[2], half[2]) = (centres[2], halves[2]);
        (centre, half)
    } else {
        along_axes::<N, 3>(frame, centres, halves)
    }
}

/// The first `AXES` of them, from as many.
#[allow(
    clippy::needless_range_loop,
    reason = "both ends known, the loops unroll: half the time of iterators"
)]
#[inline(always)]
fn along_axes<const N: usize, const AXES: usize>(
    frame: &Frame,
    centres: &[[f32; N]; 3],
    halves: &[[f32; N]; 3],
) -> ([[f32; N]; 3], [[f32; N]; 3]) {
    let mut turned = ([[0.0; N]; 3], [[0.0; N]; 3]);
    let images = [frame.x, frame.y, frame.z];
    for axis in 0..AXES {
        for own in 0..AXES {
            let image = images[own][axis] as f32;
            for place in 0..N {
                turned.0[axis][place] += image * centres[own][place];
                turned.1[axis][place] += image.abs() * halves[own][place];
            }
        }
    }
    turned
}

/// Largest distance of a point of the piece from the origin of its body, mm, rounded outward.
pub(crate) fn reach_of(piece: &Piece) -> f64 {
    (length(piece.centre) + piece.radius()) * (1.0 + 8.0 * f64::EPSILON)
}

/// What the model can be asked about: a [`Mover`], or a [`Shape`] that is taken apart for this one question.
pub trait Moving {
    /// Asks about the body taken apart; `None` when the shape is flawed, which is answered with blocked.
    fn asked<A>(&self, ask: impl FnOnce(&Mover) -> A) -> Option<A>;
}

impl Moving for Mover {
    #[inline(always)]
    fn asked<A>(&self, ask: impl FnOnce(&Mover) -> A) -> Option<A> {
        Some(ask(self))
    }
}

impl Moving for Shape {
    fn asked<A>(&self, ask: impl FnOnce(&Mover) -> A) -> Option<A> {
        Mover::new(self).ok().map(|mover| ask(&mover))
    }
}
