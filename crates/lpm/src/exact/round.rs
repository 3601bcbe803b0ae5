//! Contact of an upright cylinder with another one, or with a block that is turned only about z.
//!
//! The Minkowski sum of both bodies is an interval in z times a figure on the baseplate: a disc, or a rectangle with
//! round corners (two slabs, and four discs at the corners, in the frame of the rectangle).

use super::Form;
use super::times::{Stretch, Time};

/// Footprint of the element grown by that of the mover (Minkowski sum), so that the mover becomes a point.
enum Outline {
    Disc(i128),
    /// Half extents of the rectangle, and the radius by which it is grown.
    Rounded([i128; 2], i128),
}

/// Returns the first fraction of the move at which `mover`, which lies `apart` from `element` and moves by `run`,
/// touches it.
pub(super) fn first_contact(
    element: &Form,
    mover: &Form,
    apart: [i128; 3],
    run: [i128; 3],
) -> Option<f64> {
    let (outline, high, [w, z]) = summed(element, mover);
    let during = Stretch::WHOLE.while_within(apart[2], run[2], -high, high)?;
    // Converts into the frame of the rectangle: rotates back, and scales by the squared length of the quaternion.
    let turned = |[x, y]: [i128; 2]| {
        let (cos, sin) = (w * w - z * z, 2 * w * z);
        [cos * x + sin * y, cos * y - sin * x]
    };
    let (place, run) = (turned([apart[0], apart[1]]), turned([run[0], run[1]]));
    match outline {
        Outline::Disc(radius) => disc(during, place, run, radius),
        Outline::Rounded(half, radius) => rounded(during, place, run, half, radius),
    }
}

/// Returns the Minkowski sum of both bodies: outline, height, and `w` and `z` of the quaternion of the rectangle.
///
/// The sum is symmetric: a rectangle is its own mirror image, so either body may be the mover.
fn summed(element: &Form, mover: &Form) -> (Outline, i128, [i128; 2]) {
    match (*element, *mover) {
        (
            Form::Cylinder {
                radius: ra,
                half: ha,
            },
            Form::Cylinder {
                radius: rb,
                half: hb,
            },
        ) => {
            let radius = i128::from(ra) + i128::from(rb);
            (
                Outline::Disc(radius),
                i128::from(ha) + i128::from(hb),
                [1, 0],
            )
        }
        (Form::Block { half, rotation }, Form::Cylinder { radius, half: high })
        | (Form::Cylinder { radius, half: high }, Form::Block { half, rotation }) => {
            let [w, x, y, z] = rotation.map(i128::from);
            assert!(
                x == 0 && y == 0,
                "a tilted block and a cylinder have no exact truth here"
            );
            let scale = w * w + z * z;
            let half = half.map(i128::from);
            let outline = Outline::Rounded(
                [scale * half[0], scale * half[1]],
                scale * i128::from(radius),
            );
            (outline, half[2] + i128::from(high), [w, z])
        }
        _ => panic!("a triangle and a cylinder have no exact truth here"),
    }
}

fn rounded(
    during: Stretch,
    place: [i128; 2],
    run: [i128; 2],
    half: [i128; 2],
    radius: i128,
) -> Option<f64> {
    let slab = |x: i128, y: i128| {
        let stretch = during.while_within(place[0], run[0], -x, x)?;
        let stretch = stretch.while_within(place[1], run[1], -y, y)?;
        Some(stretch.from.value())
    };
    let corner = |x: i128, y: i128| disc(during, [place[0] - x, place[1] - y], run, radius);
    let [x, y] = half;
    let meetings = [
        slab(x + radius, y),
        slab(x, y + radius),
        corner(x, y),
        corner(-x, y),
        corner(-x, -y),
        corner(x, -y),
    ];
    meetings.into_iter().flatten().min_by(f64::total_cmp)
}

/// Returns the first time in `during` at which a point is within `radius` of the origin.
fn disc(during: Stretch, place: [i128; 2], run: [i128; 2], radius: i128) -> Option<f64> {
    // `a t^2 + 2 b t + c` is the squared distance minus the squared radius, for the run divided by the greatest common
    // divisor of its components.
    let step = divisor(run[0], run[1]).max(1);
    let run = run.map(|member| member / step);
    let a = run[0] * run[0] + run[1] * run[1];
    let b = place[0] * run[0] + place[1] * run[1];
    let c = place[0] * place[0] + place[1] * place[1] - radius * radius;
    // Positive when the point is outside the radius at `t = n step / d`.
    let beyond =
        |Time { n, d }: Time| a * (n * step) * (n * step) + 2 * b * (n * step) * d + c * d * d;
    if beyond(during.from) <= 0 {
        return Some(during.from.value());
    }
    let root = b * b - a * c;
    let nearest_is_later = -b * during.from.d > a * during.from.n * step;
    if a == 0 || root < 0 || !nearest_is_later {
        return None;
    }
    let nearest_is_in_time = -b * during.to.d <= a * during.to.n * step;
    // Here `c > 0 > b`: this form of the root avoids cancellation.
    (nearest_is_in_time || beyond(during.to) <= 0)
        .then(|| c as f64 / ((root as f64).sqrt() - b as f64) / step as f64)
}

fn divisor(a: i128, b: i128) -> i128 {
    if b == 0 { a.abs() } else { divisor(b, a % b) }
}
