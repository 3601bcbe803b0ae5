//! The rig's state machine: every state with every command, and its drawing.

use crate::station::packml::{Command, On, State, TRANSITIONS, dot, next};
use std::collections::BTreeSet;

#[test]
fn the_outer_machine_is_the_drawing() {
    let drawn = include_str!("golden/packml.dot");
    assert_eq!(
        dot(),
        drawn,
        "the table has changed: look at the drawing and keep it"
    );
}

#[test]
fn each_of_seventeen_states_is_reachable_from_stopped() {
    let mut known = BTreeSet::from([State::Stopped]);
    for _ in State::ALL {
        for from in known.clone() {
            let commands = Command::ALL.iter().map(|command| On::Command(*command));
            known.extend(commands.chain([On::Done]).filter_map(|on| next(from, on)));
        }
    }
    assert_eq!((State::ALL.len(), known.len()), (17, 17));
}

#[test]
fn every_state_aborts_and_only_clear_ends_it() {
    for state in State::ALL {
        let aborted = matches!(state, State::Aborting | State::Aborted);
        let to = next(*state, On::Command(Command::Abort));
        assert_eq!(to, (!aborted).then_some(State::Aborting), "{state:?}");
    }
    let out: Vec<_> = Command::ALL
        .iter()
        .filter(|command| next(State::Aborted, On::Command(**command)).is_some())
        .collect();
    assert_eq!(out, [&Command::Clear]);
}

#[test]
fn a_reset_never_starts_anything() {
    for state in State::ALL {
        if let Some(to) = next(*state, On::Command(Command::Reset)) {
            assert_eq!(to, State::Resetting, "{state:?}");
        }
    }
    assert_eq!(next(State::Resetting, On::Done), Some(State::Idle));
    assert_eq!(next(State::Idle, On::Done), None);
}

#[test]
fn waiting_states_end_only_by_command() {
    for state in [
        State::Stopped,
        State::Idle,
        State::Held,
        State::Complete,
        State::Aborted,
    ] {
        assert_eq!(next(state, On::Done), None, "{state:?}");
    }
}

#[test]
fn no_row_of_the_table_occurs_twice() {
    for (n, row) in TRANSITIONS.iter().enumerate() {
        let same = TRANSITIONS[..n]
            .iter()
            .find(|other| other.from == row.from && other.on == row.on);
        assert_eq!(same, None);
    }
}
