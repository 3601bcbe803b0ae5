//! The guard gives the same answer however it is asked.

use super::*;

#[test]
fn a_remembered_answer_is_the_answer() {
    let mut guard = guard();
    let raised = rest()
        .with(Actuator::ProbeLift, at(12.0))
        .parts(|p| p.pocket = true);
    let motion = Motion::to(Actuator::Pusher, 60.0);
    let first = guard.clear(&motion, &raised).unwrap_err();
    assert!(guard.clear(&motion, &rest()).is_ok());
    assert_eq!(guard.clear(&motion, &raised).unwrap_err(), first);
}

#[test]
fn a_cleared_motion_is_the_one_that_was_asked_for() {
    let motion = clamp(8.0);
    let cleared = guard().clear(&motion, &rest()).unwrap();
    assert_eq!(*cleared.motion(), motion);
    let strokes: Vec<_> = cleared
        .motion()
        .strokes()
        .map(|s| (s.actuator.name(), s.to_mm))
        .collect();
    assert_eq!(strokes, [("jaw_left", 8.0), ("jaw_right", 8.0)]);
}

#[test]
fn back_tracking_goes_to_a_pose_that_is_clear() {
    let raised = rest()
        .with(Actuator::ProbeLift, at(12.0))
        .parts(|p| p.pocket = true);
    let mm = blocked(Motion::to(Actuator::Pusher, 60.0), &raised)
        .last_clear_mm
        .unwrap();
    passes(Motion::to(Actuator::Pusher, mm - 1e-6), &raised);
    blocked(Motion::to(Actuator::Pusher, mm + 1e-3), &raised);
}

#[test]
fn every_actuator_has_the_name_it_has_in_the_scene() {
    for actuator in Actuator::ALL {
        assert_eq!(Actuator::from_name(actuator.name()), Some(actuator));
    }
    assert_eq!(Actuator::from_name("clamp"), None);
}
