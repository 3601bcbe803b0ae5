//! Tests of situations in which other libraries were reported to fail; the numbers are chosen here.
//!
//! Brackets name the library, the number of the report, and the failure.
use super::truth::agrees;
use super::*;
use crate::exact::{Body, Form};

/// Unit of 1/1024 mm.
const UNIT_MM: f64 = 1.0 / 1024.0;
const MM: i64 = 1024;

/// Checks the pair with each body as mover in turn, at the origin and far from it.
fn holds(element: Body, mover: Body, run: [i64; 3]) {
    for place in [
        [0; 3],
        [512 * MM, -256 * MM, 64 * MM],
        [100_000 * MM, 90_000 * MM, 0],
    ] {
        agrees(&element.moved(place), &mover.moved(place), run, UNIT_MM);
        let back = run.map(|member| -member);
        agrees(&mover.moved(place), &element.moved(place), back, UNIT_MM);
    }
}

#[test]
fn overlapping_coaxial_cylinders_are_blocked() {
    // [parry 396: "no"; drawn solids of revolution]
    for rise in [0, MM, 9 * MM, 10 * MM, 10 * MM + 1] {
        let (tall, short) = (
            Body::cylinder([0; 3], 3 * MM, 6 * MM),
            Body::cylinder([0, 0, rise], 8 * MM, 4 * MM),
        );
        holds(tall, short, [0; 3]);
        holds(tall, short, [0, 0, 2 * MM]);
    }
}

#[test]
fn two_cubes_overlapping_by_a_twentieth_are_blocked() {
    // [libccd 25: "no" for an overlap of 0.1 of 2]
    let half = [10 * MM; 3];
    for apart in [19 * MM, 20 * MM - 1, 20 * MM, 20 * MM + 1] {
        holds(
            Body::block([0; 3], half),
            Body::block([apart, 0, 0], half),
            [0; 3],
        );
        holds(
            Body::block([0; 3], half),
            Body::block([apart, apart, apart], half),
            [0; 3],
        );
    }
}

#[test]
fn a_large_and_a_small_block_are_separated() {
    // [libccd 17, coal 531: very different sizes; rapier 305: a cylinder through a thin large plate]
    let plate = Body::block([0; 3], [2_000 * MM, 2_000 * MM, MM / 16]);
    for gap in [-2, -1, 0, 1, 2] {
        let grain = Body::block([700 * MM, -900 * MM, MM / 16 + 4 + gap], [4, 4, 4]);
        holds(plate, grain, [0; 3]);
        holds(plate, grain, [300 * MM, 0, 0]);
        let pin = Body::cylinder([0, 0, 50 * MM], MM / 4, 5 * MM);
        holds(plate, pin, [0, 0, -(45 * MM - MM / 16) + gap]);
    }
    holds(
        plate,
        Body::cylinder([0, 0, 50 * MM], MM / 4, 5 * MM),
        [0, 0, -1_000 * MM],
    );
}

#[test]
fn a_block_entering_or_overlapping_another_is_blocked() {
    // [FCL 120, 555: missed; bullet 1250, 2972: start overlap not reported; jolt 1787: touching start]
    let (base, tool) = (
        Body::block([0; 3], [50 * MM, 40 * MM, 10 * MM]),
        [5 * MM; 3],
    );
    for (height, run) in [
        (16, -1),
        (16, -2),
        (15, 0),
        (15, -1),
        (14, 5),
        (0, 30),
        (0, 0),
    ] {
        holds(
            base,
            Body::block([3 * MM, 2 * MM, height * MM], tool),
            [0, 0, run * MM],
        );
    }
}

#[test]
fn a_cylinder_at_an_edge_stays_round() {
    // [FCL 319, coal 37: exceptions and no convergence near contact; godot-jolt 516: rounded by a margin]
    let block = Body::block([0; 3], [20 * MM, 20 * MM, 20 * MM]);
    for gap in [-64, -1, 0, 1, 64] {
        let beside = Body::cylinder([25 * MM + gap, 0, 39 * MM], 5 * MM, 20 * MM);
        holds(block, beside, [0; 3]);
        holds(block, beside, [0, 13 * MM, 0]);
        let on_edge = Body::cylinder([23 * MM + gap, 24 * MM, 0], 5 * MM, 20 * MM);
        holds(block, on_edge, [0; 3]);
        holds(block, on_edge, [0, 0, 100 * MM]);
    }
}

#[test]
fn parallel_faces_and_equal_poses_give_finite_answers() {
    // [FCL 2: NaN for parallel faces; 628: containment; ncollide 182: panic]
    let half = [7 * MM, 5 * MM, 3 * MM];
    holds(Body::block([0; 3], half), Body::block([0; 3], half), [0; 3]);
    holds(
        Body::block([0; 3], half),
        Body::block([0; 3], half.map(|it| it / 2)),
        [1, 1, 1],
    );
    holds(
        Body::block([0; 3], half),
        Body::block([14 * MM, 10 * MM, 6 * MM], half),
        [0; 3],
    );
    let turned = Form::Block {
        half,
        rotation: [2, 0, 0, 1],
    };
    let twins = [[0; 3], [1, 0, 0]].map(|centre| Body {
        centre,
        form: turned,
    });
    holds(twins[0], twins[1], [0; 3]);
}

#[test]
fn a_long_move_stops_exactly_at_a_block() {
    // [parry 429: up to 139 mm short at 500 m; 317: a plain hit missed]
    let block = Body::block([400_000 * MM, 0, 0], [2 * MM, 2 * MM, 2 * MM]);
    for offset in [0, 4 * MM - 1, 4 * MM, 4 * MM + 1] {
        let cube = Body::block([0, offset, 0], [2 * MM, 2 * MM, 2 * MM]);
        agrees(&block, &cube, [500_000 * MM, 0, 0], UNIT_MM);
        agrees(&block, &cube, [399_990 * MM, 0, 0], UNIT_MM);
    }
}

#[test]
fn a_gap_below_the_rounding_of_squares_is_clear() {
    // [a linear complementarity solver in double said "intersects"; exact numbers said "disjoint"]
    let block = Body::block([0; 3], [300 * MM, 300 * MM, 300 * MM]);
    for gap in [0, 1, 2] {
        let disc = Body::cylinder(
            [300 * MM + 300 * MM + gap, 300 * MM + 400 * MM, 0],
            500 * MM,
            MM,
        );
        holds(block, disc, [0; 3]);
    }
}

#[test]
fn a_turn_is_not_the_hull_of_its_ends() {
    // [bullet by moveit 2889: hull of the end poses; a bar turned by half a turn sweeps a disc]
    let bar = block(60.0, 2.0, 2.0);
    let pin = standing(&cylinder(1.0, 20.0), Pose::at([0.0, 50.0, 0.0]));
    let half_turn = way(Pose::IDENTITY, Pose::yawed([0.0; 3], 3.1));
    assert!(stop(&pin, &bar, &half_turn).is_some());
    assert!(stop(&pin, &bar, &way(Pose::IDENTITY, Pose::yawed([0.0; 3], 1.4))).is_none());
}

#[test]
fn mesh_corners_and_edges_let_no_body_through() {
    // [embree 387, 423: rays slip through vertices; here rods, thinner and thinner, onto a common corner]
    let fan = Shape::Mesh(Mesh {
        vertices: vec![
            [0.0; 3],
            [9.0, 0.0, 0.0],
            [0.0, 9.0, 0.0],
            [-9.0, 0.0, 0.0],
            [0.0, -9.0, 0.0],
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]],
    });
    let model = standing(&fan, Pose::IDENTITY);
    for radius in [1.0, 1e-3, 1e-6, 1e-9] {
        for place in [[0.0, 0.0], [4.5, 0.0], [4.5, 4.5], [1e-12, -1e-12]] {
            let down = straight([place[0], place[1], 30.0], [place[0], place[1], -30.0]);
            let t = stop(&model, &cylinder(radius, 2.0), &down).unwrap();
            assert!((t - 29.0 / 60.0).abs() < 1e-9, "{radius} {place:?}: {t}");
        }
    }
}
