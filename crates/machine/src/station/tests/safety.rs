//! Trouble makes the outputs safe, ends the run and voids the part inside.

use super::machine::{Machine, Specimen};
use crate::dut::{Reason, Verdict};
use crate::rig::bin::Bin;
use crate::rig::point::{DigitalIn, DigitalOut};
use crate::station::Activity;
use crate::station::trouble::Alarm;
use crate::station::turn::{Ending, TurnOutput};
use texts::{Lang, Message};
use units::Span;

fn under_test() -> Machine {
    let mut machine = Machine::new(Some(3), vec![Specimen::MissingPin; 3]);
    for _ in 0..3000 {
        machine.turn();
        if machine.station.activity().stage().is_some() {
            return machine;
        }
    }
    panic!("no test began: {:?}", machine.station.activity());
}

fn assert_safe(output: &TurnOutput, code: &str) {
    assert!(output.rig.safe, "{code}");
    assert!(
        output.rig.motions.is_empty() && output.rig.job.is_none(),
        "{code}"
    );
    assert!(output.rig.outputs.contains(&(DigitalOut::LampRed, true)));
    assert_eq!(output.record.ending, Some(Ending::Alarm));
    assert_eq!(output.record.alarms[0].code.name(), code);
}

#[test]
fn an_open_safety_input_voids_the_part_inside() {
    for (point, code) in [
        (DigitalIn::EmergencyStopOk, "emergency_stop"),
        (DigitalIn::DoorClosed, "door_open"),
        (DigitalIn::AirOk, "air_lost"),
    ] {
        let mut machine = under_test();
        machine.mock.set(point, false);
        let output = machine.turn();
        assert_safe(&output, code);
        let judged = &output.record.parts.judged[0];
        let why = Verdict::Void(vec![Reason::interrupted(code)]);
        assert_eq!(
            (&judged.verdict, judged.part.bin),
            (&why, Some(Bin::RETEST))
        );
        assert!(machine.station.ledger().balances());
        assert_eq!(machine.station.activity(), Activity::Ended);
    }
}

#[test]
fn after_the_end_the_station_commands_nothing() {
    let mut machine = under_test();
    machine.mock.set(DigitalIn::EmergencyStopOk, false);
    machine.turn();
    machine.mock.set(DigitalIn::EmergencyStopOk, true);
    for _ in 0..20 {
        let output = format!("{:?}", machine.turn());
        assert_eq!(output, format!("{:?}", TurnOutput::default()));
    }
}

#[test]
fn line_trouble_ends_the_run() {
    let mut machine = under_test();
    machine.bus = Some(Alarm::bus(&Message::detail(
        "unread",
        "line motion is silent",
    )));
    let output = machine.turn();
    assert_safe(&output, "bus_trouble");
    assert_eq!(output.record.parts.judged.len(), 1);
}

#[test]
fn a_part_falling_at_the_end_is_reported() {
    let mut machine = Machine::new(Some(2), vec![Specimen::StuckNo; 2]);
    while machine.station.ledger().fall().is_none() {
        machine.turn();
    }
    machine.bus = Some(Alarm::bus(&Message::detail(
        "unread",
        "line motion is silent",
    )));
    let output = machine.turn();
    let codes: Vec<String> = output
        .record
        .alarms
        .iter()
        .map(|it| it.code.name())
        .collect();
    assert_eq!(codes, ["bus_trouble", "bin_beam"]);
    assert!(
        output.record.alarms[1].text(Lang::En).contains("contact"),
        "{output:?}"
    );
    assert!(output.record.alarms_changed && output.record.ending == Some(Ending::Alarm));
    let ledger = machine.station.ledger();
    assert!(ledger.balances() && ledger.lost == 1);
}

#[test]
fn a_refused_motion_makes_everything_safe() {
    let mut machine = under_test();
    let mut output = TurnOutput::default();
    let movement = crate::handling::moves::Move::PusherExtend;
    let now = machine.mock.now;
    machine.station.refused(
        movement,
        &Message::detail("not_driven", "probes are up"),
        now,
        &mut output,
    );
    assert_safe(&output, "motion_refused");
    assert!(
        output.record.alarms[0]
            .text(Lang::En)
            .contains("probes are up")
    );
}

#[test]
fn safety_inputs_that_are_no_longer_read_are_trouble() {
    let mut machine = Machine::new(None, vec![Specimen::MissingPin; 50]);
    let start = machine.mock.now;
    while machine.mock.now.since(start) < Span::ms(3100) {
        machine.turn();
    }
    machine.mock.now = machine.mock.now + machine.mock.wiring.emergency_stop_max_age();
    assert!(machine.turn_without_scan().record.alarms.is_empty());
    machine.mock.now = machine.mock.now + Span(1);
    let output = machine.turn_without_scan();
    assert_safe(&output, "sensor_stale");
    let stale = output.record.alarms[0].text(Lang::En);
    assert!(stale.contains("Emergency-stop chain"), "{stale}");
}

#[test]
fn a_late_computer_explains_an_unread_input() {
    let mut machine = Machine::new(None, vec![Specimen::MissingPin]);
    for _ in 0..40 {
        machine.turn();
    }
    machine.mock.now = machine.mock.now + Span::ms(973);
    machine.host_late = Some(Span::ms(560));
    let output = machine.turn_without_scan();
    assert_safe(&output, "host_late");
    let late = output.record.alarms[0].text(Lang::En);
    assert!(
        late.contains("560 ms") && late.contains("Emergency-stop chain"),
        "{late}"
    );
}

#[test]
fn the_station_waits_briefly_for_the_first_scan() {
    let mut machine = Machine::new(Some(1), Vec::new());
    machine.mock = super::MockRig::unread();
    let output = machine.turn_without_scan();
    assert!(
        output.rig.motions.is_empty()
            && output.rig.job.is_none()
            && output.record.alarms.is_empty()
    );
    assert_eq!(machine.station.activity(), Activity::WaitingForSensors);
    machine.mock.now = machine.mock.now + Span::ms(3000);
    assert!(machine.turn_without_scan().record.alarms.is_empty());
    machine.mock.now = machine.mock.now + Span(1);
    assert_safe(&machine.turn_without_scan(), "sensor_stale");
}

#[test]
fn a_sticking_actuator_ends_the_run_by_name() {
    let mut machine = Machine::new(Some(1), vec![Specimen::MissingPin]);
    machine.sticking = Some("pusher");
    let ended = machine.run();
    assert_safe(&ended, "pusher_not_reached");
    assert!(
        ended.record.parts.judged.is_empty(),
        "no part was in the nest"
    );
}

#[test]
fn an_empty_magazine_ends_the_run_after_a_minute() {
    let mut machine = Machine::new(Some(2), vec![Specimen::MissingPin]);
    let mut codes = Vec::new();
    let start = machine.mock.now;
    let ending = loop {
        let output = machine.turn();
        codes.extend(output.record.alarms.iter().map(|alarm| alarm.code.name()));
        if let Some(ending) = output.record.ending {
            break ending;
        }
        assert!(machine.mock.now.since(start) < Span::ms(120_000));
    };
    assert_eq!(
        (ending, codes.last().map(String::as_str)),
        (Ending::Alarm, Some("magazine_empty"))
    );
    assert_eq!(machine.station.ledger().came_in, 1);
}

/// Codes of the alarms that begin while `machine` runs for `ms`.
fn new_alarms(machine: &mut Machine, ms: u64) -> Vec<String> {
    let end = machine.mock.now + Span::ms(ms);
    let mut codes = Vec::new();
    while machine.mock.now < end {
        codes.extend(
            machine
                .turn()
                .record
                .alarms
                .into_iter()
                .map(|alarm| alarm.code.name()),
        );
    }
    codes
}

#[test]
fn venting_by_emergency_stop_raises_one_alarm() {
    let mut machine = Machine::attended(None, vec![Specimen::MissingPin; 50]);
    new_alarms(&mut machine, 2_000);
    machine.mock.set(DigitalIn::EmergencyStopOk, false);
    machine.mock.set(DigitalIn::AirOk, false);
    assert_eq!(new_alarms(&mut machine, 5_000), ["emergency_stop"]);
    machine.mock.set(DigitalIn::EmergencyStopOk, true);
    assert!(
        new_alarms(&mut machine, 1_500).is_empty(),
        "pressure comes back"
    );
    machine.mock.set(DigitalIn::AirOk, true);
    assert!(new_alarms(&mut machine, 5_000).is_empty());
}

#[test]
fn missing_air_after_an_emergency_stop_is_reported() {
    let mut machine = Machine::attended(None, vec![Specimen::MissingPin; 50]);
    new_alarms(&mut machine, 2_000);
    machine.mock.set(DigitalIn::EmergencyStopOk, false);
    machine.mock.set(DigitalIn::AirOk, false);
    new_alarms(&mut machine, 1_000);
    machine.mock.set(DigitalIn::EmergencyStopOk, true);
    assert_eq!(new_alarms(&mut machine, 3_000), ["air_lost"]);
}

#[test]
fn a_late_database_alarms_but_stops_nothing() {
    let mut machine = under_test();
    machine.fleet = vec![Alarm::fleet_late("postgres://db/relayrig", 60)];
    let output = machine.turn();
    assert_eq!(output.record.alarms, machine.fleet);
    assert!(!output.rig.safe);
    assert!(machine.turn().record.alarms.is_empty(), "it is one alarm");
    machine.fleet.clear();
    assert!(machine.turn().record.alarms_changed, "it has returned");
    assert_eq!(machine.run().record.ending, Some(Ending::Complete));
}
