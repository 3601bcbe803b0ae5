//! Overshoot from reference parts, and the parts that are refused.
#![allow(clippy::unwrap_used)]

use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::measure::{Ramp, TestRecord};
use crate::dut::em_relay::overshoot::CoarseResults;
use crate::dut::em_relay::reference_part::{ReferenceRun, interim};
use crate::dut::em_relay::settings::ReferencePart;
use crate::dut::em_relay::tests::context;
use crate::dut::em_relay::tests::reference_parts;
use crate::dut::em_relay::threshold::Direction;
use crate::gauge::Deviation;
use crate::gauge::budget::{Budget, Reading};
use crate::rig::sample::Sample;
use units::{Celsius, Unit, Volt};

const REFERENCE: Celsius = Celsius(23.0);

/// Record of a reference part whose ramps overshoot by `operate_v` and `release_v`, at 23 C.
fn tested(part: &ReferencePart, operate_v: f64, release_v: f64, coil_off_ohm: f64) -> TestRecord {
    let fine = |volts: f64| Some(Ramp::fine_only(Volt(volts)));
    let mut record = TestRecord::default();
    record.own.track = Some(REFERENCE);
    record.own.operate = fine(part.operate_voltage_v.value + operate_v);
    record.own.release = fine(part.release_voltage_v.value + release_v);
    let reading = Reading {
        value: part.coil_resistance_ohm.value + coil_off_ohm,
        unit: Unit::Ohm,
        budget: Budget::default().with("test", 0.1),
    };
    record.found::<Sample>(Parameter::CoilResistance, reading, []);
    record
}

fn run_of(operate_mv: &[f64], release_mv: f64) -> ReferenceRun {
    let mut run = ReferenceRun::default();
    for (part, mv) in reference_parts().iter().zip(operate_mv) {
        let record = tested(part, mv / 1e3, release_mv / 1e3, 0.0);
        run.learn(part, REFERENCE, &record, &record.own).unwrap();
    }
    run
}

#[test]
fn the_fine_overshoot_is_the_mean_shift() {
    let run = run_of(&[12.0, 15.0, 13.0, 14.0, 16.0], -9.0);
    let overshoots = run
        .overshoots(
            &reference_parts(),
            &context().accuracy,
            context().assumed_models(),
        )
        .unwrap();
    assert!((overshoots.operate.fine_v.value - 0.014).abs() < 1e-9);
    assert!((overshoots.release.fine_v.value + 0.009).abs() < 1e-9);
    // 1 mV of the certificate and 2 mV of the operation, five parts; budgets have their temperature in another term.
    for overshoot in [overshoots.operate, overshoots.release] {
        assert!((overshoot.fine_v.u - 0.001).abs() < 1e-9);
    }
}

#[test]
fn certificates_are_compared_at_the_parts_temperature() {
    let parts = reference_parts();
    let mut run = ReferenceRun::default();
    let warm = Celsius(28.0);
    for part in &parts {
        let scale = (234.5 + 28.0) / (234.5 + 23.0);
        let mut record = tested(part, 0.0, 0.0, 0.0);
        record.own.track = Some(warm);
        record.own.operate = Some(Ramp {
            coarse: CoarseResults::NONE,
            fine: Some(Volt(part.operate_voltage_v.value * scale + 0.012)),
        });
        record.own.release = Some(Ramp {
            coarse: CoarseResults::NONE,
            fine: Some(Volt(part.release_voltage_v.value * scale - 0.012)),
        });
        run.learn(part, REFERENCE, &record, &record.own).unwrap();
    }
    let overshoots = run
        .overshoots(&parts, &context().accuracy, context().assumed_models())
        .unwrap();
    assert!((overshoots.operate.fine_v.value - 0.012).abs() < 1e-9);
    assert!((overshoots.release.fine_v.value + 0.012).abs() < 1e-9);
}

#[test]
fn an_outlier_is_named() {
    let run = run_of(&[12.0, 15.0, 130.0, 14.0, 16.0], -9.0);
    let why = run
        .overshoots(
            &reference_parts(),
            &context().accuracy,
            context().assumed_models(),
        )
        .unwrap_err();
    let why = why.to_string();
    assert!(why.contains("G-12-3"), "{why}");
}

#[test]
fn fewer_than_three_reference_parts_teach_no_overshoot() {
    for (n, usable) in [(0, false), (1, false), (2, false), (3, true), (5, true)] {
        let run = run_of(&vec![14.0; n], -9.0);
        let overshoots = run.overshoots(
            &reference_parts(),
            &context().accuracy,
            context().assumed_models(),
        );
        assert_eq!(overshoots.is_ok(), usable, "{n} parts");
    }
}

#[test]
fn more_reference_parts_reduce_the_overshoot_uncertainty() {
    let u = |n: usize| {
        let run = run_of(&vec![14.0; n], -9.0);
        let overshoots = run.overshoots(
            &reference_parts(),
            &context().accuracy,
            context().assumed_models(),
        );
        overshoots.unwrap().operate.fine_v.u
    };
    assert!((u(3) / u(5) - (5f64 / 3.0).sqrt()).abs() < 1e-9);
}

#[test]
fn an_incomplete_reference_part_is_refused_by_name() {
    let part = reference_parts()[1].clone();
    let good = || tested(&part, 0.014, -0.009, 0.0);
    let spoilt = |spoil: fn(&mut TestRecord)| {
        let mut record = good();
        spoil(&mut record);
        record
    };
    let cases = [
        ("temperature", spoilt(|found| found.own.track = None)),
        ("Operate", spoilt(|found| found.own.operate = None)),
        ("Release", spoilt(|found| found.own.release = None)),
        (
            "Release",
            spoilt(|found| found.own.release = found.own.release.map(|r| Ramp { fine: None, ..r })),
        ),
        ("coil", tested(&part, 0.014, -0.009, 3.0)),
        ("coil", tested(&part, 0.014, -0.009, -3.0)),
    ];
    for (what, record) in cases {
        let refused = ReferenceRun::default().learn(&part, REFERENCE, &record, &record.own);
        let why = refused.unwrap_err();
        let why = why.to_string();
        assert!(why.contains("G-12-2") && why.contains(what), "{why}");
    }
    let learned = ReferenceRun::default().learn(&part, REFERENCE, &good(), &good().own);
    assert_eq!(learned, Ok(()));
}

#[test]
fn an_interim_overshoot_proves_nothing() {
    let overshoot = interim(context().assumed_models().0, 0.0);
    assert_eq!(
        (overshoot.fine_v.value, overshoot.fine_v.u),
        (0.0, f64::INFINITY)
    );
    assert_eq!(
        overshoot.coarse,
        context().overshoot(Direction::Rising).coarse
    );
}

#[test]
fn operate_voltages_show_the_scatter_of_temperatures() {
    let accuracy = context().accuracy;
    let parts = reference_parts();
    let residuals = |mv: &[f64]| run_of(mv, -9.0).temperatures(&parts, &accuracy);
    // 0.15 K of a coil are 4.6 mV of an operate voltage of 7.88 V; 4.6, 0 and -4.6 mV twice.
    let found = residuals(&[18.6, 14.0, 9.4, 18.6, 9.4]).unwrap();
    assert_eq!(found.freedom, 4);
    assert!((found.own.sqrt() - 4.6e-3).abs() < 0.05e-3, "{found:?}");
    assert!((found.others.sqrt() - 2.24e-3).abs() < 0.01e-3, "{found:?}");
    assert!((found.squares / found.own - 4.0).abs() < 0.1, "{found:?}");
    assert!(residuals(&[14.0]).is_none(), "one part");
}

#[test]
fn coils_of_the_reference_parts_correct_the_thermometer() {
    let parts = reference_parts();
    let run = |off_ohm: f64| {
        let mut run = ReferenceRun::default();
        for part in &parts {
            let record = tested(part, 0.014, -0.009, off_ohm);
            run.learn(part, REFERENCE, &record, &record.own).unwrap();
        }
        run
    };
    let part_k = Deviation {
        value: 0.15,
        freedom: 5.0,
    };
    let found = run(0.4).temperature(part_k);
    assert!((found.coil.value - 400.0 / 400.4).abs() < 1e-6, "{found:?}");
    // A certificate has 0.01 %; five parts.
    assert!(
        (found.coil.u - 1e-4 / 5f64.sqrt()).abs() < 1e-6,
        "{found:?}"
    );
    assert!((found.part_k.value - 0.15 * 1.2f64.sqrt()).abs() < 1e-12);
    assert_eq!(found.part_k.freedom, 5.0);
}
