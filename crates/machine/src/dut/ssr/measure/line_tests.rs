//! Tests of AC parts on a made-up fixture, from the pins to the discharge.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::dut::Procedure;
use crate::dut::ssr::points::{Device, DigitalIn, DigitalOut};
use crate::dut::ssr::tests::line_bench::{LineBench, Part, RANDOM, ZERO_CROSS, good, recipe};
use crate::dut::ssr::wave::distortion::Conducting;

fn tested(text: &str, changes: &[(&str, &str)], part: Part) -> (LineBench, Procedure) {
    let recipe = recipe(text, changes);
    let mut bench = LineBench::with(part, &recipe);
    let test = bench.tested(false);
    (bench, test)
}

fn changed(change: impl Fn(&mut Part)) -> Part {
    let mut part = good();
    change(&mut part);
    part
}

/// Returns the verdict of a test, with code and detail of the finding that has ended it.
fn ended(test: &Procedure) -> (&'static str, Option<(&'static str, String)>) {
    let why = test.why_stopped().map(|it| match it {
        Stop::Fail(why) | Stop::Void(why) | Stop::Trouble(why) => why,
    });
    let why = why.map(|it| (it.code.name(), it.detail.clone()));
    (test.verdict().name(), why)
}

fn void(code: &'static str, detail: &str) -> (&'static str, Option<(&'static str, String)>) {
    ("void", Some((code, detail.to_owned())))
}

#[test]
fn the_leakage_of_a_good_part_is_split() {
    for (hz, changes) in [
        (50.0, vec![]),
        (60.0, vec![("mains_hz = 50.0", "mains_hz = 60.0")]),
    ] {
        let part = changed(|it| it.hz = hz * 0.9995);
        let (_, test) = tested(ZERO_CROSS, &changes, part.clone());
        let resistive = part.leak_s * 230.0 * 1e6;
        let capacitive = std::f64::consts::TAU * hz * part.leak_f * 230.0 * 1e6;
        let truth = [
            (Parameter::LeakageResistive, resistive),
            (Parameter::LeakageCapacitive, capacitive),
            (Parameter::LeakageCold, resistive.hypot(capacitive)),
        ];
        for (of, truth) in truth {
            let reading = test.record().result(of).unwrap();
            let error = (reading.value - truth).abs();
            assert!(
                error <= 1.3 * reading.expanded(),
                "{of:?}: {reading:?}, {truth}"
            );
        }
        assert!(!test.is_live());
    }
}

#[test]
fn a_good_part_passes() {
    let (_, test) = tested(ZERO_CROSS, &[], good());
    assert_eq!(test.verdict().name(), "pass", "{:?}", test.verdict());
    assert_eq!(
        test.record().conforms,
        [("v_on_conforms", true), ("v_off_conforms", true)]
    );
    assert!(!test.is_live());
}

#[test]
fn a_welded_contactor_voids_the_part() {
    for mirror in [DigitalIn::LineOpen, DigitalIn::LoopOpen] {
        let part = changed(|it| it.stuck = vec![mirror]);
        let (bench, test) = tested(ZERO_CROSS, &[], part);
        assert_eq!(ended(&test), void("ssr_contactor", mirror.name()));
        let opens = bench.log.iter().rev().find(|it| it.starts_with("set"));
        assert!(!opens.unwrap().contains("contactor"), "{:?}", bench.log);
    }
}

#[test]
fn a_contactor_that_does_not_close_is_named() {
    for (contactor, mirror) in [
        (DigitalOut::LineContactor, DigitalIn::LineOpen),
        (DigitalOut::LoopContactor, DigitalIn::LoopOpen),
    ] {
        let expected = void("ssr_contactor", mirror.name());
        let mut bench = LineBench::with(good(), &recipe(ZERO_CROSS, &[]));
        bench.part.broken = vec![contactor];
        assert_eq!(ended(&bench.tested(false)), expected, "first part");
        bench.part.broken.clear();
        assert_eq!(bench.tested(false).verdict(), Verdict::Pass);
        bench.part.broken = vec![contactor];
        assert_eq!(ended(&bench.tested(false)), expected, "later part");
    }
}

#[test]
fn a_dead_line_fails_no_part() {
    let dead = void("ssr_line_dead", "");
    let mut bench = LineBench::with(good(), &recipe(ZERO_CROSS, &[]));
    for reference in [0, 1] {
        bench.part.dead_from = bench.line_records + reference;
        assert_eq!(ended(&bench.tested(false)), dead, "reference {reference}");
    }
    bench.part.dead_from = usize::MAX;
    assert_eq!(bench.tested(false).verdict(), Verdict::Pass);
    // Leakage, turn-off, turn-on (which the train finds), train, leakage again.
    for record in 0..5 {
        bench.part.dead_from = bench.line_records + record;
        assert_eq!(ended(&bench.tested(false)), dead, "record {record}");
    }
}

#[test]
fn a_line_that_dies_in_a_train_fails_no_part() {
    const TRAIN: usize = 3;
    for threshold_v in [0.85, 0.01] {
        let part = changed(|it| it.threshold_v = threshold_v);
        let mut bench = LineBench::with(part, &recipe(ZERO_CROSS, &[]));
        assert_eq!(bench.tested(false).verdict(), Verdict::Pass);
        for dies_ms in (1..190).step_by(7) {
            bench.part.dead_from = bench.line_records + TRAIN;
            bench.part.dies_s = f64::from(dies_ms) / 1e3;
            let ended = ended(&bench.tested(false));
            assert_eq!(ended, void("ssr_line_dead", ""), "after {dies_ms} ms");
        }
    }
}

#[test]
fn a_line_that_dies_in_a_leakage_fails_no_part() {
    for record in [0, 4] {
        for dies_ms in (1..60).step_by(4) {
            let mut bench = LineBench::with(good(), &recipe(ZERO_CROSS, &[]));
            assert_eq!(bench.tested(false).verdict(), Verdict::Pass);
            bench.part.dead_from = bench.line_records + record;
            bench.part.dies_s = f64::from(dies_ms) / 1e3;
            let test = bench.tested(false);
            assert_eq!(
                test.verdict().name(),
                "void",
                "{dies_ms} ms: {:?}",
                ended(&test)
            );
        }
    }
}

#[test]
fn a_loop_that_opens_in_its_record_fails_no_part() {
    for (zero_cross, text) in [(true, ZERO_CROSS), (false, RANDOM)] {
        let part = changed(|it| it.zero_cross = zero_cross);
        let mut bench = LineBench::with(part, &recipe(text, &[]));
        assert_eq!(bench.tested(false).verdict(), Verdict::Pass);
        for opens_ms in (0..210).step_by(7) {
            bench.part.loop_opens_s = f64::from(opens_ms) / 1e3;
            let ended = ended(&bench.tested(false));
            assert_eq!(ended, void("ssr_loop_dead", ""), "after {opens_ms} ms");
        }
        // Around a last zero of the current, an open loop changes nothing.
        for tenths_ms in (2_100..2_170).step_by(4) {
            bench.part.loop_opens_s = f64::from(tenths_ms) / 1e4;
            let verdict = bench.tested(false).verdict();
            let is_known = matches!(verdict, Verdict::Pass | Verdict::Void(_));
            assert!(is_known, "after {tenths_ms} tenths: {verdict:?}");
        }
    }
}

#[test]
fn a_break_that_heals_fails_no_part() {
    /// Records on the line of a later part.
    const RECORDS: usize = 5;
    for (zero_cross, text) in [(true, ZERO_CROSS), (false, RANDOM)] {
        let part = changed(|it| it.zero_cross = zero_cross);
        let mut bench = LineBench::with(part, &recipe(text, &[]));
        assert_eq!(bench.tested(false).verdict(), Verdict::Pass);
        let check = |bench: &mut LineBench, what: &str| {
            let verdict = bench.tested(false).verdict();
            let is_known = matches!(verdict, Verdict::Pass | Verdict::Void(_));
            assert!(is_known, "{what}: {verdict:?}");
        };
        for lasts_ms in [1.0, 2.0, 5.0, 20.0, 50.0] {
            bench.part.heals_after_s = lasts_ms / 1e3;
            for at_ms in (0..210).step_by(29) {
                bench.part.loop_opens_s = f64::from(at_ms) / 1e3;
                check(&mut bench, &format!("loop, {lasts_ms} ms at {at_ms} ms"));
            }
            bench.part.loop_opens_s = f64::INFINITY;
            for (record, at_ms) in
                (0..RECORDS).flat_map(|it| (0..190).step_by(53).map(move |at| (it, at)))
            {
                bench.part.dead_from = bench.line_records + record;
                bench.part.dies_s = f64::from(at_ms) / 1e3;
                check(
                    &mut bench,
                    &format!("line, {lasts_ms} ms at {at_ms} ms of record {record}"),
                );
                bench.part.dead_from = usize::MAX;
            }
        }
    }
}

#[test]
fn a_part_that_misses_a_polarity_in_the_loop_fails() {
    for dead in [1.0, -1.0] {
        let mut bench = LineBench::with(good(), &recipe(ZERO_CROSS, &[]));
        bench.part.dead_in_loop = dead;
        let test = bench.tested(false);
        let code = Some(("ssr_half_wave", String::new()));
        assert_eq!(ended(&test), ("fail", code), "{dead}");
    }
}

#[test]
fn a_short_in_the_socket_fails_no_part() {
    let part = changed(|it| it.is_socket_shorted = true);
    let (_, test) = tested(ZERO_CROSS, &[], part);
    assert_eq!(ended(&test), void("ssr_socket_shorted", ""));
}

#[test]
fn an_output_that_conducts_without_control_still_fails() {
    let shorted = changed(|it| it.shorted = 1.0);
    let sticking = changed(|it| it.sticks = true);
    for (part, code) in [(shorted, "ssr_shorted"), (sticking, "ssr_stuck_on")] {
        let (_, test) = tested(ZERO_CROSS, &[], part);
        assert_eq!(ended(&test), ("fail", Some((code, String::new()))));
    }
}

#[test]
fn a_failed_instrument_leaves_both_contactors_open() {
    for failing in [
        (Device::Digitizer, "complete"),
        (Device::PulseSource, "start"),
        (Device::AcSource, "voltage"),
        (Device::SmuIn, "source"),
    ] {
        let part = changed(|it| it.failing = Some(failing));
        let (bench, test) = tested(ZERO_CROSS, &[], part);
        assert_eq!(test.verdict().name(), "void", "{failing:?}");
        let last = bench.log.iter().rev().find(|it| it.starts_with("set"));
        assert!(!last.unwrap().contains("contactor"), "{:?}", bench.log);
        assert!(!test.is_live(), "{failing:?}");
    }
}

#[test]
fn a_source_off_its_level_keeps_the_loop_open() {
    let part = changed(|it| it.source = 1.15);
    let (bench, test) = tested(ZERO_CROSS, &[], part);
    assert_eq!(test.verdict().name(), "void");
    assert!(!bench.log.iter().any(|it| it.contains("loop_contactor")));
}

#[test]
fn sampled_characteristics_are_measured_on_their_parts_alone() {
    let sampling = [("phases = 6 ", "sampling = 2\nphases = 6 ")];
    for (judged, is_measured) in [(0, true), (1, true), (2, false)] {
        let mut bench = LineBench::with(good(), &recipe(ZERO_CROSS, &sampling));
        bench.device.judged = judged;
        let test = bench.tested(false);
        let found = test.record().result(Parameter::Distortion).is_some();
        assert_eq!(found, is_measured, "after {judged} parts");
        assert!(test.record().result(Parameter::Drop).is_some());
        assert_eq!(test.verdict().name(), "pass", "{:?}", test.verdict());
    }
}

#[test]
fn staircases_find_both_thresholds() {
    const LEAST_V: f64 = 1.004;
    for zero_cross in [true, false] {
        let all = [("searched = 3 ", "searched = 99 ")];
        let mut bench = LineBench::with(good(), &recipe(ZERO_CROSS, &all));
        bench.part.zero_cross = zero_cross;
        // The sixth part and the next ones begin near what the others have shown, the last one does not fit them.
        let thresholds = [2.4, 2.31, 2.43, 2.39, 2.52, 2.41, 2.46, LEAST_V + 0.2, 2.95];
        for turn_on_v in thresholds {
            (bench.part.turn_on_v, bench.part.turn_off_v) = (turn_on_v, turn_on_v - 0.19);
            let test = bench.tested(false);
            for (of, truth) in [
                (Parameter::TurnOnVoltage, turn_on_v),
                (Parameter::TurnOffVoltage, turn_on_v - 0.19),
            ] {
                let reading = test.record().result(of).unwrap();
                let error = (reading.value - truth).abs();
                assert!(error < 0.0126, "{of:?}: {}, {truth}", reading.value);
                assert!(error < 1.1 * reading.expanded(), "{reading:?}, {truth}");
            }
        }
    }
}

#[test]
fn only_the_first_parts_are_searched() {
    let mut bench = LineBench::with(good(), &recipe(ZERO_CROSS, &[]));
    for number in 0..6 {
        let test = bench.tested(false);
        let found = test.record().result(Parameter::TurnOnVoltage);
        assert_eq!(found.is_some(), number < 3, "part {number}");
        assert_eq!(test.verdict(), Verdict::Pass);
    }
}

#[test]
fn the_distortion_is_that_of_a_cold_part_at_a_sine() {
    for again_v in [2.0, 4.2, 6.0] {
        let part = changed(|it| it.again_v = again_v);
        let truth = Conducting {
            threshold_v: part.threshold_v + part.rise_v,
            ohm: part.ohm,
            fires_v: again_v,
            load_ohm: 4.7,
        };
        let truth_v = truth.distortion_v(truth.sine(5.0 * std::f64::consts::SQRT_2));
        let (_, test) = tested(ZERO_CROSS, &[], part);
        let found = test.record().result(Parameter::Distortion);
        let reading = found.unwrap_or_else(|| panic!("{again_v} V: {:?}", ended(&test)));
        let error = (reading.value - 1e3 * truth_v).abs();
        assert!(error < 1.1 * reading.expanded(), "{reading:?}, {truth_v} V");
    }
}
