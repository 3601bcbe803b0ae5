//! Tests of the paper's method, the polygons and the small world, on examples that a reader can check by hand.
#![allow(clippy::unwrap_used)]
use super::outline::Outline;
use super::paper::Stepping;
use super::scene::thinned;
use super::small_world::{SmallWorldCounts, check_all};
use super::world::{TestMove, World};
use super::*;
use crate::scatter::{Point, Scatter};
use lpm::exact::{Body, first_contact};

const MM: i64 = 1024;

fn test_move(from: [i64; 3], run: [i64; 3]) -> TestMove {
    TestMove {
        kind: 0,
        from,
        run,
        truth: None,
        deep: false,
        near: 0,
    }
}

#[test]
fn stepping_stops_at_the_last_clear_pose() {
    let foil = [Body::block(
        [50 * MM, 20 * MM, 0],
        [MM / 8, 20 * MM, 20 * MM],
    )];
    let pin = [Body::block([0; 3], [MM, MM, MM])];
    let mut stepping = Stepping::new(&foil, &pin);
    let across = test_move([0, 20 * MM, 0], [101 * MM, 0, 0]);
    let stop = stepping.first_contact(&across, 1.0).unwrap() * 101.0;
    assert!((stop - 48.0).abs() < 1e-9, "{stop}");
    assert_eq!(
        stepping.first_contact(&across, 7.0),
        None,
        "poses at 43.3 and 50.5 would need a wider foil"
    );
}

#[test]
fn boxes_block_the_corner_beside_a_cylinder() {
    let post = [Body::cylinder([50 * MM, 50 * MM, 0], 10 * MM, 20 * MM)];
    let pin = [Body::block([0; 3], [MM, MM, MM])];
    let beside = test_move([41 * MM, 42 * MM, 0], [0, 0, 5 * MM]);
    assert_eq!(
        first_contact(&post[0], &pin[0].moved(beside.from), beside.run),
        None
    );
    assert_eq!(Stepping::new(&post, &pin).first_contact(&beside, 1.0), None);
    let mut exact = swept(&post, &pin).unwrap();
    let mut boxes = swept(&post.map(|it| scene::boxed(&it)), &pin).unwrap();
    assert_eq!((exact(&beside), boxes(&beside)), (None, Some(0.0)));
}

#[test]
fn outlines_meet_unless_an_edge_separates_them() {
    let square = Outline::rectangle([0.0, 0.0], [1.0, 1.0], 0.0);
    let turned = Outline::rectangle([0.0, 0.0], [1.0, 1.0], std::f64::consts::FRAC_PI_4);
    assert!(square.meets(&square, [2.0, 0.0]) && !square.meets(&square, [2.001, 0.0]));
    assert!(square.meets(&turned, [2.41, 0.0]) && !square.meets(&turned, [2.42, 0.0]));
    assert!(!square.meets(&turned, [1.8, 1.8]) && square.meets(&turned, [1.6, 1.6]));
}

#[test]
fn drawn_moves_have_contacts_and_clear_moves() {
    let world = World::random(7, 12);
    for (kind, name) in KINDS.iter().enumerate() {
        let moves: Vec<&TestMove> = world.moves.iter().filter(|it| it.kind == kind).collect();
        let hits = moves.iter().filter(|it| it.truth.is_some()).count();
        assert_eq!(moves.len(), 12);
        assert!(hits > 0, "{name}: no contact");
        assert!(kind == 1 || hits < 12, "{name}: no free move");
        assert!(moves.iter().all(|it| it.truth.is_none() || it.near > 0));
    }
}

#[test]
fn our_core_and_the_truth_agree_on_drawn_moves() {
    let world = World::random(3, 12);
    let mut query = swept(&world.elements, &world.parts).unwrap();
    for test_move in &world.moves {
        let found = query(test_move);
        assert_eq!(found.is_some(), test_move.truth.is_some(), "{test_move:?}");
        let late = test_move
            .truth
            .zip(found)
            .map_or(0.0, |(truth, found)| found - truth);
        assert!(late <= ROUNDING_MM, "{test_move:?}");
    }
}

#[test]
fn the_smallest_world_is_judged_without_a_wrong_answer() {
    let expected = SmallWorldCounts {
        moves: 27 * 27 * 125,
        ..SmallWorldCounts::default()
    };
    assert_eq!(check_all(2).unwrap(), expected);
}

#[test]
fn a_plot_marks_wrong_methods_and_draws_zero_error() {
    let point = |name: &str, x: f64, y: f64, wrong: u64| Point {
        name: name.to_owned(),
        x,
        y,
        wrong,
        series: 0,
    };
    let plot = Scatter {
        title: "a < b".to_owned(),
        points: vec![point("fast", 1.0, 10.0, 3), point("exact", 2.0, 0.0, 0)],
        ..Scatter::default()
    };
    let svg = plot.svg();
    assert!(svg.contains("a &lt; b") && svg.contains("fast, 3 wrong") && svg.contains(">exact<"));
    assert!(svg.contains("cy=\"432.0\""), "{svg}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

/// Compares peer and truth on single pairs on a coarse grid, where touching is common.
#[test]
fn the_peer_disagrees_about_touches_alone() {
    let mut disagreements = 0;
    for code in 0..1_200_i64 {
        let digit = |place: u32, base: i64| code * 7_919 / 13_i64.pow(place) % base;
        let size = [1 + digit(0, 3), 1 + digit(1, 4), 1 + digit(2, 3)].map(|it| it * MM);
        let element = match code % 2 {
            0 => Body::block([0; 3], [2 * MM, 3 * MM, MM]),
            _ => Body::cylinder([0; 3], 3 * MM, 2 * MM),
        };
        let mover = match code % 3 {
            0 => Body::block([0; 3], size),
            _ => Body::cylinder([0; 3], size[0], size[2]),
        };
        let from = [digit(1, 13) - 6, digit(0, 13) - 6, digit(2, 9) - 4].map(|it| it * MM);
        let run = [digit(2, 25) - 12, digit(1, 25) - 12, digit(0, 5) - 2].map(|it| it * MM);
        let order = test_move(from, run);
        let truth = first_contact(&element, &mover.moved(from), run);
        let ours = swept(&[element], &[mover]).unwrap()(&order);
        assert_eq!(
            ours.is_some(),
            truth.is_some(),
            "{element:?} {mover:?} {order:?}"
        );
        let double = peer::double::Peer::new(&[element], &[mover]).first_contact(&order);
        let single = peer::single::Peer::new(&[element], &[mover]).first_contact(&order);
        for peer in [double, single] {
            if peer.is_some() != ours.is_some() {
                disagreements += 1;
                // A mover thinner by 1 um passes freely: the bodies only touch, and the peer reports no contact.
                let thin = first_contact(&element, &thinned(&mover.moved(from)), run);
                assert_eq!(
                    (peer, thin),
                    (None, None),
                    "{element:?} {mover:?} {order:?}"
                );
            }
        }
        if let (Some(peer), Some(ours)) = (double, ours) {
            let apart_mm = (peer - ours).abs() * order.length_mm();
            assert!(
                apart_mm < 0.01,
                "{apart_mm} mm: {element:?} {mover:?} {order:?}"
            );
        }
    }
    assert!(
        (1..120).contains(&disagreements),
        "{disagreements} of 2,400"
    );
}
