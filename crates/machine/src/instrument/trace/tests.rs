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
    let signal = Signal::channel(crate::rig::instruments::Instrument::at(0), 3).unwrap();
    assert_eq!((signal.name, signal.unit), ("channel_3", "V"));
    let mut volts = vec![0.0; 10 * WAVE_PIECES];
    (volts[14], volts[17]) = (5.0, -5.0);
    let wave = Waveform {
        start_s: 0.0,
        step_s: 1e-6,
        volts,
    };
    trace.wave(signal, &wave, RigTime(10_000));
    let looks: Vec<(u64, f64)> = trace.samples()[2..4]
        .iter()
        .map(|look| (look.at.0, look.value))
        .collect();
    assert_eq!(looks, [(8_514, 5.0), (8_517, -5.0)]);
    assert_eq!(trace.samples().len(), 2 * WAVE_PIECES);
    for _ in 0..100 {
        trace.wave(signal, &wave, RigTime(20_000));
    }
    trace.word("board", &[true], RigTime(20_001));
    assert_eq!(trace.samples().len(), MAX_WAVE_SAMPLES + 1);
}
