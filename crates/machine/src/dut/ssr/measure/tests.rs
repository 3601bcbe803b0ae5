//! Parts on a bench, tested from the pins to the discharge.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::dut::Procedure;
use crate::dut::reason::{Code, Reason};
use crate::dut::ssr::points::{Device as Named, DigitalIn};
use crate::dut::ssr::tests::bench::{Bench, Part, good, recipe};
use crate::dut::ssr::{Finding, bins};
use crate::gauge::Side;
use crate::rig::bin::Bin;

fn tested(part: Part) -> Procedure {
    Bench::with(part).tested(recipe(&[]), false)
}

fn changed(change: impl Fn(&mut Part)) -> Part {
    let mut part = good();
    change(&mut part);
    part
}

/// True values of a part in the order of the characteristics, in their units.
fn truth(part: &Part) -> [f64; 11] {
    [
        part.turn_on_v,
        part.turn_off_v,
        part.input_a * 1e3,
        part.reverse_a * 1e6,
        part.on_s * 1e6,
        part.off_s * 1e6,
        part.ohm * 3.0,
        part.ohm * 1e3,
        part.leakage_a * 1e6,
        part.hot_leakage_a * 1e6,
        part.rise_v * 1e3,
    ]
}

#[test]
fn a_good_part_passes_with_its_true_values() {
    let test = tested(good());
    assert_eq!(test.verdict(), Verdict::Pass);
    assert!(!test.is_live());
    let of_dc = Parameter::ALL.into_iter().filter(|it| it.is_of_dc());
    for (of, truth) in of_dc.zip(truth(&good())) {
        let reading = test.record().result(of).unwrap();
        let error = (reading.value - truth).abs();
        assert!(error <= reading.expanded(), "{of:?}: {reading:?}, {truth}");
        assert_eq!(test.record().attempts(of), 1);
    }
}

#[test]
fn the_record_of_the_times_has_their_marks() {
    let record = tested(good()).record();
    let of = |name: &str| -> Vec<(u64, f64)> {
        let all = record.trace.samples().iter();
        let own = all.filter(|it| it.signal.name == name);
        own.map(|it| (it.at.0, it.value)).collect()
    };
    let [(begin_us, begin_s), (end_us, end_s)] = of("Timing").try_into().unwrap();
    assert!(begin_s < 0.0 && end_s > 0.0 && begin_us < end_us);
    let trigger_us = begin_us as f64 - begin_s * 1e6;
    let [on_us, off_us] = ["switch_on", "switch_off"].map(|name| of(name)[0].0 as f64 - trigger_us);
    assert!((on_us - good().on_s * 1e6).abs() < 20.0, "{on_us}");
    assert!((off_us - on_us - 1900.0).abs() < 40.0, "{off_us}");
    for name in ["control_voltage", "load_voltage", "load_current"] {
        let inside = of(name)
            .into_iter()
            .filter(|it| (begin_us..=end_us).contains(&it.0));
        assert!((250..=300).contains(&inside.count()), "{name}");
    }
}

#[test]
fn every_finding_of_a_part_goes_to_its_bin() {
    use Finding as F;
    type Change = fn(&mut Part);
    let cases: [(Change, Finding, Bin); 18] = [
        (
            |it| it.dead = vec![DigitalIn::KelvinOut1],
            F::PinOpen,
            Bin::RETEST,
        ),
        (
            |it| it.dead = vec![DigitalIn::ProbeChain],
            F::ProbeChainOpen,
            Bin::RETEST,
        ),
        (|it| it.is_shorted = true, F::Shorted, bins::OUTPUT),
        (|it| it.has_diode = true, F::Shorted, bins::OUTPUT),
        (|it| it.input_a = 1e-6, F::InputOpen, bins::INPUT),
        (|it| it.input_a = 0.5, F::InputShorted, bins::INPUT),
        (
            |it| it.reverse_a = 0.5,
            F::InputConductsReversed,
            bins::INPUT,
        ),
        (
            |it| {
                it.input_a = 1e-6;
                it.is_turned = true;
            },
            F::Turned,
            Bin::RETEST,
        ),
        (|it| it.leakage_a = 1.0, F::Leaks, bins::LEAKAGE),
        (|it| it.hot_leakage_a = 1.0, F::LeaksHot, bins::LEAKAGE),
        (
            |it| it.turn_off_v = 0.9,
            F::ConductsBelowTurnOff,
            bins::INPUT,
        ),
        (|it| it.sticks_at_v = 4.0, F::StuckOn, bins::OUTPUT),
        (|it| it.sticks_loaded_v = 4.0, F::StuckOn, bins::OUTPUT),
        (|it| it.turn_on_v = 5.5, F::NeverOn, bins::OUTPUT),
        (|it| it.turn_on_v = 3.6, F::BlocksAboveTurnOn, bins::INPUT),
        (|it| it.on_s = 2.5e-3, F::TurnsOnTooLate, bins::TIME),
        (|it| it.off_s = 1.0, F::TurnsOffTooLate, bins::TIME),
        (|it| it.ohm = 0.3, F::DropTooHigh, bins::OUTPUT),
    ];
    for (change, finding, bin) in cases {
        let test = tested(changed(change));
        let verdict = test.verdict();
        let codes: Vec<Code> = verdict.reasons().iter().map(|it| it.code).collect();
        assert!(
            codes.contains(&Code::Finding(finding.into())),
            "{finding:?}: {verdict:?}"
        );
        assert_eq!(verdict.bin(), bin, "{finding:?}");
        assert!(!test.is_live(), "{finding:?} ends with the discharge");
    }
}

#[test]
fn a_body_diode_is_no_short_where_expected() {
    let diode = [("body_diode = false", "body_diode = true")];
    let part = changed(|it| it.has_diode = true);
    let test = Bench::with(part).tested(recipe(&diode), false);
    assert_eq!(test.verdict(), Verdict::Pass);
}

#[test]
fn both_sides_of_each_limit_are_told_apart() {
    use Parameter as P;
    type Change = fn(&mut Part, f64);
    let cases: [(Parameter, Side, f64, Change); 10] = [
        (P::InputCurrent, Side::High, 5.5, |it, ma| {
            it.input_a = ma / 1e3
        }),
        (P::InputCurrent, Side::Low, 2.5, |it, ma| {
            it.input_a = ma / 1e3
        }),
        (P::ReverseCurrent, Side::High, 10.0, |it, ua| {
            it.reverse_a = ua / 1e6
        }),
        (P::TurnOnTime, Side::High, 1000.0, |it, us| {
            it.on_s = us / 1e6
        }),
        (P::TurnOffTime, Side::High, 1000.0, |it, us| {
            it.off_s = us / 1e6
        }),
        (P::Drop, Side::High, 0.25, |it, volts| it.ohm = volts / 3.0),
        (P::OnResistance, Side::High, 83.0, |it, mohm| {
            it.ohm = mohm / 1e3
        }),
        (P::LeakageCold, Side::High, 10.0, |it, ua| {
            it.leakage_a = ua / 1e6
        }),
        (P::LeakageHot, Side::High, 50.0, |it, ua| {
            it.hot_leakage_a = ua / 1e6
        }),
        (P::Drift, Side::High, 0.18, |it, mv| it.rise_v = mv / 1e3),
    ];
    for (of, side, limit, change) in cases {
        let beyond = match side {
            Side::High => 1.15,
            Side::Low => 0.85,
        };
        let at = |value: f64| tested(changed(|it| change(it, value)));
        let (inside, outside) = (at(limit / beyond), at(limit * beyond));
        assert_eq!(inside.verdict(), Verdict::Pass, "{of:?}");
        let reasons = outside.verdict().reasons().to_vec();
        let expected = Reason::outside(of.into(), side);
        assert!(reasons.contains(&expected), "{of:?} {side}: {reasons:?}");
        assert_eq!(outside.verdict().bin(), Characteristic::from(of).bin());
    }
}

#[test]
fn a_time_inside_the_guard_band_is_measured_again() {
    let test = tested(changed(|it| it.on_s = 999.5e-6));
    assert_eq!(test.record().attempts(Parameter::TurnOnTime), 4);
    let near = Reason::not_proven(Parameter::TurnOnTime.into(), Side::High);
    assert_eq!(test.verdict(), Verdict::Fail(vec![near]));
}

#[test]
fn a_voltage_within_the_guard_band_is_not_proven() {
    let cases = [
        (
            Parameter::TurnOnVoltage,
            Side::High,
            changed(|it| it.turn_on_v = 3.5),
        ),
        (
            Parameter::TurnOffVoltage,
            Side::Low,
            changed(|it| it.turn_off_v = 1.0),
        ),
    ];
    for (of, side, part) in cases {
        let test = tested(part);
        let near = Reason::not_proven(of.into(), side);
        assert_eq!(test.verdict(), Verdict::Fail(vec![near]));
        assert_eq!(test.record().result(of), None, "no interval holds it");
    }
}

#[test]
fn an_output_late_at_its_limit_fails_the_voltage() {
    let test = tested(changed(|it| it.weak_s = Some(1.2e-3)));
    let late = [
        Reason::outside(Parameter::TurnOnVoltage.into(), Side::High),
        Reason::outside(Parameter::TurnOffVoltage.into(), Side::Low),
    ];
    assert_eq!(test.verdict(), Verdict::Fail(late.to_vec()));
    assert_eq!(
        test.record().conforms,
        [("v_on_conforms", false), ("v_off_conforms", false)]
    );
}

#[test]
fn an_output_late_at_every_voltage_fails_its_time() {
    let test = tested(changed(|it| it.on_s = 1.2e-3));
    let late = Reason::outside(Parameter::TurnOnTime.into(), Side::High);
    assert_eq!(test.verdict(), Verdict::Fail(vec![late]));
    assert_eq!(test.record().conforms, [("v_off_conforms", true)]);
}

#[test]
fn the_simple_rule_applies_the_limit_itself() {
    let simple = [("\"guard_band\"", "\"simple\"")];
    let part = changed(|it| it.turn_on_v = 3.5);
    let test = Bench::with(part).tested(recipe(&simple), false);
    let of = Parameter::TurnOnVoltage.into();
    assert!(test.judgements().contains(&(of, Judgement::Pass)));
}

#[test]
fn conformity_alone_decides_without_a_voltage() {
    let only = [("method = \"bisect\"", "method = \"conformity\"")];
    let test = Bench::with(good()).tested(recipe(&only), false);
    assert_eq!(test.verdict(), Verdict::Pass);
    assert_eq!(test.record().result(Parameter::TurnOnVoltage), None);
    assert_eq!(test.record().result(Parameter::TurnOffVoltage), None);
}

#[test]
fn two_ramps_find_both_thresholds() {
    let ramps = [("method = \"bisect\"", "method = \"ramp\"")];
    for turn_on_v in [1.4, 2.003, 2.41, 3.3] {
        let part = changed(|it| (it.turn_on_v, it.turn_off_v) = (turn_on_v, turn_on_v - 0.18));
        let mut bench = Bench::with(part);
        let test = bench.tested(recipe(&ramps), false);
        assert_eq!(test.verdict(), Verdict::Pass, "{turn_on_v} V");
        for (of, truth) in [
            (Parameter::TurnOnVoltage, turn_on_v),
            (Parameter::TurnOffVoltage, turn_on_v - 0.18),
        ] {
            let reading = test.record().result(of).unwrap();
            let error = (reading.value - truth).abs();
            assert!(error <= reading.expanded(), "{of:?}: {reading:?}, {truth}");
            assert!(reading.expanded() < 0.012, "{reading:?}");
        }
        let sweeps = bench.log.iter().filter(|it| it.as_str() == "query ramp");
        assert_eq!(sweeps.count(), 2);
    }
}

#[test]
fn a_thorough_test_confirms_every_figure() {
    let test = Bench::with(good()).tested(recipe(&[]), true);
    for of in [
        Parameter::InputCurrent,
        Parameter::Drop,
        Parameter::LeakageHot,
    ] {
        assert_eq!(test.record().attempts(of), 4);
    }
    assert_eq!(test.verdict(), Verdict::Pass);
}

#[test]
fn a_failed_program_voids_and_disconnects_first() {
    let programs = [
        (Named::SmuIn, "source_and_read"),
        (Named::SmuOut, "settle_and_read"),
        (Named::SmuIn, "level"),
        (Named::SmuIn, "step"),
        (Named::SmuOut, "read"),
        (Named::Digitizer, "capture"),
        (Named::PulseSource, "start"),
        (Named::Digitizer, "complete"),
        (Named::Digitizer, "waveform"),
        (Named::SmuOut, "drops_over_time"),
        (Named::SmuOut, "off"),
    ];
    for failing in programs {
        let mut bench = Bench::with(changed(|it| it.failing = Some(failing)));
        let test = bench.tested(recipe(&[]), false);
        assert!(
            matches!(test.why_stopped(), Some(Stop::Trouble(_))),
            "{failing:?}"
        );
        assert_eq!(test.verdict().bin(), Bin::RETEST);
        assert!(!test.is_live(), "{failing:?} is discharged");
        let failed = bench.log.iter().position(|it| it.contains(failing.1));
        assert!(bench.log[failed.unwrap()..].iter().any(|it| it == "set "));
    }
}

#[test]
fn an_unproven_discharge_is_trouble_of_the_rig() {
    for (volts, dead) in [
        (0.5, vec![DigitalIn::OutputSafe]),
        (45.0, vec![]),
        (45.0, vec![DigitalIn::OutputSafe]),
    ] {
        let part = changed(|it| {
            it.residual_v = volts;
            it.dead = dead.clone();
        });
        assert!(tested(part).is_live(), "{volts} V");
    }
}

#[test]
fn values_without_number_void_the_part() {
    let cases = [
        ("source_and_read", vec![f64::NAN, f64::NAN]),
        ("settle_and_read", vec![1e-6]),
        ("read", vec![f64::INFINITY]),
        ("read", vec![]),
        ("drops_over_time", vec![0.06; 3]),
        ("drop_at_current", vec![f64::NAN]),
    ];
    for (program, numbers) in cases {
        let test = tested(changed(|it| it.spoiled = Some((program, numbers.clone()))));
        let verdict = test.verdict();
        let found = Code::Finding(Finding::NotDelivered.into());
        assert_eq!(verdict.reasons()[0].code, found, "{program}");
        assert!(matches!(verdict, Verdict::Void(_)), "{program}");
        assert!(!test.is_live());
    }
}

#[test]
fn a_finding_skips_every_later_measurement() {
    let mut bench = Bench::with(changed(|it| it.is_shorted = true));
    bench.tested(recipe(&[]), false);
    let queries = bench.log.iter().filter(|it| it.starts_with("query"));
    // At the beginning and at the end of both tests.
    assert_eq!(queries.collect::<Vec<_>>(), ["query off off"; 4]);
}

#[test]
fn a_good_part_needs_few_programs_and_little_waiting() {
    let mut first = Bench::with(good());
    let taught = first.tested(recipe(&[]), false);
    assert!(first.rounds <= 50, "{} rounds", first.rounds);
    let mut bench = Bench::with(good());
    for _ in 0..5 {
        bench.learned.add(&taught.record());
    }
    let test = bench.tested(recipe(&[]), false);
    let waits_ms = test.record().spent.bound.0 as f64 / 1e3;
    assert!(
        bench.rounds <= 44,
        "{} rounds: {:#?}",
        bench.rounds,
        bench.log
    );
    assert!(waits_ms < 150.0, "{waits_ms} ms");
}

#[test]
fn a_short_in_the_socket_fails_no_part() {
    let test = tested(changed(|it| it.is_socket_shorted = true));
    let why = Stop::Void(Finding::SocketShorted.into());
    assert_eq!(test.why_stopped(), Some(&why));
}

#[test]
fn a_lead_that_breaks_and_heals_fails_no_part() {
    for lasts in [1, 3, 10] {
        for jobs in 0..150 {
            let mut bench = Bench::with(good());
            (bench.lead_opens_after, bench.lead_heals_after) = (jobs, jobs + lasts);
            let verdict = bench.tested(recipe(&[]), false).verdict();
            let is_known = matches!(verdict, Verdict::Pass | Verdict::Void(_));
            assert!(is_known, "{lasts} jobs after {jobs}: {verdict:?}");
        }
    }
}

#[test]
fn a_lead_that_breaks_and_heals_moves_no_threshold() {
    let part = good();
    let truth = [
        (Parameter::TurnOnVoltage, part.turn_on_v),
        (Parameter::TurnOffVoltage, part.turn_off_v),
    ];
    let mut dropped = 0;
    for lasts in [1, 3, 10] {
        for jobs in 0..150 {
            let mut bench = Bench::with(good());
            (bench.lead_opens_after, bench.lead_heals_after) = (jobs, jobs + lasts);
            let test = bench.tested(recipe(&[]), false);
            for (of, volts) in truth.iter().filter(|_| test.verdict() == Verdict::Pass) {
                let record = test.record();
                let Some(reading) = record.result(*of) else {
                    dropped += 1;
                    continue;
                };
                let error_v = (reading.value - volts).abs();
                assert!(
                    error_v < 2.0 * reading.expanded(),
                    "{lasts} jobs after {jobs}: {of:?} {reading:?}"
                );
            }
        }
    }
    assert!(dropped > 20, "{dropped}");
}

#[test]
fn a_lead_that_breaks_at_any_job_fails_no_part() {
    let (mut voids, mut named) = (0, 0);
    for jobs in 0..150 {
        let mut bench = Bench::with(good());
        bench.lead_opens_after = jobs;
        let test = bench.tested(recipe(&[]), false);
        let verdict = test.verdict();
        assert!(
            !matches!(verdict, Verdict::Fail(_)),
            "after {jobs} jobs: {verdict:?}"
        );
        let dead = Stop::Void(Finding::LoopDead.into());
        named += usize::from(test.why_stopped() == Some(&dead));
        voids += usize::from(matches!(verdict, Verdict::Void(_)));
    }
    assert!(voids > 40 && named * 10 > voids * 9, "{named} of {voids}");
}
