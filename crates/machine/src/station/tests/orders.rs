//! Orders from a screen: accepted or refused with a reason, and their effects.

use super::machine::{Machine, Specimen};
use crate::handling::serial::ScanRefused;
use crate::rig::bin::Bin;
use crate::rig::point::{DigitalIn, DigitalOut};
use crate::station::catalogue::{AlarmCode, ClearedBy, Reaction};
use crate::station::orders::{Order, Refused};
use crate::station::packml::{self, Command, Mode, NextStep, On, State};
use crate::station::trouble::Alarm;
use crate::station::turn::Ending;
use texts::{Lang, Message};

fn said(why: &crate::station::orders::Refused) -> String {
    why.message().say(Lang::En)
}

fn attended(parts: usize) -> Machine {
    Machine::attended(Some(parts as u64), vec![Specimen::MissingPin; parts])
}

fn until(machine: &mut Machine, state: State) {
    for _ in 0..6000 {
        if machine.station.outer() == state {
            return;
        }
        machine.turn();
    }
    let found = machine.station.outer();
    let list: Vec<_> = machine
        .station
        .annunciator()
        .listed()
        .iter()
        .map(|one| one.alarm.text(Lang::En))
        .collect();
    panic!("{found:?} instead of {state:?}: {list:?}");
}

fn testing(machine: &mut Machine) {
    for _ in 0..6000 {
        if machine.station.activity().stage().is_some() {
            return;
        }
        machine.turn();
    }
    panic!("no test began");
}

fn give(machine: &mut Machine, command: Command) {
    let answer = machine.order(Order::Command(command));
    assert_eq!(answer, Ok(()), "{command:?}");
}

/// Returns the alarm about a scanned part that an earlier run has left in the magazine.
fn dropped() -> Alarm {
    Alarm::scans_dropped(&[("S-1".into(), "li".into())])
}

#[test]
fn no_scan_counts_before_dropped_ones_are_acknowledged() {
    let mut machine = Machine::scanned();
    let earlier = machine.station.annunciator_mut();
    earlier.inherit(dropped(), 1, None);
    let refused = machine.order(Order::Scan("S-2".into())).unwrap_err();
    assert_eq!(refused, Refused::ScansDropped(Box::new(dropped())));
    assert!(said(&refused).contains("S-1 (li)"));
    let code = AlarmCode::ScansDropped.name();
    assert_eq!(machine.order(Order::Acknowledge(Some(code))), Ok(()));
    assert_eq!(machine.order(Order::Scan("S-2".into())), Ok(()));
}

#[test]
fn a_lot_goes_from_reset_to_complete() {
    let mut machine = attended(2);
    for state in [
        State::Resetting,
        State::Idle,
        State::Execute,
        State::Completing,
        State::Complete,
    ] {
        until(&mut machine, state);
    }
    assert_eq!(machine.landed.len(), 2);
}

#[test]
fn a_held_line_keeps_its_parts_and_goes_on() {
    let mut machine = attended(3);
    testing(&mut machine);
    give(&mut machine, Command::Hold);
    until(&mut machine, State::Held);
    let inside = machine.station.ledger().inside();
    assert!(inside > 0);
    for _ in 0..300 {
        assert!(machine.turn().rig.motions.is_empty(), "a held line moves");
    }
    give(&mut machine, Command::Unhold);
    until(&mut machine, State::Complete);
    assert_eq!(machine.landed.len(), 3);
}

#[test]
fn an_emergency_stop_sends_the_part_to_retest() {
    let mut machine = attended(3);
    testing(&mut machine);
    machine.mock.set(DigitalIn::EmergencyStopOk, false);
    let output = machine.turn();
    assert!(output.rig.safe && output.rig.motions.is_empty());
    until(&mut machine, State::Aborted);
    let early = machine.order(Order::Command(Command::Clear)).unwrap_err();
    assert_eq!(said(&early), "release the emergency stop first");
    machine.mock.set(DigitalIn::EmergencyStopOk, true);
    machine.turn();
    give(&mut machine, Command::Clear);
    until(&mut machine, State::Stopped);
    for _ in 0..50 {
        assert!(machine.turn().rig.motions.is_empty(), "clear moves nothing");
    }
    give(&mut machine, Command::Reset);
    until(&mut machine, State::Idle);
    assert_eq!(machine.landed.len(), 1, "the part inside was discharged");
    give(&mut machine, Command::Start);
    until(&mut machine, State::Complete);
    assert_eq!(machine.landed.len(), 3);
}

#[test]
fn a_stuck_part_goes_to_retest_with_one_row() {
    let mut machine = Machine::attended(Some(1), vec![Specimen::StuckNo]);
    while machine.station.ledger().fall().is_none() {
        machine.turn();
    }
    // The module of the fingers has tripped: they never open.
    machine.bus = Some(Alarm::bus(&Message::detail(
        "unread",
        "the module ignored the output",
    )));
    machine.turn();
    until(&mut machine, State::Aborted);
    give(&mut machine, Command::Clear);
    until(&mut machine, State::Stopped);
    give(&mut machine, Command::Reset);
    until(&mut machine, State::Idle);
    assert_eq!(machine.landed, [(1, Bin::RETEST)]);
    let turns = |what: &str| {
        machine
            .turns
            .iter()
            .filter(|it| it.output.contains(what))
            .count()
    };
    assert_eq!(turns("Interrupted { ordinal: 1"), 1, "its row is corrected");
    assert_eq!(turns("judged: [Judged"), 1, "it was judged once");
}

#[test]
fn every_refused_command_has_a_bilingual_reason() {
    let mut machine = attended(4);
    testing(&mut machine);
    for command in Command::ALL {
        match machine.station.may(*command) {
            Ok(()) => {}
            Err(why) => {
                assert_eq!(why.message().args().get("state"), Some("Execute"));
                assert_ne!(why.message().say(Lang::Zh), said(&why));
            }
        }
    }
}

#[test]
fn jogging_needs_the_mode_and_a_homed_machine() {
    let mut machine = attended(1);
    machine.turn();
    let jog = || Order::Jog(crate::handling::moves::Move::PusherExtend);
    let why = machine.order(jog()).unwrap_err();
    assert!(said(&why).contains("manual"), "{}", said(&why));
    give(&mut machine, Command::Stop);
    until(&mut machine, State::Stopped);
    assert_eq!(machine.order(Order::Mode(Mode::Manual)), Ok(()));
    let why = machine.order(jog()).unwrap_err();
    assert_eq!(said(&why), "reset first");
    give(&mut machine, Command::Reset);
    until(&mut machine, State::Idle);
    let why = machine.order(Order::Command(Command::Start)).unwrap_err();
    assert!(said(&why).contains("production"), "{}", said(&why));
    assert_eq!(machine.order(jog()), Ok(()));
}

#[test]
fn in_maintenance_every_motion_waits_for_a_step() {
    let mut machine = attended(1);
    until(&mut machine, State::Idle);
    give(&mut machine, Command::Stop);
    until(&mut machine, State::Stopped);
    assert_eq!(machine.order(Order::Mode(Mode::Maintenance)), Ok(()));
    give(&mut machine, Command::Reset);
    for _ in 0..6000 {
        if machine.station.outer() == State::Idle {
            break;
        }
        machine.turn();
        if machine.station.may_step().is_ok() {
            assert_eq!(machine.order(Order::Step), Ok(()));
        }
    }
    give(&mut machine, Command::Start);
    let mut steps = 0;
    for _ in 0..6000 {
        let before = machine.driven();
        machine.turn();
        assert_eq!(machine.driven(), before, "a motion without a step");
        if machine.station.may_step().is_ok() {
            assert_eq!(machine.order(Order::Step), Ok(()));
            assert_eq!(machine.driven(), before + 1);
            steps += 1;
        }
        if machine.station.outer() == State::Complete {
            break;
        }
    }
    assert_eq!(machine.landed.len(), 1);
    assert!(steps >= 13, "{steps}");
}

#[test]
fn a_lamp_test_lights_everything_and_ends() {
    let mut machine = Machine::between_lots();
    let answer = machine.order(Order::LampTest);
    assert_eq!(answer, Ok(()));
    let lit: Vec<_> = machine.last_outputs.iter().filter(|(_, on)| *on).collect();
    assert!(lit.iter().any(|(point, _)| *point == DigitalOut::LampRed));
    let mut dark = false;
    for _ in 0..800 {
        let output = machine.turn();
        dark |= output.rig.outputs.contains(&(DigitalOut::LampRed, false));
    }
    assert!(dark);
}

#[test]
fn a_miscount_holds_the_line_until_unhold() {
    let mut machine = attended(4);
    testing(&mut machine);
    machine.bus = Some(Alarm::beam(Bin::PASS, 0));
    machine.turn();
    until(&mut machine, State::Held);
    give(&mut machine, Command::Unhold);
    until(&mut machine, State::Complete);
}

#[test]
fn an_empty_magazine_suspends_the_line() {
    let mut machine = Machine::attended(Some(2), vec![Specimen::MissingPin]);
    until(&mut machine, State::Suspended);
    for _ in 0..500 {
        machine.turn();
    }
    assert_eq!(machine.station.outer(), State::Suspended);
    machine.fill(Specimen::OpenCoil);
    until(&mut machine, State::Complete);
    assert_eq!(machine.landed.len(), 2);
}

#[test]
fn between_lots_nothing_starts() {
    let mut machine = Machine::between_lots();
    for _ in 0..500 {
        assert!(machine.turn().rig.motions.is_empty(), "motion unordered");
    }
    assert_eq!(machine.station.outer(), State::Stopped);
    give(&mut machine, Command::Reset);
    until(&mut machine, State::Idle);
    for _ in 0..500 {
        machine.turn();
    }
    let why = machine.order(Order::Command(Command::Start)).unwrap_err();
    assert_eq!(said(&why), "choose a lot on the page Lots first");
    assert_eq!(machine.order(Order::Leave), Ok(()));
    assert_eq!(machine.ending, Some(Ending::Stopped));
}

#[test]
fn a_lot_is_left_only_at_rest() {
    let mut machine = attended(3);
    testing(&mut machine);
    let why = machine.order(Order::Leave).unwrap_err();
    assert_eq!(said(&why), "stop first");
    machine.mock.set(DigitalIn::DoorClosed, false);
    until(&mut machine, State::Aborted);
    machine.mock.set(DigitalIn::DoorClosed, true);
    let why = machine.order(Order::Leave).unwrap_err();
    assert_eq!(said(&why), "clear the alarm first");
    give(&mut machine, Command::Clear);
    until(&mut machine, State::Stopped);
    let why = machine.order(Order::Leave).unwrap_err();
    assert_eq!(said(&why), "reset first");
    give(&mut machine, Command::Reset);
    until(&mut machine, State::Idle);
    assert_eq!(machine.order(Order::Mode(Mode::Manual)), Ok(()));
    let why = machine.order(Order::Leave).unwrap_err();
    assert!(said(&why).contains("production"), "{}", said(&why));
    assert_eq!(machine.order(Order::Mode(Mode::Production)), Ok(()));
    assert_eq!(machine.ending, None);
    assert_eq!(machine.order(Order::Leave), Ok(()));
    assert_eq!(machine.ending, Some(Ending::Stopped));
}

#[test]
fn a_closed_lot_finishes_the_parts_inside() {
    let mut machine = attended(9);
    testing(&mut machine);
    assert_eq!(machine.order(Order::Close), Ok(()));
    until(&mut machine, State::Complete);
    assert_eq!(machine.ending, Some(Ending::Complete));
    let landed = machine.landed.len() as u64;
    assert!(landed < 9 && landed == machine.station.ledger().own_parts());
    assert_eq!(machine.station.ledger().inside(), 0);
}

#[test]
fn a_lot_closed_at_rest_completes_immediately() {
    let mut machine = attended(9);
    testing(&mut machine);
    give(&mut machine, Command::Stop);
    assert!(machine.order(Order::Close).is_err(), "parts are inside");
    until(&mut machine, State::Stopped);
    assert_eq!(machine.order(Order::Close), Ok(()));
    assert_eq!(machine.ending, Some(Ending::Complete));
}

#[test]
fn every_refusal_has_a_text_in_both_languages() {
    let every = [
        Refused::RunEnded,
        Refused::WrongState(Command::Start, State::Execute),
        Refused::WrongMode {
            order: "jog",
            found: Mode::Production,
            needed: Mode::Manual,
        },
        Refused::MovedByHand,
        Refused::NoLot,
        Refused::PartInside,
        Refused::NotAtRest(State::Execute),
        Refused::NotAtRest(State::Aborted),
        Refused::ModeLocked(State::Execute),
        Refused::Unhomed(State::Execute),
        Refused::StillMoving,
        Refused::NoMotionWaits,
        Refused::NothingMoves,
        Refused::CauseRemains(Box::new(AlarmCode::DoorOpen.into())),
        Refused::CauseRemains(Box::new(Alarm::bin_full(Bin::PASS))),
        Refused::NoSuchAlarm,
        Refused::Collision(Box::new(Message::detail("not_driven", "jaw left"))),
        Refused::Denied(Box::new(Message::new("refusal", "not_logged_in"))),
        Refused::StartWithoutLot,
        Refused::NotOfTheRig,
        Refused::ShelveWithoutReason,
        Refused::NotArrived,
        Refused::PromptOpen,
        Refused::NoPrompt,
        Refused::NoSuchChoice,
        Refused::Scan(ScanRefused::NotScanned),
        Refused::Scan(ScanRefused::Unreadable),
        Refused::Scan(ScanRefused::Repeated),
        Refused::Scan(ScanRefused::TooMany),
        Refused::ScansDropped(Box::new(dropped())),
    ];
    for refused in every {
        let [en, zh] = Lang::ALL.map(|lang| refused.message().say(lang));
        assert!(!en.contains('_') && !zh.contains('_'), "{en}; {zh}");
    }
}

#[test]
fn every_refused_command_names_one_next_step() {
    for state in State::ALL {
        for command in Command::ALL {
            if packml::next(*state, On::Command(*command)).is_some() {
                continue;
            }
            let next = packml::next_step(*command, *state);
            let leads = match next {
                NextStep::Clear => Some(Command::Clear),
                NextStep::Reset => Some(Command::Reset),
                NextStep::Start => Some(Command::Start),
                NextStep::Stop => Some(Command::Stop),
                NextStep::Unhold => Some(Command::Unhold),
                NextStep::Wait
                | NextStep::Already
                | NextStep::Resumes
                | NextStep::NothingToClear => None,
            };
            let is_allowed = |it| packml::next(*state, On::Command(it)).is_some();
            assert!(leads.is_none_or(is_allowed), "{command} in {state}: {next}");
        }
    }
}

#[test]
fn every_cause_that_must_go_has_a_next_step() {
    for code in AlarmCode::all() {
        let entry = code.entry();
        let blocks = entry.cleared_by == ClearedBy::Sensor
            && matches!(entry.reaction, Reaction::Abort | Reaction::Suspend);
        let said = Refused::CauseRemains(Box::new(code.into())).message();
        assert!(!blocks || said.say(Lang::Zh) != code.text_id(), "{code}");
    }
}
