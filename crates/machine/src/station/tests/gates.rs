//! Events that open and close the gates of a lot.

use super::machine::{Machine, Specimen};
use super::reference_parts;
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::measure::TestRecord;
use crate::dut::em_relay::reference_part::check;
use crate::dut::em_relay::settings::ReferencePart;
use crate::gauge::budget::{Budget, Reading};
use crate::handling::ledger::PartRole;
use crate::handling::place::Place;
use crate::handling::wear::Uses;
use crate::rig::sample::Sample;
use crate::station::Activity;
use crate::station::catalogue::AlarmCode;
use crate::station::gates::{CheckSettings, LotSettings, WearSettings};
use crate::station::orders::Order;
use crate::station::packml::{Command, State};
use crate::station::turn::Ending;

const BAD: Specimen = Specimen::OpenCoil;

/// Record of a reference part with one parameter `deviations` standard deviations off its certificate.
fn read(part: &ReferencePart, off: Parameter, deviations: f64) -> TestRecord {
    let mut record = TestRecord::default();
    for (parameter, certified) in [
        (Parameter::CoilResistance, part.coil_resistance_ohm),
        (Parameter::OperateVoltage, part.operate_voltage_v),
        (Parameter::ReleaseVoltage, part.release_voltage_v),
    ] {
        let u = 0.003_f64;
        let by = if parameter == off { deviations } else { 0.0 };
        let reading = Reading {
            value: certified.value + by * u.hypot(certified.u),
            unit: parameter.facts().definition.unit,
            budget: Budget::default().with("test", u),
        };
        record.found::<Sample>(parameter, reading, []);
    }
    record
}

#[test]
fn a_reference_part_agrees_within_three_standard_deviations() {
    let part = &reference_parts()[0];
    for parameter in [
        Parameter::CoilResistance,
        Parameter::OperateVoltage,
        Parameter::ReleaseVoltage,
    ] {
        for (deviations, agrees) in [
            (0.0, true),
            (2.9, true),
            (-2.9, true),
            (3.1, false),
            (-3.1, false),
            (f64::NAN, false),
        ] {
            let found = check(part, &read(part, parameter, deviations));
            assert_eq!(found.is_ok(), agrees, "{parameter} {deviations}: {found:?}");
        }
    }
    let nothing = check(part, &TestRecord::default());
    assert!(nothing.is_err_and(|why| why.to_string().contains("Coil resistance")));
}

/// A machine whose parts, the reference part included, all have an open coil, so that every check fails.
fn checked(settings: CheckSettings, attended: bool) -> Machine {
    let lot = LotSettings {
        reference_check: settings,
        ..LotSettings::default()
    };
    Machine::of_lot(Some(6), vec![BAD; 9], lot, attended)
}

fn after_parts(parts: u64) -> CheckSettings {
    CheckSettings {
        after_parts: Some(parts),
        ..CheckSettings::default()
    }
}

fn kinds(machine: &mut Machine) -> Vec<String> {
    let mut kinds = Vec::new();
    for _ in 0..20_000 {
        let output = machine.turn();
        kinds.extend(
            output
                .record
                .parts
                .judged
                .iter()
                .map(|one| match &one.part.role {
                    PartRole::Reference(_) => "golden".to_owned(),
                    PartRole::Lot(seq) => seq.to_string(),
                }),
        );
        let rests = machine.station.outer() == State::Held;
        if output.record.ending.is_some() || rests {
            break;
        }
    }
    kinds
}

#[test]
fn after_a_failed_check_only_reference_parts_run() {
    let mut machine = checked(after_parts(2), true);
    assert_eq!(kinds(&mut machine), ["1", "2", "golden"]);
    assert_eq!(machine.station.outer(), State::Held);
    machine.order(Order::Command(Command::Unhold)).unwrap();
    assert_eq!(kinds(&mut machine), ["golden"], "the gate attended closed");
    let failed = machine.station.annunciator().listed();
    assert_eq!(failed[0].alarm.code, AlarmCode::ReferenceCheckFailed);
}

#[test]
fn a_failed_check_ends_an_unattended_run() {
    let mut machine = checked(after_parts(2), false);
    assert_eq!(machine.run().record.ending, Some(Ending::Alarm));
}

#[test]
fn a_start_check_precedes_the_first_part() {
    let settings = CheckSettings {
        at_start: true,
        ..CheckSettings::default()
    };
    let mut machine = checked(settings, true);
    assert_eq!(kinds(&mut machine), ["golden"]);
}

#[test]
fn a_check_due_by_time_holds_the_line() {
    let settings = CheckSettings {
        after_h: Some(2.0 / 3600.0),
        ..CheckSettings::default()
    };
    let mut machine = checked(settings, true);
    let made = kinds(&mut machine);
    assert!(
        !made.is_empty() && !made.contains(&"golden".to_owned()),
        "{made:?}"
    );
    let due = &machine.station.annunciator().listed()[0].alarm;
    assert!(due.code == AlarmCode::ReferenceCheckDue && due.args.get("serial") == Some("G-12-1"));
    machine.order(Order::Command(Command::Unhold)).unwrap();
    assert_eq!(
        kinds(&mut machine).first().map(String::as_str),
        Some("golden")
    );
}

#[test]
fn an_interrupted_reference_check_begins_again() {
    let mut machine = checked(after_parts(1), true);
    while machine
        .station
        .ledger()
        .part(Place::NEST)
        .is_none_or(|part| matches!(part.role, PartRole::Lot(_)))
    {
        machine.turn();
    }
    machine.order(Order::Command(Command::Abort)).unwrap();
    for command in [Command::Clear, Command::Reset, Command::Start] {
        while machine.station.may(command).is_err() {
            machine.turn();
        }
        machine.order(Order::Command(command)).unwrap();
    }
    let kinds = kinds(&mut machine);
    assert_eq!(
        kinds.first().map(String::as_str),
        Some("golden"),
        "{kinds:?}"
    );
}

#[test]
fn the_reject_rate_limit_alarms_once() {
    let lot = LotSettings {
        reject_rate_limit_pct: Some(34.0),
        ..LotSettings::default()
    };
    let mut machine = Machine::of_lot(Some(6), vec![BAD; 6], lot, true);
    assert_eq!(kinds(&mut machine), ["1", "2", "3"], "two of six are 33 %");
    machine.order(Order::Command(Command::Unhold)).unwrap();
    assert_eq!(kinds(&mut machine).len(), 3, "the person goes on with it");
}

#[test]
fn wear_of_earlier_runs_counts() {
    let lot = LotSettings {
        wear: WearSettings {
            probe_touches: Some(102),
            jaw_closings: Some(1000),
            probe_contact_ohm: None,
        },
        ..LotSettings::default()
    };
    let worn = Uses {
        probe_touches: 100,
        jaw_closings: 0,
    };
    let mut machine = Machine::of_lot(Some(3), vec![BAD; 3], lot, false);
    machine.wore(worn);
    let mut codes = Vec::new();
    loop {
        let output = machine.turn();
        codes.extend(
            output
                .record
                .alarms
                .iter()
                .map(|alarm| (alarm.code.name(), machine.station.uses().probe_touches)),
        );
        if output.record.ending.is_some() {
            break;
        }
    }
    assert_eq!(codes, [("probes_worn".to_owned(), 2)]);
}

#[test]
fn an_expired_calibration_stops_the_lot() {
    let mut machine = Machine::of_lot(Some(6), vec![BAD; 6], LotSettings::default(), true);
    while machine.landed.is_empty() {
        machine.turn();
    }
    machine.calibration_runs_out();
    let codes: Vec<String> = machine
        .turn()
        .record
        .alarms
        .into_iter()
        .map(|alarm| alarm.code.name())
        .collect();
    assert_eq!(codes, ["calibration_overdue"]);
    for command in [Command::Clear, Command::Reset, Command::Start] {
        while machine.station.may(command).is_err() {
            machine.turn();
        }
        machine.order(Order::Command(command)).unwrap();
    }
    assert_eq!(machine.station.activity(), Activity::Calibrating);
}
