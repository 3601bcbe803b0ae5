//! Tests: pairs constructed to touch, to overlap, or to miss by a known amount, from a millimetre down to a nanometre
//! (2^-20 mm), near the origin and a kilometre away, where other libraries fail.
use super::truth::agrees;
use crate::distance::tests::Dice;
use crate::exact::{Body, Form};

/// Unit of 2^-20 mm, a little less than a nanometre; sums at 1e6 mm are still exact in f64.
const UNIT_MM: f64 = 1.0 / 1_048_576.0;
const MM: i64 = 1_048_576;
/// Distances, in units: negative for an overlap, positive for a gap.
const DELTAS: [i64; 13] = [
    0,
    MM,
    -MM,
    MM >> 6,
    -(MM >> 6),
    MM >> 10,
    -(MM >> 10),
    MM >> 14,
    -(MM >> 14),
    4,
    -4,
    2,
    -2,
];
const OFFSETS_MM: [i64; 4] = [0, 1_000, 100_000, 990_000];

/// Draws a radius or half extent: 2 to 34 mm, a multiple of 1/64 mm.
fn size(dice: &mut Dice) -> i64 {
    (2 * MM) + (dice.pick(32 * 64) as i64) * (MM / 64)
}

fn upright(dice: &mut Dice) -> Body {
    let (a, b, c) = (size(dice), size(dice), size(dice));
    if dice.pick(2) == 0 {
        Body::block([0; 3], [a, b, c])
    } else {
        Body::cylinder([0; 3], a, c)
    }
}

/// Returns the half extents of the bounding box.
fn reach(body: &Body) -> [i64; 3] {
    match body.form {
        Form::Block { half, .. } => half,
        Form::Cylinder { radius, half } => [radius, radius, half],
        Form::Triangle(_) => [0; 3],
    }
}

/// Checks the pair far from the origin, with each body as mover in turn.
fn judged(element: &Body, mover: &Body, run: [i64; 3], dice: &mut Dice) {
    let far = OFFSETS_MM[dice.pick(4) as usize] * MM;
    let place = [far, -far, far / 1_000];
    agrees(&element.moved(place), &mover.moved(place), run, UNIT_MM);
    let back = run.map(|member| -member);
    agrees(&mover.moved(place), &element.moved(place), back, UNIT_MM);
}

#[test]
fn stacked_and_adjacent_bodies_touch_exactly() {
    for seed in 0..150 {
        let mut dice = Dice::new(seed);
        let (element, mover) = (upright(&mut dice), upright(&mut dice));
        let (a, b) = (reach(&element), reach(&mover));
        for delta in DELTAS {
            let axis = dice.pick(3) as usize;
            let mut centre = [0; 3];
            centre[axis] = a[axis] + b[axis] + delta;
            let mover = Body { centre, ..mover };
            judged(&element, &mover, [0; 3], &mut dice);
            // Then a move that lifts the mover off.
            let mut away = [0; 3];
            away[axis] = 5 * MM;
            judged(&element, &mover, away, &mut dice);
        }
    }
}

#[test]
fn slides_and_tangents_of_any_length_touch_exactly() {
    for seed in 0..150 {
        let mut dice = Dice::new(1_000 + seed);
        let (element, mover) = (upright(&mut dice), upright(&mut dice));
        let (a, b) = (reach(&element), reach(&mover));
        let length = [MM, 20 * MM, 100 * MM, 1_000 * MM, 5_000 * MM][dice.pick(5) as usize];
        for delta in DELTAS {
            let across = dice.pick(3) as usize;
            let along = (across + 1 + dice.pick(2) as usize) % 3;
            let (mut centre, mut run) = ([0; 3], [0; 3]);
            centre[across] = a[across] + b[across] + delta;
            centre[along] = -length / 2;
            run[along] = length;
            judged(&element, &Body { centre, ..mover }, run, &mut dice);
        }
    }
}

#[test]
fn a_head_on_move_stops_exactly_or_slightly_early() {
    for seed in 0..150 {
        let mut dice = Dice::new(2_000 + seed);
        let (element, mover) = (upright(&mut dice), upright(&mut dice));
        let (a, b) = (reach(&element), reach(&mover));
        for delta in DELTAS {
            let axis = dice.pick(3) as usize;
            let (mut centre, mut run) = ([0; 3], [0; 3]);
            centre[axis] = a[axis] + b[axis] + 50 * MM;
            run[axis] = delta - 50 * MM;
            judged(&element, &Body { centre, ..mover }, run, &mut dice);
        }
    }
}

#[test]
fn corner_and_rim_contacts_are_exact_to_a_nanometre() {
    for seed in 0..150 {
        let mut dice = Dice::new(3_000 + seed);
        let half = [size(&mut dice), size(&mut dice), size(&mut dice)];
        let radius = 5 * (size(&mut dice) / 5);
        let element = Body::block([0; 3], half);
        for delta in DELTAS {
            let delta = delta - delta % 2;
            let rim = Body::cylinder(
                [
                    half[0] + 3 * radius / 5 + delta,
                    half[1] + 4 * radius / 5,
                    0,
                ],
                radius,
                size(&mut dice),
            );
            judged(&element, &rim, [0; 3], &mut dice);
            let tangent = [4 * radius, -3 * radius, 0];
            let half_way_back = [-2 * radius, 3 * (radius / 2), 0];
            if radius % 2 == 0 {
                judged(&element, &rim.moved(half_way_back), tangent, &mut dice);
            }
        }
    }
}

#[test]
fn enclosed_and_coaxial_bodies_are_blocked() {
    for seed in 0..150 {
        let mut dice = Dice::new(4_000 + seed);
        let outer = upright(&mut dice);
        let reach = reach(&outer);
        let inner = Body::cylinder([0; 3], reach[0].min(reach[1]) / 3, reach[2] / 2);
        for run in [[0; 3], [MM / 7, 0, 0], [1, 1, 1], [5_000 * MM, 0, 0]] {
            judged(&outer, &inner, run, &mut dice);
        }
        let coaxial = Body::cylinder([0, 0, reach[2] / 2], size(&mut dice), reach[2]);
        judged(&outer, &coaxial, [0, 0, MM / 2], &mut dice);
    }
}

#[test]
fn turned_blocks_agree_with_exact_arithmetic() {
    // Units of 1/1024 mm, quaternions with members of one digit, any axis: edges cross edges, corners meet faces.
    for seed in 0..2_500 {
        let mut dice = Dice::new(5_000 + seed);
        let mut turned = |most: u64| {
            let mut digit = || dice.pick(7) as i64 - 3;
            let rotation = [1 + digit().abs(), digit(), digit(), digit()];
            let mut whole = || 1 + dice.pick(most) as i64;
            let half = [whole(), whole(), whole()];
            let mut place = || dice.pick(8 * most) as i64 - 4 * most as i64;
            Body {
                centre: [place(), place(), place()],
                form: Form::Block { half, rotation },
            }
        };
        let (element, mover, goal) = (turned(12_000), turned(12_000), turned(12_000).centre);
        let run = [0, 1, 2].map(|axis| goal[axis] - mover.centre[axis]);
        agrees(&element, &mover, run, 1.0 / 1024.0);
    }
}

#[test]
fn triangles_agree_with_exact_arithmetic() {
    // On a coarse grid corners often fall on edges, and planes coincide.
    let mut touched = 0;
    for seed in 0..2_500 {
        let mut dice = Dice::new(8_000 + seed);
        let mut triangle = || loop {
            let mut whole = || dice.pick(5) as i64 - 2;
            let corners = [0; 3].map(|_| [whole(), whole(), whole()]);
            let [a, b, c] = corners;
            let (u, v) = (
                [0, 1, 2].map(|i| b[i] - a[i]),
                [0, 1, 2].map(|i| c[i] - a[i]),
            );
            if [0, 1, 2]
                .iter()
                .any(|i| u[*i] * v[(i + 1) % 3] != u[(i + 1) % 3] * v[*i])
            {
                let centre = [whole(), whole(), whole()];
                return Body {
                    centre,
                    form: Form::Triangle(corners),
                };
            }
        };
        let (element, mover) = (triangle(), triangle());
        let run = [[0; 3], [0, 0, 3], [2, -1, 0], [-3, 2, 1]][seed as usize % 4];
        agrees(&element, &mover, run, 1.0);
        touched += usize::from(crate::exact::first_contact(&element, &mover, run).is_some());
    }
    assert!((250..2_250).contains(&touched), "{touched}");
}
