//! Tests of the collision core.
#![allow(clippy::unwrap_used)]
use super::*;

mod built_pairs;
mod closed_meshes;
mod hard_cases;
mod mesh_files;
mod meshes_and_turns;
mod metamorphic;
mod properties;
mod published;
mod small_world;
mod truth;
mod turns;

fn block(x: f64, y: f64, z: f64) -> Shape {
    Shape::Block { half: [x, y, z] }
}

fn cylinder(radius: f64, height: f64) -> Shape {
    Shape::Cylinder { radius, height }
}

fn standing(shape: &Shape, pose: Pose) -> Model {
    let mut model = Model::new();
    model.insert("element", shape, &pose).unwrap();
    model
}

fn way(from: Pose, to: Pose) -> Move<'static> {
    Move {
        from,
        to,
        margin_mm: 0.0,
        ignore: &[],
    }
}

fn straight(from: [f64; 3], to: [f64; 3]) -> Move<'static> {
    way(Pose::at(from), Pose::at(to))
}

/// Returns the fraction of the first contact, `None` when clear; asserts that the questions agree.
fn stop(model: &Model, mover: &Shape, way: &Move) -> Option<f64> {
    let stop = match model.first_contact(mover, way) {
        Answer::Clear => None,
        Answer::Blocked(contact) => Some(contact.t_stop),
    };
    assert_eq!(
        stop.is_some(),
        model.any_hit(mover, way).is_some(),
        "{way:?}"
    );
    assert_eq!(
        stop.is_some(),
        !model.every_hit(mover, way).is_empty(),
        "{way:?}"
    );
    stop
}

fn least(model: &Model, mover: &Shape, way: &Move) -> f64 {
    model.clearance(mover, way, 1e6).unwrap().distance_mm
}

#[test]
fn invalid_numbers_block_without_naming_an_element() {
    let model = Model::new();
    let nan = straight([0.0; 3], [f64::NAN, 0.0, 0.0]);
    let Answer::Blocked(contact) = model.first_contact(&block(1.0, 1.0, 1.0), &nan) else {
        panic!("clear")
    };
    assert_eq!(contact.blocker, ElementKey::UNDECIDABLE);
    assert_eq!(model.id(contact.blocker), "(undecidable)");
    let negative = Move {
        margin_mm: -1.0,
        ..straight([0.0; 3], [1.0, 0.0, 0.0])
    };
    assert!(model.any_hit(&block(1.0, 1.0, 1.0), &negative).is_some());
    assert!(
        model
            .any_hit(
                &block(1.0, f64::INFINITY, 1.0),
                &straight([0.0; 3], [0.0; 3])
            )
            .is_some()
    );
    let zero = way(
        Pose {
            position: [0.0; 3],
            rotation: [0.0; 4],
        },
        Pose::IDENTITY,
    );
    assert!(model.any_hit(&block(1.0, 1.0, 1.0), &zero).is_some());
}

#[test]
fn a_removed_element_stops_blocking_and_keeps_its_key() {
    let mut model = Model::new();
    let plate = model
        .insert("plate", &block(500.0, 500.0, 5.0), &Pose::IDENTITY)
        .unwrap();
    let pin = model
        .insert("pin", &cylinder(4.0, 30.0), &Pose::at([50.0, 0.0, 25.0]))
        .unwrap();
    let pass = straight([-100.0, 0.0, 20.0], [100.0, 0.0, 20.0]);
    let mover = block(2.0, 2.0, 2.0);
    assert_eq!(model.any_hit(&mover, &pass), Some(pin));
    assert_eq!(
        model.any_hit(
            &mover,
            &Move {
                ignore: &[pin],
                ..pass
            }
        ),
        None
    );
    assert!(model.remove(pin) && !model.remove(pin));
    assert_eq!((model.any_hit(&mover, &pass), model.len()), (None, 1));
    let again = model
        .insert("other", &cylinder(4.0, 30.0), &Pose::at([50.0, 0.0, 25.0]))
        .unwrap();
    assert_ne!(again, pin);
    assert_eq!(
        (model.id(pin), model.id(again), model.id(plate)),
        ("(removed)", "other", "plate")
    );
    assert_eq!(model.any_hit(&mover, &pass), Some(again));
}

#[test]
fn a_distance_equal_to_the_margin_is_blocked() {
    let model = standing(&block(10.0, 10.0, 10.0), Pose::IDENTITY);
    let pass = |margin_mm| Move {
        margin_mm,
        ..straight([-50.0, 0.0, 15.5], [50.0, 0.0, 15.5])
    };
    assert!(stop(&model, &block(5.0, 5.0, 5.0), &pass(0.5)).is_some());
    assert_eq!(stop(&model, &block(5.0, 5.0, 5.0), &pass(0.499_999)), None);
}
