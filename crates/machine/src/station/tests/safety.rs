//! Trouble makes the outputs safe, ends the run and voids the part inside.

use super::machine::{Machine, Specimen};
use crate::dut::{Reason, Verdict};
use crate::rig::bin::Bin;
use crate::rig::point::{DigitalIn, DigitalOut};
use crate::station::Doing;
use crate::station::trouble::Alarm;
use crate::station::wants::{Ending, Wants};
use texts::Lang;
use units::Span;

/// Runs until the nest holds a part under test.
fn under_test() -> Machine {
    let mut machine = Machine::new(Some(3), vec![Specimen::MissingPin; 3]);
    for _ in 0..3000 {
        machine.turn();
        if machine.station.doing().stage().is_some() {
            return machine;
        }
    }
    panic!("no test began: {:?}", machine.station.doing());
}

fn assert_safe(wants: &Wants, code: &str) {
    assert!(wants.rig.safe, "{code}");
    assert!(
        wants.rig.motions.is_empty() && wants.rig.job.is_none(),
        "{code}"
    );
    assert!(wants.rig.outputs.contains(&(DigitalOut::LampRed, true)));
    assert_eq!(wants.record.ending, Some(Ending::Alarm));
    assert_eq!(wants.record.alarms[0].code.name(), code);
}

#[test]
fn an_open_safety_input_voids_the_part_inside() {
    for (point, code) in [
        (DigitalIn::EmergencyStopOk, "emergency_stop"),
        (DigitalIn::DoorClosed, "door_open"),
        (DigitalIn::AirOk, "air_lost"),
    ] {
        let mut machine = under_test();
        machine.shop.set(point, false);
        let wants = machine.turn();
        assert_safe(&wants, code);
        let judged = &wants.record.parts.judged[0];
        let why = Verdict::Void(vec![Reason::interrupted(code)]);
        assert_eq!(
            (&judged.verdict, judged.part.bin),
            (&why, Some(Bin::RETEST))
        );
        assert!(machine.station.ledger().balances());
        assert_eq!(machine.station.doing(), Doing::Ended);
    }
}

#[test]
fn after_the_end_the_station_commands_nothing() {
    let mut machine = under_test();
    machine.shop.set(DigitalIn::EmergencyStopOk, false);
    machine.turn();
    machine.shop.set(DigitalIn::EmergencyStopOk, true);
    for _ in 0..20 {
        let wants = format!("{:?}", machine.turn());
        assert_eq!(wants, format!("{:?}", Wants::default()));
    }
}

#[test]
fn line_trouble_ends_the_run() {
    let mut machine = under_test();
    machine.bus = Some(Alarm::bus("line motion is silent"));
    let wants = machine.turn();
    assert_safe(&wants, "bus_trouble");
    assert_eq!(wants.record.parts.judged.len(), 1);
}

#[test]
fn a_part_falling_at_the_end_is_reported() {
    let mut machine = Machine::new(Some(2), vec![Specimen::StuckNo; 2]);
    while machine.station.ledger().fall().is_none() {
        machine.turn();
    }
    machine.bus = Some(Alarm::bus("line motion is silent"));
    let wants = machine.turn();
    let codes: Vec<String> = wants
        .record
        .alarms
        .iter()
        .map(|it| it.code.name())
        .collect();
    assert_eq!(codes, ["bus_trouble", "bin_beam"]);
    assert!(
        wants.record.alarms[1].text(Lang::En).contains("contact"),
        "{wants:?}"
    );
    assert!(wants.record.alarms_changed && wants.record.ending == Some(Ending::Alarm));
    let ledger = machine.station.ledger();
    assert!(ledger.balances() && ledger.lost == 1);
}

#[test]
fn a_refused_motion_makes_everything_safe() {
    let mut machine = under_test();
    let mut wants = Wants::default();
    let movement = crate::handling::moves::Move::PusherExtend;
    let now = machine.shop.now;
    machine
        .station
        .refused(movement, "probes are up", now, &mut wants);
    assert_safe(&wants, "motion_refused");
    assert!(
        wants.record.alarms[0]
            .text(Lang::En)
            .contains("probes are up")
    );
}

#[test]
fn safety_inputs_that_are_no_longer_read_are_trouble() {
    let mut machine = Machine::new(None, vec![Specimen::MissingPin; 50]);
    let start = machine.shop.now;
    while machine.shop.now.since(start) < Span::ms(3100) {
        machine.turn();
    }
    machine.shop.now = machine.shop.now + machine.shop.wiring.emergency_stop_max_age();
    assert!(machine.turn_without_scan().record.alarms.is_empty());
    machine.shop.now = machine.shop.now + Span(1);
    let wants = machine.turn_without_scan();
    assert_safe(&wants, "sensor_stale");
    let stale = wants.record.alarms[0].text(Lang::En);
    assert!(stale.contains("emergency_stop_ok"), "{stale}");
}

#[test]
fn the_station_waits_briefly_for_the_first_scan() {
    let mut machine = Machine::new(Some(1), Vec::new());
    machine.shop = super::Shop::unread();
    let wants = machine.turn_without_scan();
    assert!(
        wants.rig.motions.is_empty() && wants.rig.job.is_none() && wants.record.alarms.is_empty()
    );
    assert_eq!(machine.station.doing(), Doing::WaitingForSensors);
    machine.shop.now = machine.shop.now + Span::ms(3000);
    assert!(machine.turn_without_scan().record.alarms.is_empty());
    machine.shop.now = machine.shop.now + Span(1);
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
    let mut told = Vec::new();
    let start = machine.shop.now;
    let ending = loop {
        let wants = machine.turn();
        told.extend(wants.record.alarms.iter().map(|alarm| alarm.code.name()));
        if let Some(ending) = wants.record.ending {
            break ending;
        }
        assert!(machine.shop.now.since(start) < Span::ms(120_000));
    };
    assert_eq!(
        (ending, told.last().map(String::as_str)),
        (Ending::Alarm, Some("magazine_empty"))
    );
    assert_eq!(machine.station.ledger().came_in, 1);
}

/// Codes of the alarms that begin while `machine` runs for `ms`.
fn told(machine: &mut Machine, ms: u64) -> Vec<String> {
    let end = machine.shop.now + Span::ms(ms);
    let mut told = Vec::new();
    while machine.shop.now < end {
        told.extend(
            machine
                .turn()
                .record
                .alarms
                .into_iter()
                .map(|alarm| alarm.code.name()),
        );
    }
    told
}

#[test]
fn venting_by_emergency_stop_raises_one_alarm() {
    let mut machine = Machine::attended(None, vec![Specimen::MissingPin; 50]);
    told(&mut machine, 2_000);
    machine.shop.set(DigitalIn::EmergencyStopOk, false);
    machine.shop.set(DigitalIn::AirOk, false);
    assert_eq!(told(&mut machine, 5_000), ["emergency_stop"]);
    machine.shop.set(DigitalIn::EmergencyStopOk, true);
    assert!(told(&mut machine, 1_500).is_empty(), "pressure comes back");
    machine.shop.set(DigitalIn::AirOk, true);
    assert!(told(&mut machine, 5_000).is_empty());
}

#[test]
fn missing_air_after_an_emergency_stop_is_reported() {
    let mut machine = Machine::attended(None, vec![Specimen::MissingPin; 50]);
    told(&mut machine, 2_000);
    machine.shop.set(DigitalIn::EmergencyStopOk, false);
    machine.shop.set(DigitalIn::AirOk, false);
    told(&mut machine, 1_000);
    machine.shop.set(DigitalIn::EmergencyStopOk, true);
    assert_eq!(told(&mut machine, 3_000), ["air_lost"]);
}
