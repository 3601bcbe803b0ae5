//! A motion with an interlock needs its input, and no other motion does.

use super::*;

fn interlocked() -> Guard {
    guard().with_interlocks(vec![
        Interlock {
            actuators: &[Actuator::ProbeLift],
            end: End::Far,
            input: "covered".into(),
        },
        Interlock {
            actuators: &[Actuator::JawLeft, Actuator::JawRight],
            end: End::Rest,
            input: "socket_dead".into(),
        },
    ])
}

fn refused(guard: &mut Guard, motion: Motion, situation: &Situation) -> Option<String> {
    let refusal = guard.clear(&motion, situation).err()?;
    let Refusal::Interlock { input, .. } = &refusal else {
        panic!("refused for another reason: {refusal}");
    };
    Some(input.clone())
}

#[test]
fn a_motion_needs_the_input_of_its_interlock() {
    let mut guard = interlocked();
    let closed = rest().clamped();
    let mut other = closed;
    other.grant(0);
    let mut own = closed;
    own.grant(1);
    for (situation, input) in [
        (closed, Some("socket_dead")),
        (other, Some("socket_dead")),
        (own, None),
        (closed, Some("socket_dead")),
    ] {
        let found = refused(&mut guard, clamp(0.0), &situation);
        assert_eq!(found.as_deref(), input);
    }
}

#[test]
fn one_jaw_alone_needs_the_input_too() {
    let one = Motion::to(Actuator::JawRight, 0.0);
    let input = refused(&mut interlocked(), one, &rest().clamped());
    assert_eq!(input.as_deref(), Some("socket_dead"));
}

#[test]
fn other_motions_need_no_input() {
    let mut guard = interlocked();
    assert_eq!(refused(&mut guard, clamp(8.0), &rest()), None);
    let down = Motion::to(Actuator::ProbeLift, 0.0);
    let up = rest().with(Actuator::ProbeLift, at(12.0));
    assert_eq!(refused(&mut guard, down, &up), None);
    let rise = Motion::to(Actuator::ProbeLift, 12.0);
    let input = refused(&mut guard, rise, &rest());
    assert_eq!(input.as_deref(), Some("covered"));
}
