//! Tests of small worlds, in which every case is tried instead of samples.
//!
//! `relayrig study collision` enumerates the larger world of corners 0 to 3 (16 million moves).
use super::truth::agrees;
use crate::exact::{Body, Form};

/// Returns every body with corners at 0, 1, 2 along each axis: blocks, and cylinders of radius 1; in half units.
fn every_body() -> Vec<Body> {
    let spans = [[0, 1], [0, 2], [1, 2]];
    let mut bodies = Vec::new();
    for [bottom, top] in spans {
        for [left, right] in spans {
            for [front, back] in spans {
                let centre = [left + right, front + back, bottom + top];
                bodies.push(Body::block(
                    centre,
                    [right - left, back - front, top - bottom],
                ));
            }
        }
        for x in 0..3 {
            for y in 0..3 {
                bodies.push(Body::cylinder(
                    [2 * x, 2 * y, bottom + top],
                    2,
                    top - bottom,
                ));
            }
        }
    }
    bodies
}

fn every_move(most: i64) -> Vec<[i64; 3]> {
    let steps = || (-most..=most).map(|it| 2 * it);
    steps()
        .flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])))
        .collect()
}

#[test]
fn every_move_in_a_small_world_is_exact() {
    let (bodies, moves) = (every_body(), every_move(1));
    let mut counted = 0;
    for element in &bodies {
        for mover in &bodies {
            for run in &moves {
                agrees(element, mover, *run, 0.5);
                counted += 1;
            }
        }
    }
    assert_eq!(counted, 54 * 54 * 27);
}

#[test]
fn every_longer_move_in_a_small_world_is_exact() {
    let (bodies, moves) = (every_body(), every_move(3));
    let mut counted = 0;
    for element in [
        Body::block([2, 2, 2], [1, 1, 1]),
        Body::cylinder([2, 2, 2], 2, 1),
    ] {
        for mover in &bodies {
            for run in &moves {
                agrees(&element, mover, *run, 0.5);
                counted += 1;
            }
        }
    }
    assert_eq!(counted, 2 * 54 * 343);
}

#[test]
fn every_tilt_by_a_small_quaternion_is_exact() {
    let digits = -1..=1_i64;
    let mut counted = 0;
    for code in 0..81 {
        let rotation = [
            code / 27 - 1,
            code / 9 % 3 - 1,
            code / 3 % 3 - 1,
            code % 3 - 1,
        ];
        if rotation == [0; 4] {
            continue;
        }
        for height in 0..24 {
            for side in digits.clone() {
                let form = Form::Block {
                    half: [4, 3, 2],
                    rotation,
                };
                let centre = [16 * side - 16, 3, height];
                let element = Body::block([0; 3], [5, 5, 5]);
                agrees(&element, &Body { centre, form }, [32, -6, 0], 1.0);
                counted += 1;
            }
        }
    }
    assert_eq!(counted, 80 * 24 * 3);
}
