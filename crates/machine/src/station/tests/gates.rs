//! What opens and closes the gates of a lot.

use super::golden_parts;
use super::machine::{Machine, Specimen};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::measure::TestRecord;
use crate::dut::em_relay::reference_part::check;
use crate::dut::em_relay::settings::ReferencePart;
use crate::gauge::budget::{Budget, Reading};
use crate::handling::ledger::Kind;
use crate::handling::place::Place;
use crate::handling::wear::Uses;
use crate::rig::sample::Sample;
use crate::station::Doing;
use crate::station::catalogue::AlarmCode;
use crate::station::gates::{CheckSettings, LotSettings, WearSettings};
use crate::station::orders::Order;
use crate::station::packml::{Command, State};
use crate::station::wants::Ending;

const BAD: Specimen = Specimen::OpenCoil;

/// Returns the record of a reference part whose parameter `off` deviates by `deviations` standard deviations.
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
            unit: parameter.definition().unit,
            budget: Budget::default().with("test", u),
        };
        record.found::<Sample>(parameter, reading, []);
    }
    record
}

#[test]
fn a_golden_part_agrees_with_its_certificate_within_three_standard_deviations() {
    let part = &golden_parts()[0];
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

/// Every part of this magazine has a broken coil, the golden one too: no check can be passed.
fn checked(settings: CheckSettings, attended: bool) -> Machine {
    let lot = LotSettings {
        golden_check: settings,
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
        let wants = machine.turn();
        kinds.extend(
            wants
                .record
                .parts
                .judged
                .iter()
                .map(|one| match &one.part.kind {
                    Kind::Reference(_) => "golden".to_owned(),
                    Kind::Lot(seq) => seq.to_string(),
                }),
        );
        let rests = machine.station.outer() == State::Held;
        if wants.record.ending.is_some() || rests {
            break;
        }
    }
    kinds
}

#[test]
fn nothing_but_a_golden_part_is_judged_after_a_check_that_failed() {
    let mut machine = checked(after_parts(2), true);
    assert_eq!(kinds(&mut machine), ["1", "2", "golden"]);
    assert_eq!(machine.station.outer(), State::Held);
    machine.order(Order::Command(Command::Unhold)).unwrap();
    assert_eq!(kinds(&mut machine), ["golden"], "the gate attended closed");
    let failed = machine.station.annunciator().standing();
    assert_eq!(failed[0].alarm.code, AlarmCode::ReferenceCheckFailed);
}

#[test]
fn without_a_person_a_check_that_failed_ends_the_run() {
    let mut machine = checked(after_parts(2), false);
    assert_eq!(machine.run().record.ending, Some(Ending::Alarm));
}

#[test]
fn a_check_at_the_start_comes_before_the_first_part() {
    let settings = CheckSettings {
        at_start: true,
        ..CheckSettings::default()
    };
    let mut machine = checked(settings, true);
    assert_eq!(kinds(&mut machine), ["golden"]);
}

#[test]
fn after_so_many_hours_the_line_holds_and_asks_for_the_golden_part() {
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
    let due = &machine.station.annunciator().standing()[0].alarm;
    assert!(due.code == AlarmCode::ReferenceCheckDue && due.args.get("serial") == Some("G-12-1"));
    machine.order(Order::Command(Command::Unhold)).unwrap();
    assert_eq!(
        kinds(&mut machine).first().map(String::as_str),
        Some("golden")
    );
}

#[test]
fn a_golden_part_that_was_interrupted_has_said_nothing() {
    let mut machine = checked(after_parts(1), true);
    while machine
        .station
        .ledger()
        .part(Place::NEST)
        .is_none_or(|part| matches!(part.kind, Kind::Lot(_)))
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
fn the_reject_rate_limit_alarms_once_at_the_first_excess() {
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
    let mut told = Vec::new();
    loop {
        let wants = machine.turn();
        told.extend(
            wants
                .record
                .alarms
                .iter()
                .map(|alarm| (alarm.code.name(), machine.station.uses().probe_touches)),
        );
        if wants.record.ending.is_some() {
            break;
        }
    }
    assert_eq!(told, [("probes_worn".to_owned(), 2)]);
}

#[test]
fn a_calibration_that_runs_out_stops_the_lot_and_the_next_start_calibrates() {
    let mut machine = Machine::of_lot(Some(6), vec![BAD; 6], LotSettings::default(), true);
    while machine.landed.is_empty() {
        machine.turn();
    }
    machine.calibration_runs_out();
    let told: Vec<String> = machine
        .turn()
        .record
        .alarms
        .into_iter()
        .map(|alarm| alarm.code.name())
        .collect();
    assert_eq!(told, ["calibration_overdue"]);
    for command in [Command::Clear, Command::Reset, Command::Start] {
        while machine.station.may(command).is_err() {
            machine.turn();
        }
        machine.order(Order::Command(command)).unwrap();
    }
    assert_eq!(machine.station.doing(), Doing::Calibrating);
}
