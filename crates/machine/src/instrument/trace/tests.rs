//! The samples that a trace keeps.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::dut::em_relay::points::{AnalogOut, DigitalOut, Points};
use crate::handling::tests::MockRig;

#[test]
fn a_poll_without_changes_keeps_two_samples() {
    let mut trace = Trace::default();
    for at in 0..100 {
        let made = at >= 90;
        trace.word("board", &[made, !made, false, true], RigTime(at));
    }
    let looks: Vec<(u64, f64)> = trace
        .samples()
        .iter()
        .map(|look| (look.at.0, look.value))
        .collect();
    let [open, made] = [0b1010, 0b1001].map(f64::from);
    assert_eq!(looks, [(0, open), (89, open), (90, made), (99, made)]);
}

#[test]
fn the_trace_keeps_its_first_samples() {
    let wiring = MockRig::unread().wiring;
    let points = Points::resolve(&wiring).unwrap();
    let mut trace = Trace::default();
    let levels = [
        (points.source(AnalogOut::SupplyLevel), Volt(1.0)),
        (points.source(AnalogOut::SupplyFine), Volt(0.5)),
    ];
    trace.commanded(&wiring, &levels, RigTime(7));
    for (at, output) in [(8, DigitalOut::CoilDrive), (9, DigitalOut::Arm)] {
        trace.switched(&wiring, &[(points.output(output), true)], RigTime(at));
    }
    let names: Vec<_> = trace.samples().iter().map(|it| it.signal.name).collect();
    assert_eq!(names, ["supply_level", "supply_fine", "coil_drive"]);
    let mut much = trace.clone();
    (0..MAX_SAMPLES).for_each(|_| much.commanded(&wiring, &levels, RigTime(11)));
    assert_eq!(much.samples().len(), MAX_SAMPLES);
    trace.append(much);
    assert_eq!(trace.samples().len(), MAX_SAMPLES);
}

#[test]
fn a_waveform_leaves_the_ends_of_its_pieces() {
    let mut trace = Trace::default();
    let (query, wave) = (waveform(2.0), wave());
    trace.delivered(&query, &wave, RigTime(10_000));
    let looks: Vec<(u64, f64)> = trace.samples()[4..6]
        .iter()
        .map(|look| (look.at.0, look.value))
        .collect();
    assert_eq!(looks, [(8_515, 11.0), (8_518, -9.0)]);
    assert_eq!(trace.samples().len(), 2 + 2 * WAVE_PIECES);
    for _ in 0..100 {
        trace.delivered(&query, &wave, RigTime(20_000));
    }
    trace.word("board", &[true], RigTime(20_001));
    assert_eq!(trace.samples().len(), MAX_WAVE_SAMPLES + 1);
}

#[test]
fn channels_read_together_are_one_record_with_marks() {
    let mut stage = Trace::default();
    stage.mark("switch_on", 1e-4);
    assert!(stage.samples().is_empty(), "a mark without a record");
    for factor in [1.0, 2.0] {
        stage.delivered(&waveform(factor), &wave(), RigTime(10_000));
    }
    let mut trace = Trace::default();
    trace.append(stage.of_stage("Timing"));
    trace.mark("switch_on", 1e-4);
    let of = |source| {
        let all = trace
            .samples()
            .iter()
            .filter(move |it| it.signal.source == source);
        all.map(|it| (it.signal.name, it.at.0, it.value))
            .collect::<Vec<_>>()
    };
    let [begin, end] = of(Source::Record).try_into().unwrap();
    assert_eq!(
        (begin.0, begin.1, end.0, end.1),
        ("Timing", 8_501, "Timing", 10_000)
    );
    assert!((begin.2 + 2e-4).abs() < 1e-12 && (end.2 - 1.299e-3).abs() < 1e-12);
    assert_eq!(of(Source::Mark), [("switch_on", 8_801, 1.0)]);
}

#[test]
fn an_edge_stays_as_sharp_as_its_samples() {
    let noisy = [0.02, 0.0, 0.05, 0.03, 4.97, 4.99, 5.0, 4.96];
    assert_eq!(extremes(&noisy), [3, 4]);
    assert_eq!(extremes(&[1.0, 1.0, 1.0]), [0, 0]);
    assert_eq!(extremes(&[5.0, 0.0, 5.1, 0.0]), [1, 2]);
}

/// Returns a query whose waveform shows `1 + factor * volts`.
fn waveform(factor: f64) -> Query {
    Query {
        instrument: crate::rig::instruments::Instrument::at(0),
        program: "waveform",
        arguments: Vec::new(),
        shows: vec![Shown {
            name: "load_voltage",
            unit: "V",
            step: 1e-3,
            factor,
            offset: 1.0,
        }],
    }
}

/// Returns a waveform of 1.5 ms, 0.2 ms of it before the trigger, with two peaks in its second piece.
fn wave() -> Delivered {
    let mut volts = vec![0.0; 10 * WAVE_PIECES];
    (volts[14], volts[17]) = (5.0, -5.0);
    let wave = Waveform {
        start_s: -2e-4,
        step_s: 1e-6,
        volts,
    };
    Delivered {
        numbers: Vec::new(),
        waveform: Some(std::sync::Arc::new(wave)),
    }
}
