//! Closed forms for two upright pieces; each is an interval in z times a rectangle or a disc.
//!
//! The distance of two upright prisms is the hypotenuse of their gap in z and the gap of their footprints. This form
//! needs no iteration and no cross product of nearly parallel edges.

use super::Proposal;
use crate::piece::{Form, Piece};
use crate::vector::{Vec3, length, unit};

type Vec2 = [f64; 2];

/// Footprint of an upright piece on the baseplate.
#[derive(Debug, Clone, Copy)]
enum Footprint {
    Disc(f64),
    /// Half extents, and the unit vector of the first axis.
    Rectangle(Vec2, Vec2),
}

/// Nearest points of two footprints: their difference, and the point of the first one.
#[derive(Debug, Clone, Copy)]
struct Flat {
    apart: Vec2,
    on_a: Vec2,
}

/// Returns the best plane between the upright pieces `a` and `b`, and their distance up to rounding, mm; `c` is the
/// vector between their centres.
pub(crate) fn propose(a: &Piece, b: &Piece, c: Vec3) -> (Proposal, f64) {
    let (foot_a, half_a) = footprint(a);
    let (foot_b, half_b) = footprint(b);
    let flat = footprints(foot_a, foot_b, [c[0], c[1]]);
    let (z_apart, z_on_a) = heights(half_a, half_b, c[2]);
    let apart = [flat.apart[0], flat.apart[1], z_apart];
    let on_a = [flat.on_a[0], flat.on_a[1], z_on_a];
    let normal = unit(apart).or_else(|| unit(c)).unwrap_or([0.0, 0.0, 1.0]);
    (Proposal { normal, on_a }, length(apart))
}

fn footprint(piece: &Piece) -> (Footprint, f64) {
    match piece.form {
        Form::Block(half) => {
            let x = piece.frame.x;
            (
                Footprint::Rectangle([half[0], half[1]], [x[0], x[1]]),
                half[2],
            )
        }
        Form::Cylinder { radius, half } => (Footprint::Disc(radius), half),
        // Triangles are never upright; a point in place of one would at worst give a poor plane, never a false proof.
        Form::Triangle(_) => (Footprint::Disc(0.0), 0.0),
    }
}

/// Returns the signed gap in z, mm, and the height of the point of `a` nearest to `b`, relative to the centre of `a`.
fn heights(half_a: f64, half_b: f64, c: f64) -> (f64, f64) {
    let apart = c.abs() - half_a - half_b;
    if apart > 0.0 {
        return (apart.copysign(c), half_a.copysign(c));
    }
    let low = (-half_a).max(c - half_b);
    let high = half_a.min(c + half_b);
    (0.0, (low + high) / 2.0)
}

fn footprints(a: Footprint, b: Footprint, c: Vec2) -> Flat {
    match (a, b) {
        (Footprint::Disc(ra), Footprint::Disc(rb)) => shrunk(
            Flat {
                apart: c,
                on_a: [0.0, 0.0],
            },
            ra,
            rb,
        ),
        (Footprint::Rectangle(half, x), Footprint::Disc(radius)) => {
            shrunk(point_from_rectangle(half, x, c), 0.0, radius)
        }
        (Footprint::Disc(radius), Footprint::Rectangle(half, x)) => {
            let seen = point_from_rectangle(half, x, [-c[0], -c[1]]);
            let flat = Flat {
                apart: [-seen.apart[0], -seen.apart[1]],
                on_a: [0.0, 0.0],
            };
            shrunk(flat, radius, 0.0)
        }
        (Footprint::Rectangle(ha, xa), Footprint::Rectangle(hb, xb)) => {
            rectangles(ha, xa, hb, xb, c)
        }
    }
}

/// Returns `flat` after its two points have grown to discs of radius `ra` and `rb`, which shrinks the gap.
fn shrunk(flat: Flat, ra: f64, rb: f64) -> Flat {
    let distance = flat.apart[0].hypot(flat.apart[1]);
    let left = distance - ra - rb;
    if !(left > 0.0) {
        let reach = if distance > 0.0 {
            ra.min(distance) / distance
        } else {
            0.0
        };
        return Flat {
            apart: [0.0, 0.0],
            on_a: towards(flat, reach),
        };
    }
    let factor = left / distance;
    let apart = [flat.apart[0] * factor, flat.apart[1] * factor];
    Flat {
        apart,
        on_a: towards(flat, ra / distance),
    }
}

fn towards(flat: Flat, fraction: f64) -> Vec2 {
    [
        flat.on_a[0] + flat.apart[0] * fraction,
        flat.on_a[1] + flat.apart[1] * fraction,
    ]
}

/// Returns the nearest points of a rectangle (half extents, first axis `x`, centred at the origin) and a point `p`.
fn point_from_rectangle(half: Vec2, x: Vec2, p: Vec2) -> Flat {
    let local = [p[0] * x[0] + p[1] * x[1], p[1] * x[0] - p[0] * x[1]];
    let near = [
        local[0].clamp(-half[0], half[0]),
        local[1].clamp(-half[1], half[1]),
    ];
    let apart = [local[0] - near[0], local[1] - near[1]];
    Flat {
        apart: out_of(x, apart),
        on_a: out_of(x, near),
    }
}

/// Converts coordinates along `x` and its left normal into the common frame.
fn out_of(x: Vec2, local: Vec2) -> Vec2 {
    [
        local[0] * x[0] - local[1] * x[1],
        local[0] * x[1] + local[1] * x[0],
    ]
}

fn rectangles(ha: Vec2, xa: Vec2, hb: Vec2, xb: Vec2, c: Vec2) -> Flat {
    if xa == xb || (xa[0] == -xb[0] && xa[1] == -xb[1]) {
        return parallel(ha, hb, xa, c);
    }
    if footprints_meet(ha, xa, hb, xb, c) {
        // Any nearest point may serve as the place of contact; this is the middle of all of them.
        return Flat {
            apart: [0.0, 0.0],
            on_a: point_from_rectangle(ha, xa, c).on_a,
        };
    }
    let mut best: Option<(f64, Flat)> = None;
    for corner in corners(hb, xb) {
        let flat = point_from_rectangle(ha, xa, [c[0] + corner[0], c[1] + corner[1]]);
        keep_nearer(&mut best, flat);
    }
    for corner in corners(ha, xa) {
        let seen = point_from_rectangle(hb, xb, [corner[0] - c[0], corner[1] - c[1]]);
        keep_nearer(
            &mut best,
            Flat {
                apart: [-seen.apart[0], -seen.apart[1]],
                on_a: corner,
            },
        );
    }
    best.map_or(
        Flat {
            apart: [0.0, 0.0],
            on_a: [0.0, 0.0],
        },
        |(_, flat)| flat,
    )
}

/// Returns the nearest points of two rectangles with common axes.
fn parallel(ha: Vec2, hb: Vec2, x: Vec2, c: Vec2) -> Flat {
    let local = [c[0] * x[0] + c[1] * x[1], c[1] * x[0] - c[0] * x[1]];
    let first = heights(ha[0], hb[0], local[0]);
    let second = heights(ha[1], hb[1], local[1]);
    Flat {
        apart: out_of(x, [first.0, second.0]),
        on_a: out_of(x, [first.1, second.1]),
    }
}

fn keep_nearer(best: &mut Option<(f64, Flat)>, flat: Flat) {
    let squared = flat.apart[0] * flat.apart[0] + flat.apart[1] * flat.apart[1];
    if best.is_none_or(|(least, _)| squared < least) {
        *best = Some((squared, flat));
    }
}

fn corners(half: Vec2, x: Vec2) -> [Vec2; 4] {
    let [a, b] = half;
    [[a, b], [-a, b], [-a, -b], [a, -b]].map(|local| out_of(x, local))
}

/// Returns true when no axis of either rectangle separates the rectangles.
fn footprints_meet(ha: Vec2, xa: Vec2, hb: Vec2, xb: Vec2, c: Vec2) -> bool {
    let cos = (xa[0] * xb[0] + xa[1] * xb[1]).abs();
    let sin = (xa[0] * xb[1] - xa[1] * xb[0]).abs();
    let along = |x: Vec2| {
        [
            (c[0] * x[0] + c[1] * x[1]).abs(),
            (c[1] * x[0] - c[0] * x[1]).abs(),
        ]
    };
    let (in_a, in_b) = (along(xa), along(xb));
    in_a[0] <= ha[0] + hb[0] * cos + hb[1] * sin
        && in_a[1] <= ha[1] + hb[0] * sin + hb[1] * cos
        && in_b[0] <= hb[0] + ha[0] * cos + ha[1] * sin
        && in_b[1] <= hb[1] + ha[0] * sin + ha[1] * cos
}
