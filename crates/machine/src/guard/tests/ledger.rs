//! The guard gives the same answer to equal questions, and every pose that it offers is clear.

use super::*;

#[test]
fn a_remembered_answer_equals_the_first() {
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
fn clearing_returns_the_requested_motion() {
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
    passes(Motion::to(Actuator::Pusher, mm), &raised);
    blocked(Motion::to(Actuator::Pusher, mm + 0.011), &raised);
}

#[test]
fn the_guard_clears_what_a_refusal_offers() {
    let (mut offers, mut silent) = (0, 0);
    let mut guard = guard();
    for other in Actuator::ALL {
        let (low, high) = guard.stroke_mm(other);
        for position in [at(high), moving(low, high)] {
            let situation = rest()
                .with(other, position)
                .parts(|p| (p.pocket, p.nest) = (true, other == Actuator::Gripper));
            for actuator in Actuator::ALL.into_iter().filter(|it| *it != other) {
                let (_, end) = guard.stroke_mm(actuator);
                let Err(Refusal::Blocked(no)) = guard.clear(&Motion::to(actuator, end), &situation)
                else {
                    continue;
                };
                let Some(mm) = no.last_clear_mm else {
                    silent += 1;
                    continue;
                };
                offers += 1;
                assert!(mm > 0.0 && mm < end, "{no}");
                let offered = Motion::to(no.stroke.actuator, mm);
                guard.clear(&offered, &situation).unwrap();
                assert!(
                    no.to_string()
                        .contains(&format!("clear up to {mm:.2} mm; ")),
                    "{no}"
                );
            }
        }
    }
    assert!(offers >= 8, "{offers} offers, {silent} without");
}

#[test]
fn a_blocked_or_unknown_start_gets_no_offer() {
    let unknown = rest()
        .with(Actuator::Pusher, at(60.0))
        .with(Actuator::SortZ, moving(0.0, 40.0));
    let no = blocked(Motion::to(Actuator::SortZ, 40.0), &unknown);
    assert_eq!(no.last_clear_mm, None);
    assert!(!no.to_string().contains("clear up to"), "{no}");
}

#[test]
fn actuator_names_match_the_scene() {
    for actuator in Actuator::ALL {
        assert_eq!(Actuator::from_name(actuator.name()), Some(actuator));
    }
    assert_eq!(Actuator::from_name("clamp"), None);
}
