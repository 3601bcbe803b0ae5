//! The guard refuses dangerous motions and tells a mechanic the remedy.

use super::*;
use Actuator::*;

#[test]
fn the_pusher_does_not_shear_pins_on_raised_probes() {
    let raised = rest().with(ProbeLift, at(12.0)).parts(|p| p.pocket = true);
    let no = blocked(Motion::to(Pusher, 60.0), &raised);
    assert!(no.blocker.starts_with("probe_"), "{no}");
    assert_eq!(no.would_help, "would help: lower the probes");
    assert!(
        no.last_clear_mm.is_some_and(|mm| mm > 10.0 && mm < 60.0),
        "{no}"
    );
    blocked(
        Motion::to(Pusher, 60.0),
        &raised.with(ProbeLift, moving(0.0, 12.0)),
    );
}

#[test]
fn the_pusher_avoids_raised_probes_even_without_a_part() {
    let no = blocked(Motion::to(Pusher, 60.0), &rest().with(ProbeLift, at(12.0)));
    assert_eq!(
        (no.mover.as_str(), no.blocker.as_str()),
        ("pusher_keel", "probe_housing")
    );
}

#[test]
fn the_probes_do_not_rise_under_an_unretracted_pusher() {
    for out in [at(60.0), moving(0.0, 60.0)] {
        let no = blocked(Motion::to(ProbeLift, 12.0), &rest().with(Pusher, out));
        assert_eq!(no.would_help, "would help: retract the pusher");
    }
}

#[test]
fn the_pusher_does_not_hit_a_lowered_gripper() {
    for down in [at(40.0), moving(0.0, 40.0)] {
        let no = blocked(Motion::to(Pusher, 60.0), &rest().with(SortZ, down));
        assert_eq!(no.blocker, "finger_rear");
        assert_eq!(no.would_help, "would help: raise sort z");
    }
}

#[test]
fn the_axis_does_not_leave_with_z_down() {
    for z in [at(40.0), at(5.0), moving(0.0, 40.0)] {
        for (from, to) in [
            (0.0, 75.0),
            (75.0, 0.0),
            (75.0, 150.0),
            (150.0, 350.0),
            (0.0, 350.0),
            (350.0, 310.0),
        ] {
            let no = blocked(
                Motion::to(SortAxis, to),
                &rest().with(SortZ, z).with(SortAxis, at(from)),
            );
            assert_eq!(no.would_help, "would help: raise sort z");
        }
    }
}

#[test]
fn z_does_not_come_down_onto_an_extended_pusher() {
    for out in [at(60.0), moving(0.0, 60.0)] {
        let no = blocked(Motion::to(SortZ, 40.0), &rest().with(Pusher, out));
        assert_eq!(no.blocker, "pusher_head");
        assert_eq!(no.would_help, "would help: retract the pusher");
    }
}

#[test]
fn z_comes_down_neither_on_bins_nor_during_travel() {
    for x in [at(150.0), at(230.0), at(350.0), moving(0.0, 350.0)] {
        blocked(Motion::to(SortZ, 40.0), &rest().with(SortAxis, x));
    }
}

#[test]
fn a_part_too_tall_for_z_is_not_gripped() {
    let mut tall = rest().parts(|p| p.nest = true);
    tall.part_size.body_mm[2] = 22.0;
    let no = blocked(Motion::to(SortZ, 40.0), &tall);
    assert_eq!(
        (no.mover.as_str(), no.blocker.as_str()),
        ("gripper_palm", "part_nest")
    );
    assert_eq!(no.would_help, "would help: take out the part in the nest");
}

#[test]
fn too_long_pins_do_not_pass_the_chutes() {
    let mut long = rest().with(Gripper, at(7.0)).parts(|p| p.gripper = true);
    long.part_size.pin_length_mm = 7.0;
    let no = blocked(Motion::to(SortAxis, 150.0), &long);
    assert_eq!(
        (no.mover.as_str(), no.blocker.as_str()),
        ("part_gripper", "chute_pass")
    );
}

#[test]
fn a_second_part_is_not_pushed_onto_the_nest() {
    let full = rest().parts(|p| (p.pocket, p.nest) = (true, true));
    let no = blocked(Motion::to(Pusher, 60.0), &full);
    assert_eq!(
        (no.mover.as_str(), no.blocker.as_str()),
        ("part_pusher", "part_nest")
    );
}

#[test]
fn a_second_part_is_not_let_into_the_pocket() {
    let no = blocked(
        Motion::to(Escapement, 16.0),
        &rest().parts(|p| p.pocket = true),
    );
    assert_eq!(
        (no.mover.as_str(), no.blocker.as_str()),
        ("part_feed", "part_pocket")
    );
}

#[test]
fn no_part_is_let_in_behind_an_extended_pusher() {
    blocked(Motion::to(Escapement, 16.0), &rest().with(Pusher, at(60.0)));
    blocked(
        Motion::to(Escapement, 16.0),
        &rest().with(Pusher, moving(0.0, 60.0)),
    );
}

#[test]
fn the_jaws_do_not_close_on_a_pushed_part() {
    let pushing = rest().with(Pusher, moving(0.0, 60.0));
    blocked(
        Motion::to(ProbeLift, 12.0),
        &pushing.parts(|p| p.on_pusher = true),
    );
    for pushed in [
        pushing.parts(|p| p.on_pusher = true),
        pushing.parts(|p| p.pocket = true),
    ] {
        let no = blocked(clamp(8.0), &pushed);
        assert_eq!(no.blocker, "part_pusher");
    }
}

#[test]
fn the_pusher_waits_until_the_escapement_holds_again() {
    let no = blocked(
        Motion::to(Pusher, 60.0),
        &rest().with(Escapement, at(16.0)).parts(|p| p.pocket = true),
    );
    assert_eq!(
        no.would_help,
        "would help: bring the escapement back to hold"
    );
}

#[test]
fn a_part_is_not_pushed_between_closed_jaws() {
    for jaw in [at(8.0), moving(0.0, 8.0)] {
        blocked(
            Motion::to(Pusher, 60.0),
            &rest().with(JawLeft, jaw).parts(|p| p.pocket = true),
        );
    }
}

#[test]
fn a_part_is_not_torn_out_of_closed_jaws() {
    let held = rest()
        .clamped()
        .with(SortZ, at(40.0))
        .with(Gripper, at(7.0));
    for held in [
        held.parts(|p| p.nest = true),
        held.parts(|p| p.gripper = true),
    ] {
        let no = blocked(Motion::to(SortZ, 0.0), &held);
        assert_eq!(no.mover, "part_gripper");
        assert!(no.blocker.starts_with("jaw_"), "{no}");
    }
}

#[test]
fn closed_fingers_do_not_come_down_on_a_part() {
    for closed in [at(7.0), moving(0.0, 7.0)] {
        let no = blocked(
            Motion::to(SortZ, 40.0),
            &rest().with(Gripper, closed).parts(|p| p.nest = true),
        );
        assert_eq!(no.would_help, "would help: open the gripper");
    }
}

#[test]
fn a_carried_part_is_not_set_down_on_another() {
    let two = rest()
        .with(Gripper, at(7.0))
        .parts(|p| (p.gripper, p.nest) = (true, true));
    let no = blocked(Motion::to(SortZ, 40.0), &two);
    assert_eq!(
        (no.mover.as_str(), no.blocker.as_str()),
        ("part_gripper", "part_nest")
    );
}

#[test]
fn a_part_too_long_is_not_pushed_in() {
    let mut long = rest().parts(|p| p.pocket = true);
    long.part_size.body_mm[0] = 24.0;
    assert_eq!(
        blocked(Motion::to(Pusher, 60.0), &long).blocker,
        "nest_stop"
    );
}

#[test]
fn both_fingers_stop_at_a_part_too_long() {
    let mut long = rest().with(SortZ, at(40.0)).parts(|p| p.nest = true);
    passes(Motion::to(Gripper, 7.0), &long);
    long.part_size.body_mm[0] = 25.5;
    assert_eq!(
        blocked(Motion::to(Gripper, 7.0), &long).mover,
        "finger_front"
    );
}

#[test]
fn motions_that_start_together_are_checked_mutually() {
    let stroke = |actuator, to_mm| Stroke { actuator, to_mm };
    for pair in [
        [stroke(Pusher, 60.0), stroke(SortZ, 40.0)],
        [stroke(Pusher, 60.0), stroke(ProbeLift, 12.0)],
    ] {
        for alone in pair {
            passes(Motion::group(&[alone]), &rest());
        }
        blocked(Motion::group(&pair), &rest());
    }
    // Both ends are clear, but the axis leaves before z is up.
    let down = rest().with(SortZ, at(40.0));
    blocked(
        Motion::group(&[stroke(SortZ, 0.0), stroke(SortAxis, 150.0)]),
        &down,
    );
}

#[test]
fn nan_and_positions_off_the_stroke_are_refused() {
    let off = |motion, situation: Situation| {
        let refusal = guard().clear(&motion, &situation).unwrap_err();
        assert!(matches!(refusal, Refusal::OutOfStroke { .. }), "{refusal}");
    };
    off(Motion::to(Pusher, f64::NAN), rest());
    off(Motion::to(Pusher, 60.1), rest());
    off(Motion::to(Pusher, 60.0), rest().with(SortZ, at(f64::NAN)));
    off(
        Motion::to(Pusher, 60.0),
        rest().with(SortAxis, moving(0.0, f64::INFINITY)),
    );
    off(
        Motion::to(Pusher, 60.0),
        rest().with(JawLeft, moving(f64::NAN, 8.0)),
    );
    let mut no_size = rest();
    no_size.part_size.body_mm[1] = f64::NAN;
    let refusal = guard()
        .clear(&Motion::to(Pusher, 60.0), &no_size)
        .unwrap_err();
    assert!(matches!(refusal, Refusal::PartSize { .. }));
}

#[test]
fn unknown_positions_clear_nothing_into_the_nest() {
    let lost = Situation::unknown(jzc_22f());
    for motion in [
        Motion::to(Pusher, 60.0),
        Motion::to(SortZ, 40.0),
        Motion::to(ProbeLift, 12.0),
    ] {
        blocked(motion, &lost);
    }
}

#[test]
fn a_refusal_reads_like_a_sentence() {
    let no = guard()
        .clear(&Motion::to(SortZ, 40.0), &rest().with(Pusher, at(60.0)))
        .unwrap_err();
    assert_eq!(
        no.to_string(),
        "sort z to 40.0 mm refused: finger rear would run into pusher head at x -20.0, y 0.0, z 14.0 mm, \
         86 % of the way; clear up to 34.49 mm; would help: retract the pusher"
    );
}
