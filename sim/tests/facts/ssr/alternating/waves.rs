//! Tests of the waves at the digitizer against the truth of the part.

use super::*;

/// Length (s) and points of a record of six pulses whose period shifts the phase of the mains.
const WALK: (f64, usize) = (0.5, 50_000);

fn rms(curve: &[f64]) -> f64 {
    let squares: f64 = curve.iter().map(|it| it * it).sum();
    (squares / curve.len() as f64).sqrt()
}

/// Returns the instants, in samples, at which a condition begins to hold.
fn begins(curve: &[f64], holds: impl Fn(f64) -> bool) -> Vec<usize> {
    let pairs = curve.windows(2).enumerate();
    let found = pairs.filter(|(_, it)| !holds(it[0]) && holds(it[1]));
    found.map(|(place, _)| place + 1).collect()
}

/// Returns the rms of a curve at 100 kS/s without its fundamental and its mean.
fn distortion(curve: &[f64], hz: f64) -> f64 {
    let n = curve.len() as f64;
    let turns = |place: usize| std::f64::consts::TAU * hz * place as f64 * 1e-5;
    let pairs = || curve.iter().enumerate();
    let sine: f64 = pairs().map(|(k, v)| v * turns(k).sin()).sum();
    let cosine: f64 = pairs().map(|(k, v)| v * turns(k).cos()).sum();
    let fundamental = 2.0 * (sine * sine + cosine * cosine) / (n * n);
    (rms(curve).powi(2) - fundamental).sqrt()
}

#[test]
fn leakage_is_snubber_and_resistance() {
    for (output, mains) in [("ac_zero_cross", EUROPE), ("ac_random", AMERICA)] {
        let mut hand = rig(output, mains, 3, QUIET);
        hand.line(mains);
        // 0.6 s are whole cycles of both frequencies; 1 us of error in a sample's time is 0.03 % of phase.
        hand.scales([1.0, 1.0, 2.0, 0.001], (0.5, 50_000));
        let [_, volts, _, amps] = hand.record(50_000);
        let (volts_rms, amps_rms) = (rms(&volts), rms(&amps));
        assert!((volts_rms / mains.0 - 1.0).abs() < 2e-3, "{volts_rms}");
        let power: f64 = volts.iter().zip(&amps).map(|(v, i)| v * i).sum();
        let resistive_ua = power / volts.len() as f64 / volts_rms * 1e6;
        // The fixture itself has 1 nF, and one step of the converter is 2 uA.
        let by_fixture = 21.0 / 20.0;
        let expected_ua = hand.figure("i_leak_capacitive_ua") * by_fixture;
        assert!(
            (amps_rms * 1e6 / expected_ua - 1.0).abs() < 0.01,
            "{amps_rms}"
        );
        let true_ua = hand.figure("i_leak_resistive_ua");
        assert!(
            (resistive_ua - true_ua).abs() < 1.0,
            "{resistive_ua} {true_ua}"
        );
        let whole = hand.figure("i_leak_ua");
        assert!((whole - true_ua.hypot(hand.figure("i_leak_capacitive_ua"))).abs() < 1e-6);
    }
}

#[test]
fn a_zero_cross_part_first_fires_at_its_inhibit_voltage() {
    for mains in [EUROPE, AMERICA] {
        let mut hand = rig("ac_zero_cross", mains, 3, QUIET);
        hand.line(mains);
        hand.scales([1.0, 1.0, 3.0, 0.05], WALK);
        let half_s = 0.5 / mains.1;
        let train = (8.0 * half_s + half_s / 6.0, 4.0 * half_s, 5);
        let [control, volts, clamped, amps] = hand.pulsed(train, WALK.1);
        let edges = begins(&control, |it| it > 2.0);
        assert_eq!(edges.len(), 5, "{edges:?}");
        let (true_us, inhibit_v) = (hand.figure("t_on_us"), hand.figure("v_zc_v"));
        let mut highest_v = 0.0f64;
        for edge in edges {
            let fired = volts[edge..].windows(2).position(|it| {
                let [before_v, after_v] = [it[0], it[1]].map(f64::abs);
                before_v > 3.0 && after_v < 1.6
            });
            let on = edge + fired.expect("it fires") + 1;
            let before_v = volts[on - 1].abs();
            assert!(before_v < inhibit_v + 1.5, "{before_v} {inhibit_v}");
            highest_v = highest_v.max(before_v);
            let conducts = clamped[on + 150].abs();
            assert!((0.8..1.0).contains(&conducts), "{conducts}");
            // An edge inside the window fires the part at once, at a lower voltage.
            if before_v > inhibit_v - 1.5 {
                let peak_v = mains.0 * std::f64::consts::SQRT_2;
                let to_zero_s = (before_v / peak_v).asin() / (std::f64::consts::TAU * mains.1);
                let off_us = to_zero_s * 1e6 + true_us;
                assert!(off_us.abs() < 30.0, "{to_zero_s} {true_us}");
            }
        }
        assert!(
            (highest_v - inhibit_v).abs() < 1.5,
            "{highest_v} {inhibit_v}"
        );
        let later_v = hand.figure("v_retrig_v");
        let on = begins(&amps, |it| it.abs() > 4e-3)[0];
        let cycle = (1e5 / mains.1) as usize;
        let peak = clamped[on + cycle / 4..on + cycle].iter();
        let peak_v = peak.fold(0.0f64, |most, it| most.max(it.abs()));
        assert!(
            (peak_v - later_v).abs() < 0.9 && peak_v < later_v + 0.1,
            "{peak_v} {later_v}"
        );
    }
}

#[test]
fn a_random_part_fires_after_its_delay_at_any_phase() {
    let mut hand = rig("ac_random", EUROPE, 3, QUIET);
    hand.line(EUROPE);
    hand.scales([1.0, 1.0, 3.0, 0.05], (0.05, 50_000));
    let true_us = hand.figure("t_on_us");
    assert!((20.0..60.0).contains(&true_us), "{true_us}");
    assert_eq!(hand.truth("v_zc_v"), serde_json::Value::Null);
    let mut phases = Vec::new();
    for _ in 0..4 {
        hand.wait(3.1);
        let [control, volts, _, _] = hand.pulsed((0.1, 0.03, 1), 50_000);
        let edge = begins(&control, |it| it > 2.0)[0];
        let before_v = volts[edge].abs();
        if before_v < 50.0 {
            continue;
        }
        let on = begins(&volts[edge..], |it| it.abs() < 20.0)[0];
        // 50 ohm in series with the pulse source reduce the input current.
        assert!((on as f64 / true_us - 1.07).abs() < 0.08, "{on} {true_us}");
        phases.push(before_v);
    }
    assert!(phases.len() >= 2, "{phases:?}");
}

#[test]
fn the_current_ends_at_its_zero() {
    for output in ["ac_zero_cross", "ac_random"] {
        let mut hand = rig(output, EUROPE, 3, QUIET);
        hand.line(EUROPE);
        hand.scales([1.0, 1.0, 3.0, 0.05], (0.1, 50_000));
        let [control, volts, _, amps] = hand.pulsed((0.2, 0.0733, 1), 50_000);
        let end = begins(&control, |it| it < 2.0)[0];
        let off = end + begins(&volts[end..], |it| it.abs() > 20.0)[0];
        // Samples of 2 us.
        assert!(off - end < 5_000, "{output}: {}", off - end);
        assert!(amps[off].abs() < 3e-3, "{output}: {}", amps[off]);
        let later = rms(&amps[off + 100..off + 3_000]);
        assert!(later < 2.5e-3, "{output}: {later}");
        assert_eq!(hand.figure("t_off_us"), 0.0);
    }
}

/// Samples of the end of a record in the loop at the rated current: 200 ms.
const LOOPED: usize = 20_000;

/// Returns the end of a record in the loop: voltage over the output, and its current, amperes.
fn looped(hand: &mut Hand, hz: f64) -> [Vec<f64>; 2] {
    hand.in_loop(hz);
    hand.scales([1.0, 0.1, 0.5, 0.02], (0.25, 25_000));
    let [_, _, clamped, shunt] = hand.pulsed((1.0, 0.4, 1), 25_000);
    let from = 25_000 - LOOPED;
    let amps = shunt[from..].iter().map(|it| it / 0.01).collect();
    [clamped[from..].to_vec(), amps]
}

#[test]
fn the_drop_at_rated_current_is_the_true_one() {
    for (output, hz) in [("ac_zero_cross", 50.0), ("ac_random", 60.0)] {
        let mut hand = rig(output, (230.0, hz), 3, QUIET);
        let [volts, amps] = looped(&mut hand, hz);
        let amps_rms = rms(&amps);
        assert!((4.5..5.3).contains(&amps_rms), "{amps_rms}");
        let peak_a = 5.0 * std::f64::consts::SQRT_2;
        let near: Vec<f64> = (0..LOOPED)
            .filter(|n| amps[*n].abs() > 6.0)
            .map(|n| volts[n].abs() + 0.045 * (peak_a - amps[n].abs()))
            .collect();
        let drop_v = near.iter().sum::<f64>() / near.len() as f64;
        let true_v = hand.figure("v_drop_v");
        // The current has warmed the part by some kelvin.
        assert!((drop_v - true_v).abs() < 8e-3, "{drop_v} {true_v}");
        let offset_v = volts.iter().sum::<f64>() / LOOPED as f64;
        let true_mv = hand.figure("dc_offset_mv");
        assert!(
            (offset_v * 1e3 - true_mv).abs() < 2.0,
            "{offset_v} {true_mv}"
        );
    }
}

/// A part whose junction stays cold: the truth is the distortion of a cold part.
const COLD: &str = "[ssr_ac]\njunction_k_per_w_mean = 1e-6\njunction_k_per_w_sd = 0.0\n";

#[test]
fn the_distortion_of_a_cold_part_is_the_true_one() {
    for (output, hz) in [("ac_zero_cross", 50.0), ("ac_random", 60.0)] {
        let world = format!("{QUIET}{COLD}");
        let mut hand = rig(output, (230.0, hz), 3, &world);
        let [volts, _] = looped(&mut hand, hz);
        let distortion_mv = distortion(&volts, hz) * 1e3;
        let true_mv = hand.figure("wave_dist_mv");
        assert!(
            (distortion_mv / true_mv - 1.0).abs() < 0.02,
            "{distortion_mv} {true_mv}"
        );
    }
}

#[test]
fn a_lagging_load_returns_its_voltage_with_a_swing() {
    let mut hand = rig("ac_zero_cross", EUROPE, 3, QUIET);
    hand.set("load_select", true);
    hand.line(EUROPE);
    hand.scales([1.0, 1.0, 3.0, 0.05], (0.1, 50_000));
    let [control, volts, _, amps] = hand.pulsed((0.2, 0.0733, 1), 50_000);
    let end = begins(&control, |it| it < 2.0)[0];
    let off = end + begins(&volts[end..], |it| it.abs() > 20.0)[0];
    let swing = volts[off..off + 500].iter();
    let swing_v = swing.fold(0.0f64, |most, it| most.max(it.abs()));
    // In this millisecond the line grows from 123 V to 200 V; the swing adds to it.
    assert!((220.0..320.0).contains(&swing_v), "{swing_v}");
    let later = rms(&amps[off + 1_000..off + 3_000]);
    assert!(later < 5e-3, "{later}");
}

#[test]
fn a_weak_output_stays_on_behind_a_lagging_load() {
    let world = QUIET.replace(
        "rate_pct = 0.0",
        "rate_pct = 0.0\n[ssr_ac]\ncommutation_v_per_us_mean = 0.1\ncommutation_v_per_us_sd = 0.0",
    );
    for (lags, stays) in [(false, false), (true, true)] {
        let mut hand = rig("ac_zero_cross", EUROPE, 3, &world);
        hand.set("load_select", lags);
        hand.line(EUROPE);
        hand.scales([1.0, 1.0, 3.0, 0.05], (0.2, 50_000));
        let [control, _, _, amps] = hand.pulsed((0.4, 0.0733, 1), 50_000);
        let end = begins(&control, |it| it < 2.0)[0];
        let later = rms(&amps[end + 10_000..]);
        assert_eq!(later > 0.05, stays, "{later}");
    }
}

#[test]
fn a_load_below_the_latching_current_never_fires() {
    // 40 mA through 2.3 kohm need 93 V, which is beyond the window of any zero-cross part.
    let world = QUIET.replace(
        "rate_pct = 0.0",
        "rate_pct = 0.0\n[ssr_ac]\nlatching_ma = 40.0\nholding_ma = 25.0",
    );
    for (output, fires) in [("ac_zero_cross", false), ("ac_random", true)] {
        let mut hand = rig(output, EUROPE, 3, &world);
        hand.line(EUROPE);
        hand.scales([1.0, 1.0, 3.0, 0.05], (0.1, 50_000));
        let [_, volts, _, amps] = hand.pulsed((0.2, 0.09, 1), 50_000);
        let later = rms(&amps[20_000..40_000]);
        assert_eq!(later > 0.05, fires, "{output}: {later}");
        if fires {
            let last = volts[20_000..40_000].iter();
            let peak_v = last.fold(0.0f64, |most, it| most.max(it.abs()));
            assert!((85.0..100.0).contains(&peak_v), "{peak_v}");
        }
    }
}
