//! Figures that a client measures against the truth of the part.

use super::hand::Hand;

/// Every instrument without errors, and no part with a defect.
pub const GOOD: &str = "[instrument]\nsmu_in.exact = true\nsmu_out.exact = true\ndigitizer.exact = true\npulse_source.exact = true\n[ssr.defects]\nrate_pct = 0.0\n";

fn good() -> Hand {
    let mut hand = Hand::in_world(3, GOOD);
    hand.feed();
    hand
}

/// Captures one control pulse of 30 ms at the digitizer; returns the volts of three channels, and the trigger's place.
pub fn capture(hand: &mut Hand) -> ([Vec<f64>; 3], usize) {
    hand.set("drive_select", true);
    for line in [
        ":CHAN1:SCAL 2;:CHAN2:SCAL 0.02;:CHAN3:SCAL 3;:CHAN4:SCAL 0.005",
        ":TIM:SCAL 0.005;:ACQ:MDEP 50000",
        ":TIM:REF LEFT",
        ":TRIG:SOUR CHAN1;:TRIG:LEV 2;:TRIG:SLOP POS;:SING",
    ] {
        hand.tell("digitizer", line);
    }
    for line in [
        "*RST;:FUNC PULS;:OUTP:LOAD INF;:VOLT:LOW 0;:BURS:MODE TRIG;:TRIG:SOUR BUS;:BURS:STAT ON",
        ":VOLT:HIGH 5;:PULS:PER 0.05;:FUNC:PULS:WIDT 0.03;:BURS:NCYC 1;:OUTP ON",
        "*TRG",
    ] {
        hand.tell("pulse_source", line);
    }
    hand.wait(400.0);
    assert_eq!(hand.ask("digitizer", ":TRIG:STAT?"), "STOP");
    hand.tell("digitizer", ":WAV:MODE RAW;FORM WORD;STAR 1;STOP 50000");
    let channels = [1, 2, 3].map(|channel| {
        hand.tell("digitizer", &format!(":WAV:SOUR CHAN{channel}"));
        let scales: Vec<f64> = hand
            .ask("digitizer", ":WAV:PRE?")
            .split(',')
            .map(|it| it.parse().expect("a scale"))
            .collect();
        let block = hand.ask_bytes("digitizer", ":WAV:DATA?");
        let bytes = &block[11..block.len() - 1];
        let codes = bytes.chunks(2).map(|it| u16::from_le_bytes([it[0], it[1]]));
        codes
            .map(|code| (f64::from(code) - scales[8] - scales[9]) * scales[7])
            .collect()
    });
    (channels, 5_000)
}

/// Returns the first sample after `from` at which a curve is past a level, as a time of the given step.
fn crossing(curve: &[f64], from: usize, past: impl Fn(f64) -> bool) -> usize {
    let place = curve[from..].iter().position(|volts| past(*volts));
    from + place.expect("a crossing")
}

#[test]
fn leakage_and_input_current_are_the_true_ones() {
    let mut hand = good();
    hand.control(5.0);
    let input_ma = hand.value("smu_in", ":READ?") * 1e3;
    assert!(
        (input_ma - hand.figure("i_in_ma")).abs() < 1e-4,
        "{input_ma}"
    );
    hand.control(-5.0);
    let reverse_ua = -hand.value("smu_in", ":READ?") * 1e6;
    let true_ua = hand.figure("i_rev_ua");
    assert!(
        (reverse_ua - true_ua).abs() < 1e-6,
        "{reverse_ua} {true_ua}"
    );
    hand.control(0.0);
    hand.set("bleed_open", true);
    hand.source("smu_out", 60.0, 1e-3, 1e-4);
    hand.set("smu_to_output", true);
    hand.wait(20.0);
    let leak_ua = hand.value("smu_out", ":READ?") * 1e6;
    let true_ua = hand.figure("i_leak_ua");
    // The open fixture itself leaks 0.6 nA.
    assert!((leak_ua - true_ua).abs() < 1e-3, "{leak_ua} {true_ua}");
    assert!(!hand.is_on("output_safe"));
    hand.set("bleed_open", false);
    let bled_ua = hand.value("smu_out", ":READ?") * 1e6;
    assert!(bled_ua > 5_900.0 || bled_ua > 1e30, "{bled_ua}");
}

#[test]
fn drop_and_drift_are_the_true_ones() {
    let mut hand = good();
    hand.control(5.0);
    hand.set("bleed_open", true);
    hand.set("smu_to_output", true);
    hand.source_amps(0.5, 0.1);
    let half_v = hand.value("smu_out", ":READ?");
    let ohm = half_v / 0.5;
    let true_ohm = hand.figure("r_on_mohm") * 1e-3;
    assert!((ohm / true_ohm - 1.0).abs() < 2e-3, "{ohm} {true_ohm}");
    hand.tell("smu_out", ":OUTP OFF");
    hand.wait(300.0);
    hand.tell("smu_out", ":SOUR:CURR 1;:SENS:VOLT:NPLC 0.01");
    // A sweep measures by itself, so that its instants do not depend on the link.
    let begin_us = hand.t_us;
    hand.tell(
        "smu_out",
        ":SENS:COUN 1000;:SENS:VOLT:RANG 0.2;:OUTP ON;:INIT",
    );
    hand.wait(300.0);
    let text = hand.ask("smu_out", ":TRAC:DATA? 1,1000,\"defbuffer1\",READ");
    let volts: Vec<f64> = text
        .split(',')
        .map(|it| it.parse().expect("volts"))
        .collect();
    // Each reading takes 0.2 ms; the output comes on one or two milliseconds after the message.
    let drift_mv = (volts[990] - volts[48]) * 1e3;
    let true_mv = hand.figure("drift_mv");
    assert!(
        (drift_mv / true_mv - 1.0).abs() < 0.06,
        "{drift_mv} {true_mv} {begin_us}"
    );
}

#[test]
fn a_capture_shows_the_true_times() {
    let mut hand = good();
    hand.load();
    let ([control, _, output], trigger) = capture(&mut hand);
    let edge = crossing(&control, 0, |volts| volts > 2.4);
    assert!(edge.abs_diff(trigger) <= 2, "{edge}");
    let load = |volts: f64| 8.0 - volts;
    let on = crossing(&output, edge, |volts| load(volts) >= 0.9 * 8.0) - edge;
    let end = crossing(&control, edge + 10, |volts| volts < 2.4);
    let off = crossing(&output, end, |volts| load(volts) <= 0.1 * 8.0) - end;
    assert!((end - edge).abs_diff(30_000) <= 1, "{edge} {end}");
    let (true_on, true_off) = (hand.figure("t_on_us"), hand.figure("t_off_us"));
    // 50 ohm in series with the pulse source take some of the input current.
    assert!((on as f64 / true_on - 1.07).abs() < 0.04, "{on} {true_on}");
    assert!(
        (off as f64 / true_off - 0.98).abs() < 0.03,
        "{off} {true_off}"
    );
}

#[test]
fn the_output_follows_the_true_thresholds() {
    let mut hand = good();
    hand.load();
    let (v_on, v_off) = (hand.figure("v_on_v"), hand.figure("v_off_v"));
    for (volts, conducts) in [
        (v_on - 0.02, false),
        (v_on + 0.02, true),
        (v_off + 0.02, true),
        (v_off - 0.02, false),
    ] {
        if volts == v_off + 0.02 {
            hand.control(5.0);
        }
        hand.tell("smu_in", &format!(":SOUR:VOLT {volts}"));
        if volts < v_on && !conducts && volts > v_off {
            hand.control(volts);
        }
        hand.tell("smu_in", ":OUTP ON");
        hand.wait(50.0);
        let amps = hand.value("smu_out", ":READ?");
        assert_eq!(amps > 5e-3, conducts, "{volts} V: {amps} A");
    }
}

#[test]
fn the_clock_goes_on_at_every_switching() {
    // When rounding left a switching too little ahead, the clock lost it and the rig stood still for good.
    let mut hand = good();
    hand.load();
    hand.control(5.0);
    for step in 0..1_000_u32 {
        let volts = 1.5 + 3e-3 * f64::from(step);
        for volts in [volts, 0.0] {
            hand.tell("smu_in", &format!(":SOUR:VOLT {volts}"));
            hand.wait(20.0);
        }
    }
}

#[test]
fn without_a_part_every_terminal_is_open() {
    let mut hand = Hand::in_world(3, GOOD);
    hand.set("probe_lift", true);
    hand.wait(300.0);
    hand.control(5.0);
    assert_eq!(hand.value("smu_in", ":READ?"), 0.0);
    hand.load();
    let amps = hand.value("smu_out", ":READ?");
    assert!(amps.abs() < 1e-9, "{amps}");
    hand.set("kelvin_test", true);
    assert!(!hand.is_on("kelvin_in_plus") && !hand.is_on("kelvin_out_2"));
}

#[test]
fn references_replace_the_output_of_the_part() {
    let mut hand = good();
    hand.set("bleed_open", true);
    for (low, high, ohms) in [
        (true, false, f64::INFINITY),
        (false, true, 1e-3),
        (true, true, 1e3),
    ] {
        hand.set("smu_to_output", false);
        hand.set("reference_0", low);
        hand.set("reference_1", high);
        hand.source("smu_out", 0.5, 1e-2, 1e-2);
        hand.set("smu_to_output", true);
        hand.wait(5.0);
        let amps = hand.value("smu_out", ":READ?");
        let expected = (0.5 / ohms).min(1e-2);
        // The resistor has an error of 0.1 %.
        assert!(
            (amps - expected).abs() <= 1.2e-3 * expected + 1e-9,
            "{ohms}: {amps}"
        );
    }
    hand.set("reference_0", false);
    hand.set("reference_1", false);
    let amps = hand.value("smu_out", ":READ?");
    assert!(
        (amps - 5e-4).abs() < 1e-6,
        "switched under the unit: {amps}"
    );
}
