//! The guard clears the normal cycle, stroke by stroke.

use super::*;
use Actuator::*;

#[test]
fn the_escapement_fills_the_pocket() {
    passes(Motion::to(Escapement, 16.0), &rest());
}

#[test]
fn the_escapement_goes_back_to_hold_behind_the_part() {
    let filled = rest().with(Escapement, at(16.0)).parts(|p| p.pocket = true);
    passes(Motion::to(Escapement, 0.0), &filled);
}

#[test]
fn the_pusher_brings_the_part_onto_the_nest() {
    passes(Motion::to(Pusher, 60.0), &rest().parts(|p| p.pocket = true));
}

#[test]
fn the_pusher_may_try_again_after_a_jam() {
    let jammed = rest()
        .with(Pusher, moving(0.0, 60.0))
        .parts(|p| p.on_pusher = true);
    passes(Motion::to(Pusher, 60.0), &jammed);
    passes(Motion::to(Pusher, 0.0), &jammed);
}

#[test]
fn the_pusher_retracts_from_the_part() {
    let there = rest().with(Pusher, at(60.0)).parts(|p| p.nest = true);
    passes(Motion::to(Pusher, 0.0), &there);
}

#[test]
fn the_jaws_close_while_the_pusher_retracts() {
    let leaving = rest()
        .with(Pusher, moving(0.0, 60.0))
        .parts(|p| p.nest = true);
    passes(clamp(8.0), &leaving);
}

#[test]
fn the_pusher_retracts_while_the_jaws_close() {
    let closing = rest()
        .with(Pusher, at(60.0))
        .with(JawLeft, moving(0.0, 8.0))
        .with(JawRight, moving(0.0, 8.0))
        .parts(|p| p.nest = true);
    passes(Motion::to(Pusher, 0.0), &closing);
}

#[test]
fn probes_rise_beside_a_pusher_that_left_its_sensor() {
    let leaving = |to_mm| {
        rest()
            .clamped()
            .with(Pusher, moving(0.0, to_mm))
            .parts(|p| p.nest = true)
    };
    passes(Motion::to(ProbeLift, 12.0), &leaving(57.0));
    let early = blocked(Motion::to(ProbeLift, 12.0), &leaving(60.0));
    assert_eq!(early.blocker, "pusher_keel");
    assert!(guard().probes_rise_beside_pusher(jzc_22f()));
    let mut settings = scene_settings();
    for actuator in &mut settings.actuator {
        actuator.sensor_off_mm = 0.0;
    }
    let mut unproven = Guard::build(&settings).unwrap();
    assert!(!unproven.probes_rise_beside_pusher(jzc_22f()));
}

#[test]
fn the_probes_rise_to_the_clamped_part() {
    passes(
        Motion::to(ProbeLift, 12.0),
        &rest().clamped().parts(|p| p.nest = true),
    );
}

/// The middle of a test: nest closed, probes up, pocket empty.
fn under_test() -> Situation {
    rest()
        .clamped()
        .with(ProbeLift, at(12.0))
        .parts(|p| p.nest = true)
}

#[test]
fn z_comes_down_while_the_pocket_fills() {
    let filling = under_test().with(Escapement, moving(0.0, 16.0));
    passes(Motion::to(SortZ, 40.0), &filling);
    passes(
        Motion::to(SortZ, 40.0),
        &under_test().parts(|p| p.pocket = true),
    );
}

#[test]
fn the_pocket_fills_while_z_comes_down() {
    passes(
        Motion::to(Escapement, 16.0),
        &under_test().with(SortZ, moving(0.0, 40.0)),
    );
}

#[test]
fn the_gripper_closes_while_the_probes_go_down() {
    let down = under_test().with(SortZ, at(40.0));
    passes(
        Motion::to(Gripper, 7.0),
        &down.with(ProbeLift, moving(0.0, 12.0)),
    );
    passes(
        Motion::to(ProbeLift, 0.0),
        &down.with(Gripper, moving(0.0, 7.0)),
    );
}

#[test]
fn the_jaws_open_with_the_fingers_down() {
    let gripped = rest()
        .clamped()
        .with(SortZ, at(40.0))
        .with(Gripper, at(7.0));
    passes(clamp(0.0), &gripped.parts(|p| p.nest = true));
    passes(clamp(0.0), &gripped.parts(|p| p.gripper = true));
}

#[test]
fn the_jaws_close_with_the_fingers_down() {
    passes(clamp(8.0), &rest().with(SortZ, at(40.0)));
    passes(
        clamp(8.0),
        &rest().with(SortZ, at(40.0)).parts(|p| p.nest = true),
    );
    passes(Motion::to(SortZ, 40.0), &rest().clamped());
    passes(
        Motion::to(SortZ, 0.0),
        &rest().clamped().with(SortZ, at(40.0)),
    );
}

#[test]
fn z_rises_with_the_part() {
    let held = rest().with(SortZ, at(40.0)).with(Gripper, at(7.0));
    passes(Motion::to(SortZ, 0.0), &held.parts(|p| p.gripper = true));
    passes(
        Motion::to(SortZ, 0.0),
        &held.parts(|p| (p.gripper, p.pocket) = (true, true)),
    );
    passes(Motion::to(SortZ, 0.0), &held.parts(|p| p.nest = true));
}

#[test]
fn the_axis_carries_the_part_to_every_bin() {
    for bin_mm in [75.0, 150.0, 190.0, 230.0, 270.0, 310.0, 350.0] {
        let held = rest().with(Gripper, at(7.0)).parts(|p| p.gripper = true);
        passes(Motion::to(SortAxis, bin_mm), &held);
        passes(Motion::to(Gripper, 0.0), &held.with(SortAxis, at(bin_mm)));
        passes(
            Motion::to(SortAxis, 0.0),
            &rest().with(SortAxis, at(bin_mm)),
        );
        passes(
            Motion::to(SortAxis, 75.0),
            &rest().with(SortAxis, at(bin_mm)),
        );
    }
}

#[test]
fn the_next_part_is_tested_while_the_last_travels() {
    let travelling = rest()
        .with(SortAxis, moving(0.0, 350.0))
        .with(Gripper, at(7.0))
        .parts(|p| (p.gripper, p.pocket) = (true, true));
    passes(Motion::to(Pusher, 60.0), &travelling);
    let next = travelling.parts(|p| (p.pocket, p.nest) = (false, true));
    passes(clamp(8.0), &next);
    passes(Motion::to(ProbeLift, 12.0), &next.clamped());
    passes(
        Motion::to(Escapement, 16.0),
        &next.clamped().with(ProbeLift, at(12.0)),
    );
}

#[test]
fn the_axis_comes_back_over_a_part_under_test() {
    passes(
        Motion::to(SortAxis, 0.0),
        &under_test().with(SortAxis, at(350.0)),
    );
}

#[test]
fn one_unknown_actuator_does_not_block_homing() {
    for actuator in Actuator::ALL {
        let mut lost = rest();
        lost.forget(actuator);
        passes(Motion::to(actuator, 0.0), &lost);
    }
}
