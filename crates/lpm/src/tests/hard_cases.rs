//! Tests: straight moves that are numerically hard: grazing, tiny tilts, foils, tangents.
use super::*;
use crate::distance::tests::Dice;

#[test]
fn a_move_of_length_zero_is_checked_in_place() {
    let model = standing(&block(1.0, 1.0, 1.0), Pose::IDENTITY);
    let still = |x| straight([x, 0.0, 0.0], [x, 0.0, 0.0]);
    assert_eq!(stop(&model, &block(1.0, 1.0, 1.0), &still(2.0)), Some(0.0));
    assert_eq!(stop(&model, &cylinder(1.0, 2.0), &still(1.0)), Some(0.0));
    assert_eq!(stop(&model, &cylinder(1.0, 2.0), &still(2.000_01)), None);
}

#[test]
fn leaving_a_contact_is_blocked_at_its_start() {
    let model = standing(&block(10.0, 10.0, 1.0), Pose::IDENTITY);
    let leave = straight([0.0, 0.0, 2.0], [0.0, 0.0, 30.0]);
    assert_eq!(stop(&model, &block(1.0, 1.0, 1.0), &leave), Some(0.0));
}

#[test]
fn a_ten_metre_move_does_not_tunnel_a_foil() {
    let foil = standing(&block(0.0005, 50.0, 50.0), Pose::at([5000.0, 0.0, 0.0]));
    let way = straight([0.0, 0.0, 0.0], [10_000.0, 3.0, 7.0]);
    let t = stop(&foil, &cylinder(0.5, 1.0), &way).unwrap();
    assert!((t - (5000.0 - 0.0005 - 0.5) / 10_000.0).abs() < 1e-9);
    let tilted = standing(
        &block(0.0005, 50.0, 50.0),
        Pose {
            position: [5000.0, 0.0, 0.0],
            rotation: [0.9, 0.1, 0.2, 0.3],
        },
    );
    assert!(stop(&tilted, &cylinder(0.5, 1.0), &way).is_some());
}

#[test]
fn published_missed_overlaps_at_the_start_are_blocked() {
    // A cylinder slides on another, 1 mm deep: a published case that a library missed.
    let model = standing(&cylinder(13.5625, 55.75), Pose::IDENTITY);
    let slide = straight([0.0, 0.0, 39.203125], [1.0, 0.5, 39.203125]);
    assert_eq!(
        stop(&model, &cylinder(26.90625, 24.65625), &slide),
        Some(0.0)
    );
    // Two cylinders on one axis, one inside the other, at rest.
    let rest = straight([0.0; 3], [0.0; 3]);
    assert_eq!(stop(&model, &cylinder(5.0, 10.0), &rest), Some(0.0));
    // A box goes down into another by 1 mm.
    let base = standing(&block(20.0, 20.0, 10.0), Pose::IDENTITY);
    let down = straight([0.0, 0.0, 30.0], [0.0, 0.0, 19.0]);
    let t = stop(&base, &block(5.0, 5.0, 10.0), &down).unwrap();
    assert!((t - 10.0 / 11.0).abs() < 1e-12);
}

#[test]
fn grazing_passes_and_contacts_differ_by_ten_nanometres() {
    for offset in [0.0, 1e3, 1e5, 9.9e5] {
        for gap in [1e-3, 1e-4, 1e-5] {
            let model = standing(&block(10.0, 10.0, 10.0), Pose::at([offset, offset, 0.0]));
            let pass = |height: f64| {
                straight(
                    [offset - 900.0, offset, height],
                    [offset + 900.0, offset + 3.0, height],
                )
            };
            let mover = cylinder(4.0, 6.0);
            assert_eq!(
                stop(&model, &mover, &pass(13.0 + gap)),
                None,
                "{offset} {gap}"
            );
            assert!(stop(&model, &mover, &pass(13.0)).is_some());
            let clearance = least(&model, &mover, &pass(13.0 + gap));
            assert!(
                (clearance - gap).abs() < 5e-8 + 1e-15 * offset,
                "{clearance} {gap} {offset}"
            );
        }
    }
}

#[test]
fn near_parallel_edges_are_never_separated_by_noise() {
    for exponent in 4..=14 {
        let angle = 10f64.powi(-exponent);
        let lower = standing(&block(100.0, 5.0, 5.0), Pose::IDENTITY);
        let rotation = [1.0, 0.0, 0.5 * angle, 0.5 * angle];
        let at = |height: f64| Pose {
            position: [0.0, 0.0, height],
            rotation,
        };
        let still = |height: f64| way(at(height), at(height));
        // The upper bar dips by about 100 mm times the angle.
        let dip = 100.0 * angle;
        assert!(
            stop(&lower, &block(100.0, 5.0, 5.0), &still(10.0 + 0.9 * dip)).is_some(),
            "{angle}"
        );
        assert!(
            stop(
                &lower,
                &block(100.0, 5.0, 5.0),
                &still(10.0 + 1.1 * dip + 1e-5)
            )
            .is_none(),
            "{angle}"
        );
    }
}

#[test]
fn a_tilt_of_a_picoradian_changes_nothing() {
    let model = standing(&block(30.0, 30.0, 10.0), Pose::IDENTITY);
    let rotation = [1.0, 0.5e-12, 0.3e-12, 0.0];
    for mover in [cylinder(8.0, 20.0), block(8.0, 4.0, 10.0)] {
        let slide = |height: f64| {
            let at = |x: f64| Pose {
                position: [x, 0.0, height],
                rotation,
            };
            way(at(-100.0), at(100.0))
        };
        assert!(stop(&model, &mover, &slide(20.0)).is_some());
        assert_eq!(stop(&model, &mover, &slide(20.000_001_1)), None);
    }
}

#[test]
fn crossed_and_tangent_cylinders_touch_where_their_mantles_do() {
    let lying = [
        std::f64::consts::FRAC_1_SQRT_2,
        std::f64::consts::FRAC_1_SQRT_2,
        0.0,
        0.0,
    ];
    let model = standing(
        &cylinder(7.0, 80.0),
        Pose {
            position: [0.0; 3],
            rotation: lying,
        },
    );
    let across = |gap: f64| {
        let rotation = [0.5, 0.5, 0.5, 0.5];
        let at = |z: f64| Pose {
            position: [0.0, 0.0, z],
            rotation,
        };
        way(at(50.0), at(12.0 + gap))
    };
    assert!(stop(&model, &cylinder(5.0, 60.0), &across(0.0)).is_some());
    assert_eq!(stop(&model, &cylinder(5.0, 60.0), &across(1e-6)), None);
    let upright = standing(&cylinder(7.0, 80.0), Pose::IDENTITY);
    let tangent = |y: f64| straight([-500.0, y, 0.0], [500.0, y, 0.0]);
    assert!(stop(&upright, &cylinder(5.0, 60.0), &tangent(12.0)).is_some());
    assert_eq!(
        stop(&upright, &cylinder(5.0, 60.0), &tangent(12.000_001)),
        None
    );
}

#[test]
fn a_rim_stops_on_a_corner() {
    // The corner of the block lies at 45 degrees; the rim touches it at distance r.
    let model = standing(&block(10.0, 10.0, 10.0), Pose::IDENTITY);
    let mover = cylinder(5.0, 10.0);
    let slide = straight([40.0, 40.0, 15.0], [0.0, 0.0, 15.0]);
    let t = stop(&model, &mover, &slide).unwrap();
    let truth = 1.0 - (10.0 + 5.0 / 2f64.sqrt()) / 40.0;
    assert!(t <= truth && truth - t < 1e-12, "{t} {truth}");
}

#[test]
fn a_graze_in_one_point_stops_within_a_nanometre() {
    let pin = standing(&cylinder(30.0, 20.0), Pose::at([1000.0, 500.0, 0.0]));
    // The path (4, 3) touches a disc of 50 + 30 at 80 mm from its centre: (-48, 64).
    let across = straight([-3048.0, -2436.0, 0.0], [4952.0, 3564.0, 0.0]);
    let cases = [
        (across, cylinder(50.0, 10.0), 0.5),
        // A path along the mantle of the cylinder; and one past a block whose side ends where the mantle touches it.
        (
            straight([1080.0, -500.0, 0.0], [1080.0, 1500.0, 0.0]),
            cylinder(50.0, 10.0),
            0.5,
        ),
        (
            straight([1080.0, -500.0, 0.0], [1080.0, 1500.0, 0.0]),
            block(50.0, 40.0, 5.0),
            0.48,
        ),
    ];
    for (way, mover, touched) in cases {
        let length = (0..3).map(|axis| way.to.position[axis] - way.from.position[axis]);
        let length = length.map(|run| run * run).sum::<f64>().sqrt();
        let early = (touched - stop(&pin, &mover, &way).unwrap()) * length;
        assert!((0.0..1e-6).contains(&early), "{early:e} mm early");
    }
}

/// How early a move may stop at a round side that it only grazes, where places were rounded, mm, within a metre: the
/// root of twice the radius times the rounding.
const GRAZED_EARLY_MM: f64 = 1e-4;

#[test]
fn a_graze_of_turned_bodies_stops_within_its_bound() {
    // A turn by the 3-4-5 triangle takes [5k, 0] to [3k, 4k]; a cylinder then passes along x at exactly the
    // distance at which it touches, or reaches its margin, above that place.
    let turned = Pose {
        position: [0.0; 3],
        rotation: [2.0, 0.0, 0.0, 1.0],
    };
    let mut dice = Dice::new(77);
    let mut earliest = 0.0_f64;
    for _ in 0..400 {
        let mut whole = |most: u64| 1.0 + dice.pick(most) as f64;
        let (k, radius, own) = (whole(200), whole(30), whole(30));
        let (margin_mm, length) = (whole(8) / 4.0 - 0.25, 100.0 + whole(900));
        let arm = Shape::Compound(vec![(
            Pose::at([5.0 * k, 0.0, 0.0]),
            cylinder(radius, 20.0),
        )]);
        let model = standing(&arm, turned);
        let beside = 4.0 * k + radius + own + margin_mm;
        let from = [3.0 * k - length / 2.0, beside, 0.0];
        let order = Move {
            margin_mm,
            ..straight(from, [from[0] + length, beside, 0.0])
        };
        let early = (0.5 - stop(&model, &cylinder(own, 10.0), &order).unwrap()) * length;
        assert!(
            (0.0..=GRAZED_EARLY_MM).contains(&early),
            "{early} mm early: k {k}, radii {radius} {own}, margin {margin_mm}"
        );
        earliest = earliest.max(early);
    }
    // The bound is not far too wide: the earliest stop comes within a factor of 100 of the bound.
    assert!(earliest > GRAZED_EARLY_MM / 100.0, "{earliest}");
}

#[test]
fn margins_and_ranges_may_exceed_single_precision() {
    let model = standing(&block(1.0, 1.0, 1.0), Pose::IDENTITY);
    let mover = block(1.0, 1.0, 1.0);
    for to in [[500.0, 0.0, 0.0], [500.0, 300.0, -40.0], [900.0, 1.0, 2.0]] {
        let order = Move {
            margin_mm: 1e300,
            ..straight([500.0, 0.0, 0.0], to)
        };
        assert_eq!(stop(&model, &mover, &order), Some(0.0));
        let least = model.clearance(&mover, &straight([500.0, 0.0, 0.0], to), 1e300);
        assert!((least.unwrap().distance_mm - 498.0).abs() < 1e-9);
    }
}
