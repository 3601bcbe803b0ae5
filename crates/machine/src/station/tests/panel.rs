//! The buttons at the machine: one order per press, whatever the contact does.

use super::machine::{Machine, Specimen};
use crate::rig::point::DigitalIn;
use crate::station::catalogue::AlarmCode;
use crate::station::orders::Refused;
use crate::station::packml::{Command, State};
use crate::station::turn::Ending;
use units::Span;

type Pressed = Vec<(Command, Result<(), Refused>)>;

fn stopped() -> Machine {
    let mut machine = Machine::attended(None, vec![Specimen::MissingPin; 50]);
    turns(&mut machine, 2_000);
    hold(&mut machine, DigitalIn::ButtonStop, 100);
    for _ in 0..6_000 {
        if machine.station.outer() == State::Stopped {
            return machine;
        }
        machine.turn();
    }
    panic!("{:?} after stop", machine.station.outer());
}

fn turns(machine: &mut Machine, ms: u64) -> Pressed {
    let end = machine.mock.now + Span::ms(ms);
    let mut pressed = Vec::new();
    while machine.mock.now < end {
        pressed.extend(machine.turn().pressed);
    }
    pressed
}

/// Holds a button down for `ms`, then releases it until it settles.
fn hold(machine: &mut Machine, button: DigitalIn, ms: u64) -> Pressed {
    machine.mock.set(button, true);
    let mut pressed = turns(machine, ms);
    machine.mock.set(button, false);
    pressed.extend(turns(machine, 100));
    pressed
}

#[test]
fn stop_reset_and_start_are_orders_of_the_panel() {
    let mut machine = stopped();
    let refused = hold(&mut machine, DigitalIn::ButtonStart, 100);
    assert!(
        matches!(&refused[..], [(Command::Start, Err(_))]),
        "{refused:?}"
    );
    let reset = hold(&mut machine, DigitalIn::ButtonReset, 100);
    assert_eq!(reset, [(Command::Reset, Ok(()))]);
    while machine.station.outer() != State::Idle {
        machine.turn();
    }
    let start = hold(&mut machine, DigitalIn::ButtonStart, 100);
    assert_eq!(start, [(Command::Start, Ok(()))]);
    assert_eq!(machine.station.outer(), State::Execute);
}

#[test]
fn the_reset_button_clears_an_abort_without_cause() {
    let mut machine = Machine::attended(None, vec![Specimen::MissingPin; 50]);
    turns(&mut machine, 2_000);
    machine.mock.set(DigitalIn::DoorClosed, false);
    turns(&mut machine, 500);
    assert_eq!(machine.station.outer(), State::Aborted);
    let early = hold(&mut machine, DigitalIn::ButtonReset, 100);
    assert!(
        matches!(&early[..], [(Command::Clear, Err(_))]),
        "{early:?}"
    );
    machine.mock.set(DigitalIn::DoorClosed, true);
    turns(&mut machine, 100);
    let clear = hold(&mut machine, DigitalIn::ButtonReset, 100);
    assert_eq!(clear, [(Command::Clear, Ok(()))]);
}

#[test]
fn a_bouncing_contact_orders_once() {
    let mut machine = stopped();
    for down in [true, false, true, false] {
        machine.mock.set(DigitalIn::ButtonReset, down);
        assert!(turns(&mut machine, 12).is_empty(), "a twitch");
    }
    let pressed = hold(&mut machine, DigitalIn::ButtonReset, 400);
    assert_eq!(pressed.len(), 1, "{pressed:?}");
}

#[test]
fn a_held_button_orders_once_and_raises_an_alarm() {
    let mut machine = stopped();
    machine.mock.set(DigitalIn::ButtonStart, true);
    let pressed = turns(&mut machine, 6_000);
    assert_eq!(pressed.len(), 1, "{pressed:?}");
    let active = |machine: &Machine| {
        let listed = machine.station.annunciator().listed();
        let mut stuck = listed
            .iter()
            .filter(|one| one.alarm.code == AlarmCode::ButtonStuck);
        stuck.any(|one| one.is_active())
    };
    assert!(active(&machine));
    assert_eq!(machine.station.outer(), State::Stopped, "it stops nothing");
    machine.mock.set(DigitalIn::ButtonStart, false);
    turns(&mut machine, 100);
    assert!(!active(&machine));
}

#[test]
fn a_button_down_at_start_orders_nothing() {
    let mut machine = Machine::attended(None, vec![Specimen::MissingPin; 50]);
    machine.mock.set(DigitalIn::ButtonStop, true);
    assert!(turns(&mut machine, 1_000).is_empty());
    machine.mock.set(DigitalIn::ButtonStop, false);
    assert!(turns(&mut machine, 100).is_empty());
    assert_eq!(hold(&mut machine, DigitalIn::ButtonStop, 100).len(), 1);
}

#[test]
fn stop_and_start_at_once_is_stop() {
    let mut machine = stopped();
    machine.mock.set(DigitalIn::ButtonStart, true);
    let pressed = hold(&mut machine, DigitalIn::ButtonStop, 100);
    let commands: Vec<Command> = pressed.iter().map(|(command, _)| *command).collect();
    assert_eq!(commands, [Command::Stop]);
}

#[test]
fn the_stop_button_ends_an_unattended_run() {
    let mut machine = Machine::new(None, vec![Specimen::MissingPin; 50]);
    turns(&mut machine, 2_000);
    machine.mock.set(DigitalIn::ButtonStop, true);
    let ending = (0..6_000).find_map(|_| machine.turn().record.ending);
    assert_eq!(ending, Some(Ending::Stopped));
    assert!(machine.station.ledger().balances());
}
