//! Output values, and the clearance that a motion needs.

use super::{text, wiring};
use crate::guard::{Actuator, Guard, GuardSettings, Motion, PartSize, Position, Situation, Stroke};
use crate::rig::drive::{DriveError, Outputs, Write};
use crate::rig::level::{Correction, SupplyError};
use crate::rig::point::DigitalOut;
use crate::rig::settings::RigSettings;
use crate::rig::wiring::Wiring;
use std::sync::Arc;
use units::Volt;

fn guard() -> Guard {
    let settings: GuardSettings =
        toml::from_str(include_str!("../../../../../config/scene.toml")).unwrap();
    Guard::build(&settings).unwrap()
}

fn at_rest() -> Situation {
    Situation::at_rest(PartSize {
        body_mm: [22.5, 16.5, 16.5],
        pin_length_mm: 3.5,
    })
}

/// Clears the motion in `situation`, drives it, and returns the requests of its writes.
fn driven(outputs: &mut Outputs, motion: &Motion, situation: &Situation) -> Vec<String> {
    let cleared = guard().clear(motion, situation).unwrap();
    outputs.apply(cleared).unwrap();
    outputs
        .writes()
        .iter()
        .map(|write| text(&write.command))
        .collect()
}

#[test]
fn at_start_every_output_gets_its_safe_value() {
    let mut outputs = Outputs::new(wiring());
    let writes: Vec<String> = outputs
        .writes()
        .iter()
        .map(|write| text(&write.command))
        .collect();
    assert_eq!(
        writes,
        [
            "#020000", "@040000", "#060000", "#070000", "@130000", "@140000"
        ]
    );
    assert!(outputs.writes().is_empty());
}

#[test]
fn a_lost_write_repeats_without_an_axis() {
    let settings = include_str!("../../../../../config/rigs/thermostat/rig.toml");
    let settings: RigSettings = toml::from_str(settings).unwrap();
    let wiring = Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap();
    let mut outputs = Outputs::new(Arc::new(wiring));
    let requests =
        |all: &[Write]| -> Vec<String> { all.iter().map(|it| text(&it.command)).collect() };
    let sent = outputs.writes();
    sent.iter().for_each(|lost| outputs.failed(lost.module));
    assert_eq!(requests(&outputs.writes()), requests(&sent));
}

#[test]
fn an_output_that_moves_something_needs_a_cleared_motion() {
    let mut outputs = Outputs::new(wiring());
    for &point in DigitalOut::OF_FEEDER {
        let expected = if point.moves() {
            Err(DriveError::NeedsClearance { point })
        } else {
            Ok(())
        };
        assert_eq!(outputs.set(point, true), expected);
        assert_eq!(outputs.is_on(point), !point.moves());
    }
}

#[test]
fn a_cleared_stroke_switches_its_valve_and_nothing_else() {
    let mut outputs = Outputs::new(wiring());
    outputs.writes();
    let extend = Motion::to(Actuator::Pusher, 60.0);
    assert_eq!(driven(&mut outputs, &extend, &at_rest()), ["@130002"]);
    let jaws = [Actuator::JawLeft, Actuator::JawRight];
    let close = Motion::group(&jaws.map(|actuator| Stroke {
        actuator,
        to_mm: 8.0,
    }));
    outputs.everything_safe();
    outputs.writes();
    assert_eq!(driven(&mut outputs, &close, &at_rest()), ["@130004"]);
    let closed = jaws
        .iter()
        .fold(at_rest(), |now, jaw| now.with(*jaw, Position::At(8.0)));
    let open = Motion::group(&jaws.map(|actuator| Stroke {
        actuator,
        to_mm: 0.0,
    }));
    assert_eq!(driven(&mut outputs, &open, &closed), ["@130008"]);
}

#[test]
fn one_jaw_alone_cannot_be_driven() {
    let mut outputs = Outputs::new(wiring());
    let cleared = guard()
        .clear(&Motion::to(Actuator::JawLeft, 8.0), &at_rest())
        .unwrap();
    assert_eq!(outputs.apply(cleared), Err(DriveError::LoneJaw));
    assert!(!outputs.is_on(DigitalOut::ClampClose));
}

#[test]
fn the_axis_edge_follows_its_point_bits() {
    let mut outputs = Outputs::new(wiring());
    outputs.set(DigitalOut::AxisServoOn, true).unwrap();
    outputs.writes();
    let voltage_bin = Motion::to(Actuator::SortAxis, 230.0);
    assert_eq!(
        driven(&mut outputs, &voltage_bin, &at_rest()),
        ["@140014", "@14001C"]
    );
    let there = at_rest().with(Actuator::SortAxis, Position::At(230.0));
    let home = Motion::to(Actuator::SortAxis, 0.0);
    assert_eq!(driven(&mut outputs, &home, &there), ["@140010", "@140018"]);
    let nowhere = guard()
        .clear(&Motion::to(Actuator::SortAxis, 100.0), &at_rest())
        .unwrap();
    assert_eq!(
        outputs.apply(nowhere),
        Err(DriveError::NoSuchStation { x_mm: 100.0 })
    );
}

#[test]
fn lost_writes_and_edges_are_repeated() {
    let wiring = wiring();
    let mut outputs = Outputs::new(Arc::clone(&wiring));
    outputs.writes();
    driven(
        &mut outputs,
        &Motion::to(Actuator::SortAxis, 75.0),
        &at_rest(),
    );
    let module = super::module(&wiring, "mech_do_b");
    outputs.failed(module);
    let again: Vec<String> = outputs
        .writes()
        .iter()
        .map(|write| text(&write.command))
        .collect();
    assert_eq!(again, ["@140001", "@140009"]);
}

#[test]
fn outputs_are_settled_when_every_write_was_confirmed() {
    let wiring = wiring();
    let mut outputs = Outputs::new(Arc::clone(&wiring));
    let writes = outputs.writes();
    assert!(!outputs.all_settled());
    for write in writes {
        outputs.confirmed(write.module);
    }
    assert!(outputs.all_settled());
    outputs.set(DigitalOut::LampGreen, true).unwrap();
    assert!(!outputs.all_settled());
}

#[test]
fn a_supply_share_becomes_the_nearest_corrected_step() {
    let wiring = wiring();
    let level = wiring.analog_output("supply_level").unwrap();
    let mut outputs = Outputs::new(wiring);
    outputs.writes();
    let correction = Correction {
        gain: 1.0005,
        offset_v: 0.002,
    };
    let really = outputs.set_supply(level, Volt(12.0), correction).unwrap();
    assert!((really.0 - 12.0).abs() < 1.5 * 10.0 / 65535.0);
    let written = ((8.0 - 0.002) / 1.0005 / 10.0 * 65535.0f64).round() as u32;
    let writes: Vec<String> = outputs
        .writes()
        .iter()
        .map(|write| text(&write.command))
        .collect();
    assert_eq!(writes, [format!("#02{written:04X}")]);
    let zero = outputs.set_supply(level, Volt(0.0), correction).unwrap();
    assert!((zero.0 - 0.003).abs() < 1e-9);
    for impossible in [Volt(15.1), Volt(-1.0), Volt(f64::NAN)] {
        let error = outputs
            .set_supply(level, impossible, Correction::NONE)
            .unwrap_err();
        assert!(matches!(error, SupplyError::Level { .. }));
    }
}
