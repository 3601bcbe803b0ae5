//! The clearance of a motion, computed before the motion.

use super::*;

const FAR_MM: f64 = 25.0;

/// Builds the same scene with `margin_mm` between all bodies that no rule names.
fn strict(margin_mm: f64) -> Result<Guard, GuardError> {
    let mut settings = scene_settings();
    settings.guard.default_margin_mm = margin_mm;
    Guard::build(&settings)
}

#[test]
fn the_clearance_is_the_margin_that_refuses_the_motion() {
    let extend = Motion::to(Actuator::Pusher, 60.0);
    let nowhere = Situation::at_rest(jzc_22f());
    let least_mm = guard().clearance_mm(&extend, &nowhere, FAR_MM).unwrap();
    assert!(
        (least_mm - 1.0).abs() < 1e-6,
        "the rail is 1 mm away: {least_mm}"
    );
    assert!(strict(least_mm - 0.01).is_ok());
    // Building the guard tries every stroke.
    let refused = strict(least_mm + 0.01).map(|_| ()).unwrap_err();
    assert!(refused.to_string().contains("pusher"), "{refused}");
}

#[test]
fn a_clearance_exceeds_the_margin_and_refusals_have_none() {
    let mut guard = guard();
    for actuator in Actuator::ALL {
        let (low, high) = guard.stroke_mm(actuator);
        let situation = rest().with(actuator, at(low));
        let least_mm = guard.clearance_mm(&Motion::to(actuator, high), &situation, FAR_MM);
        assert!(
            least_mm.is_none_or(|it| it > 0.5),
            "{actuator}: {least_mm:?}"
        );
    }
    let raised = rest().with(Actuator::ProbeLift, at(12.0));
    let pushed = raised.parts(|parts| parts.on_pusher = true);
    let extend = Motion::to(Actuator::Pusher, 60.0);
    assert!(guard.clear(&extend, &pushed).is_err());
    assert_eq!(guard.clearance_mm(&extend, &pushed, FAR_MM), None);
}

#[test]
fn beyond_the_range_there_is_no_clearance() {
    let mut guard = guard();
    let up = Motion::to(Actuator::SortZ, 0.0);
    assert_eq!(guard.clearance_mm(&up, &rest(), 0.01), None);
    assert!(guard.clearance_mm(&up, &rest(), FAR_MM).is_some());
}
