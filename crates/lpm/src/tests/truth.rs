//! Tests: compares answers with the exact truth, and the exact truth with results that are known otherwise.
use super::*;
use crate::exact::{Body, Form, first_contact};

/// How much earlier than the truth a move may stop, mm of the path; for a long path, 1e-10 of it instead.
const LOST_MM: f64 = 5e-8;
/// How much earlier than the truth a grazing move may stop, mm; for a long path, 1e-8 of it instead. Along a grazing
/// pass the distance changes with the square of the path, so a rounding of 2e-12 mm in the distance shifts the stop
/// this much.
const GRAZING_LOST_MM: f64 = 5e-5;

/// Returns the answer of the core for one pair.
pub(super) fn found(element: &Body, mover: &Body, run: [i64; 3], unit_mm: f64) -> Option<f64> {
    let model = standing(&element.shape(unit_mm), element.pose(unit_mm));
    let (from, to) = (mover.pose(unit_mm), mover.moved(run).pose(unit_mm));
    match model.first_contact(&mover.shape(unit_mm), &way(from, to)) {
        Answer::Clear => None,
        Answer::Blocked(contact) => Some(contact.t_stop),
    }
}

/// Asserts the same verdict as the exact truth, and a stop that is never late and hardly early.
pub(super) fn agrees(element: &Body, mover: &Body, run: [i64; 3], unit_mm: f64) {
    let truth = first_contact(element, mover, run);
    let found = found(element, mover, run, unit_mm);
    let said = || format!("{element:?} {mover:?} {run:?}: found {found:?}, truth {truth:?}");
    assert_eq!(found.is_some(), truth.is_some(), "{}", said());
    if let (Some(found), Some(truth)) = (found, truth) {
        // The time of the exact truth is itself rounded, by a few units in the last place.
        assert!(found <= truth * (1.0 + 1e-15), "late: {}", said());
        let length_mm = unit_mm
            * run
                .iter()
                .map(|it| (*it as f64).powi(2))
                .sum::<f64>()
                .sqrt();
        let lost_mm = (truth - found) * length_mm;
        let allowed_mm = if is_grazing(element, mover, run) {
            GRAZING_LOST_MM + 1e-8 * length_mm
        } else {
            LOST_MM + 1e-10 * length_mm
        };
        assert!(lost_mm <= allowed_mm, "early: {}", said());
    }
}

/// Returns true when the mover would pass if it were smaller by one unit; the contact is then (nearly) a double root.
fn is_grazing(element: &Body, mover: &Body, run: [i64; 3]) -> bool {
    let form = match mover.form {
        Form::Block { half, rotation } => Form::Block {
            half: half.map(|it| it - 1),
            rotation,
        },
        Form::Cylinder { radius, half } => Form::Cylinder {
            radius: radius - 1,
            half: half - 1,
        },
        Form::Triangle(_) => return true,
    };
    first_contact(element, &Body { form, ..*mover }, run).is_none()
}

#[test]
fn the_exact_truth_solves_a_3_4_5_triangle() {
    // A block has a corner at (10, 10); the centre of a disc of radius 5 passes (13, 14), or slightly beside it.
    let block = Body::block([0; 3], [10_000, 10_000, 5]);
    let disc = |x: i64, y: i64| Body::cylinder([x, y, 0], 5_000, 5);
    let still = [0; 3];
    assert_eq!(
        first_contact(&block, &disc(13_000, 14_000), still),
        Some(0.0)
    );
    assert_eq!(first_contact(&block, &disc(13_000, 14_001), still), None);
    assert_eq!(first_contact(&disc(13_001, 14_000), &block, still), None);
    // Along a tangent: contact halfway, at right angles to (3, 4).
    let from = disc(13_000 - 4_000, 14_000 + 3_000);
    let t = first_contact(&block, &from, [8_000, -6_000, 0]).unwrap();
    assert!((t - 0.5).abs() < 1e-15, "{t}");
    assert_eq!(
        first_contact(&block, &from.moved([0, 1, 0]), [8_000, -6_000, 0]),
        None
    );
}

#[test]
fn the_exact_truth_agrees_with_dense_sampling() {
    // In this coarse world, whose contacts lie at whole units, a thousand samples cannot miss one.
    let mut dice = crate::distance::tests::Dice::new(5);
    let mut met = 0;
    for _ in 0..3_000 {
        let mut whole = |most: u64| dice.pick(most) as i64;
        let element = match whole(3) {
            0 => Body::block([0; 3], [1 + whole(4), 1 + whole(4), 2]),
            1 => Body::cylinder([0; 3], 1 + whole(4), 2),
            _ => Body {
                centre: [0; 3],
                form: Form::Block {
                    half: [1 + whole(4), 1 + whole(4), 2],
                    rotation: [2, 0, 0, 1],
                },
            },
        };
        let start = [whole(25) - 12, whole(25) - 12, 0];
        let run = [whole(25) - 12, whole(25) - 12, 0];
        let radius = 1 + whole(3);
        let exact = first_contact(&element, &Body::cylinder(start, radius, 2), run);
        let distance = |t: f64| {
            flat_distance(
                &element,
                [0, 1].map(|axis| start[axis] as f64 + t * run[axis] as f64),
            )
        };
        let least = (0..=1_000)
            .map(|step| distance(f64::from(step) / 1_000.0))
            .fold(f64::INFINITY, f64::min);
        let reach = radius as f64;
        match exact {
            Some(t) => {
                met += 1;
                assert!(
                    distance(t) <= reach + 1e-9,
                    "{element:?} {start:?} {run:?} {radius}"
                );
                assert!(
                    t == 0.0 || distance(0.999 * t) > reach,
                    "{element:?} {start:?} {run:?} {radius}"
                );
            }
            None => assert!(least > reach, "{element:?} {start:?} {run:?} {radius}"),
        }
    }
    assert!((500..2_500).contains(&met), "{met}");
}

/// Returns the distance in the plane from an upright body at the origin to a point.
fn flat_distance(body: &Body, [x, y]: [f64; 2]) -> f64 {
    match body.form {
        Form::Cylinder { radius, .. } => (x.hypot(y) - radius as f64).max(0.0),
        Form::Block { half, rotation } => {
            let (w, z) = (rotation[0] as f64, rotation[3] as f64);
            let (cos, sin) = (
                (w * w - z * z) / (w * w + z * z),
                2.0 * w * z / (w * w + z * z),
            );
            let beyond = |place: f64, half: i64| (place.abs() - half as f64).max(0.0);
            beyond(cos * x + sin * y, half[0]).hypot(beyond(cos * y - sin * x, half[1]))
        }
        Form::Triangle(_) => f64::NAN,
    }
}
