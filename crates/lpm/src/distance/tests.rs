//! Tests of the distance of two convex pieces.
//!
//! The true distance is constructed, not computed. For a direction `n` the nearest points are the farthest point of one
//! piece along `n` and the farthest point of the other against `n`; the test places the second piece so that these
//! points lie exactly `gap` apart along `n`. Then the distance is `gap`, whatever the shapes.
use super::*;
use crate::piece::pieces_of;
use crate::pose::Frame;
use crate::vector::{along, cross, unit};
use crate::{Mesh, Shape};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Random numbers from a seed, so that a failure can be reproduced.
pub(crate) struct Dice(SplitMix64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed))
    }
    pub(crate) fn next(&mut self) -> u64 {
        self.0.next_u64()
    }
    /// Draws a number in -1..1.
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    pub(crate) fn vector(&mut self) -> Vec3 {
        [self.signed(), self.signed(), self.signed()]
    }
    pub(crate) fn pick(&mut self, count: u64) -> u64 {
        self.next() % count
    }
    /// Draws a size between that of a thin foil and a metre.
    pub(crate) fn size(&mut self) -> f64 {
        10f64.powf(0.5 + 2.0 * self.signed())
    }
    pub(crate) fn rotation(&mut self) -> [f64; 4] {
        match self.pick(4) {
            0 => [1.0, 0.0, 0.0, 0.0],
            1 => [1.0, 1e-12 * self.signed(), 1e-9 * self.signed(), 0.0],
            2 => [self.signed(), 0.0, 0.0, self.signed()],
            _ => [self.signed(), self.signed(), self.signed(), self.signed()],
        }
    }
    pub(crate) fn shape(&mut self) -> Shape {
        match self.pick(4) {
            0 => Shape::Block {
                half: [self.size(), self.size(), self.size()],
            },
            1 => Shape::Cylinder {
                radius: self.size(),
                height: self.size(),
            },
            2 => {
                let (a, b, c) = (self.vector(), self.vector(), self.vector());
                let size = self.size();
                let vertices = [a, b, c].map(|corner| scale(corner, size)).to_vec();
                Shape::Mesh(Mesh {
                    vertices,
                    triangles: vec![[0, 1, 2]],
                })
            }
            _ => {
                let (a, d, size) = (self.vector(), self.vector(), self.size());
                let third = along(along(a, 0.3, d), 1e-7, self.vector());
                let vertices = [a, along(a, 1.0, d), third]
                    .map(|corner| scale(corner, size))
                    .to_vec();
                Shape::Mesh(Mesh {
                    vertices,
                    triangles: vec![[0, 1, 2]],
                })
            }
        }
    }
}

fn directions_of(piece: &Piece) -> [Vec3; 3] {
    match piece.form {
        crate::piece::Form::Triangle([a, b, c]) => {
            [sub(b, a), sub(c, b), cross(sub(b, a), sub(c, a))]
        }
        _ => [piece.frame.x, piece.frame.y, piece.frame.z],
    }
}

fn direction(dice: &mut Dice, a: &Piece, b: &Piece) -> Vec3 {
    let (of_a, of_b) = (directions_of(a), directions_of(b));
    let (i, j) = (dice.pick(3) as usize, dice.pick(3) as usize);
    let n = match dice.pick(6) {
        0 => of_a[i],
        1 => of_b[j],
        2 => cross(of_a[i], of_b[j]),
        3 => cross(of_a[i], dice.vector()),
        4 => cross(of_b[j], dice.vector()),
        _ => dice.vector(),
    };
    let n = unit(n).unwrap_or([0.6, 0.0, 0.8]);
    if dice.pick(2) == 0 { n } else { negate(n) }
}

#[test]
fn the_distance_is_proven_to_half_a_nanometre() {
    for seed in 0..60_000 {
        let mut dice = Dice::new(seed);
        let (shape_a, shape_b) = (dice.shape(), dice.shape());
        let frame_b = if dice.pick(3) == 0 {
            [1.0, 1e-13, 0.0, 0.0]
        } else {
            dice.rotation()
        };
        let far = [0.0, 0.0, 1e3, 1e6][dice.pick(4) as usize];
        let place = scale(dice.vector(), far);
        let a = pieces_of(&shape_a)[0].placed(&Frame::of(dice.rotation()), place);
        let b = pieces_of(&shape_b)[0].placed(&Frame::of(frame_b), [0.0; 3]);
        let n = direction(&mut dice, &a, &b);
        let gap_mm = [0.0, 1e-6, 1e-5, 1e-3, 0.1, 10.0][dice.pick(6) as usize];
        let nearest = add(a.centre, a.farthest(n));
        let other = add(b.centre, b.farthest(negate(n)));
        let shift = along(sub(nearest, other), gap_mm, n);
        let found = gap(&a, &b, shift, None);
        // Constructing the case rounds the coordinates a few times too.
        let built = 1e-13 + 8.0 * f64::EPSILON * (reach(nearest) + reach(other) + a.span + b.span);
        assert!(
            found.lower <= gap_mm + built,
            "seed {seed}: proven {} of {gap_mm}",
            found.lower
        );
        let missed = gap_mm - found.lower.max(0.0);
        assert!(missed <= 5e-7 + built, "seed {seed}: {missed:e} mm missed");
    }
}
