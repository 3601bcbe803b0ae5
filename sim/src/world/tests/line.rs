//! Tests of the line under manual control of its terminals.

use super::hand::{Hand, options};
use super::*;
use crate::config::read_world;

/// Returns the terminal of the beam of a bin.
fn beam(hand: &Hand, bin: &str) -> (String, u8) {
    let name = &hand.rig.bins.iter().find(|b| b.name == bin).unwrap().beam;
    let t = &hand.rig.digital_in[name];
    (t.module.clone(), t.channel)
}

#[test]
fn a_part_passes_magazine_timed_test_and_bin() {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.set("kelvin_test", true);
    assert!(hand.is_on("kelvin_com") && hand.is_on("kelvin_no") && hand.is_on("nc_closed"));
    hand.level(12.0);
    hand.set("select_no", true);
    hand.set("arm", true);
    hand.wait(1.0);
    let before = hand.gate_ms("gate_0");
    let before_1 = hand.gate_ms("gate_1");
    hand.set("coil_drive", true);
    hand.wait(40.0);
    assert!(hand.is_on("latch") && hand.is_on("no_closed") && !hand.is_on("nc_closed"));
    assert!((hand.value("coil_voltage") - 12.0).abs() < 1e-9);
    assert!((hand.value("coil_current") - 0.03).abs() < 0.002);
    let operate = hand.gate_ms("gate_0") - before;
    let bounce = hand.gate_ms("gate_1") - before_1 - operate;
    hand.set("source_on", true);
    hand.wait(10.0);
    let plus = hand.value("contact_drop");
    hand.set("source_reverse", true);
    hand.wait(10.0);
    let mohm = (plus - hand.value("contact_drop")) / 2.0 * 1000.0;
    hand.set("source_on", false);
    hand.set("coil_drive", false);
    hand.wait(50.0);
    assert!(hand.is_on("nc_closed") && !hand.is_on("no_closed"));
    hand.sort(4);
    let (module, channel) = beam(&hand, "voltage");
    assert_eq!(hand.world.edges(&module, channel), 1);
    let truth = &hand.world.truth()[0];
    let value = |key: &str| truth[key].as_f64().unwrap();
    assert_eq!(truth["seq"], 1);
    assert_eq!(truth["landed_in"], "voltage");
    assert!(
        (value("operate_time_ms") - operate).abs() < 0.011,
        "gate delay within 10 us"
    );
    assert!((value("operate_bounce_ms") - bounce).abs() < 0.021);
    assert!((value("contact_resistance_no_mohm") / mohm - 1.0).abs() < 0.0015);
    assert!(
        hand.world.crashes().is_empty(),
        "{:?}",
        hand.world.crashes()
    );
}

#[test]
fn reference_parts_come_first_and_leave_no_truth() {
    let mut hand = Hand::new(options(true));
    for _ in 0..5 {
        hand.feed();
        hand.sort(7);
    }
    assert!(hand.world.truth().is_empty());
    hand.feed();
    assert_eq!(hand.world.truth().len(), 1);
}

#[test]
fn the_source_switches_off_before_the_drive_changes() {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.set("source_on", true);
    hand.wait(10.0);
    assert!((hand.value("contact_current") - 1.0).abs() < 0.0011);
    hand.level(12.0);
    hand.set("coil_drive", true);
    hand.wait(1.9);
    assert_eq!(hand.value("contact_current"), 0.0);
    assert_eq!(hand.value("coil_voltage"), 0.0);
    hand.wait(0.2);
    assert!((hand.value("coil_voltage") - 12.0).abs() < 1e-9);
}

#[test]
fn nothing_is_driven_without_the_probe_up_chain() {
    let mut hand = Hand::new(options(false));
    hand.level(12.0);
    hand.set("coil_drive", true);
    hand.wait(10.0);
    assert_eq!(hand.value("coil_voltage"), 0.0);
    assert!((hand.value("supply_voltage") - 12.0).abs() < 1e-9);
}

#[test]
fn arm_on_the_reference_pulses_both_gates() {
    let mut hand = Hand::new(options(false));
    hand.set("reference_contact", true);
    hand.pulse("arm", 5.0);
    for gate in ["gate_0", "gate_1"] {
        let ms = hand.gate_ms(gate);
        assert!((ms - 1.0).abs() <= 0.010, "{gate}: {ms}");
    }
}

#[test]
fn a_ramp_opens_the_window_after_fifty_millivolts() {
    let mut hand = Hand::new(options(false));
    hand.level(5.0);
    hand.set("ramp_mode", true);
    hand.set("select_no", true);
    hand.set("arm", true);
    hand.world.analog_out("ao_fine", 0, 0.049 / 1.5);
    hand.wait(1.0);
    assert!(!hand.is_on("window"));
    hand.world.analog_out("ao_fine", 0, 0.051 / 1.5);
    assert!(hand.is_on("window"));
}

#[test]
fn without_air_the_pusher_returns_and_the_jaws_hold() {
    let mut o = options(false);
    o.faults = vec![("air".into(), 3.0)];
    let mut hand = Hand::new(o);
    hand.pulse("clamp_close", 300.0);
    hand.set("pusher_extend", true);
    hand.wait(1000.0);
    assert!(hand.is_on("pusher_extended"));
    hand.wait(2500.0);
    assert!(
        !hand.is_on("air_ok") && hand.is_on("pusher_retracted") && hand.is_on("jaw_left_closed")
    );
}

#[test]
fn double_part_darkens_twice_and_fallen_part_lands_nowhere() {
    let mut o = options(false);
    o.faults = vec![("double_part".into(), 1.0), ("fall".into(), 2.0)];
    let mut hand = Hand::new(o);
    for _ in 0..2 {
        hand.feed();
        hand.sort(2);
    }
    let (module, channel) = beam(&hand, "pass");
    assert_eq!(hand.world.edges(&module, channel), 2);
    let truth = hand.world.truth();
    assert_eq!(truth[0]["landed_in"], "pass");
    assert!(truth[1]["landed_in"].is_null());
}

#[test]
fn a_jammed_pusher_succeeds_at_the_second_stroke() {
    let mut o = options(false);
    o.faults = vec![("jam_pusher".into(), 1.0)];
    let mut hand = Hand::new(o);
    hand.pulse("escapement_release", 300.0);
    hand.pulse("pusher_extend", 800.0);
    assert!(!hand.is_on("pusher_extended") && !hand.is_on("nest_present"));
    hand.wait(800.0);
    hand.pulse("pusher_extend", 800.0);
    assert!(hand.is_on("nest_present"));
    assert_eq!(hand.world.crashes(), Vec::<String>::new());
}

#[test]
fn the_same_seed_and_stimuli_give_the_same_world() {
    let run = || {
        let mut hand = Hand::new(options(false));
        hand.feed();
        hand.level(12.0);
        hand.set("coil_drive", true);
        hand.wait(40.0);
        hand.set("coil_drive", false);
        hand.wait(40.0);
        hand.sort(2);
        (hand.world.truth(), hand.gate_ms("gate_0").to_bits())
    };
    assert_eq!(run(), run());
}

#[test]
fn an_unknown_world_key_names_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("world.toml");
    std::fs::write(&path, "[lot]\noperate_v_mean = 7.7\noperate_v_men = 7.8\n").unwrap();
    let error = read_world(&files(), Some(&path)).unwrap_err().to_string();
    std::fs::write(&path, "[lot]\noperate_v_mean = 7.7\n").unwrap();
    let world = read_world(&files(), Some(&path)).unwrap();
    assert!(
        error.contains(
            ".toml:3: lot.operate_v_men: found an unknown key, expected one of bounce_ln_sd, "
        ),
        "{error}"
    );
    let lot = world.lot.unwrap();
    assert_eq!(lot.operate_v_mean, 7.7);
    assert_eq!(lot.release_v_mean, 2.35);
}

#[test]
fn a_timed_release_ends_with_the_first_nc_make() {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.level(12.0);
    hand.set("coil_drive", true);
    hand.wait(40.0);
    hand.set("arm", true);
    hand.wait(1.0);
    let before = (hand.gate_ms("gate_0"), hand.gate_ms("gate_1"));
    hand.set("coil_drive", false);
    hand.wait(40.0);
    let release = hand.gate_ms("gate_0") - before.0;
    let bounce = hand.gate_ms("gate_1") - before.1 - release;
    let truth = &hand.world.truth()[0];
    assert!((truth["release_time_ms"].as_f64().unwrap() - release).abs() < 0.011);
    assert!((truth["release_bounce_ms"].as_f64().unwrap() - bounce).abs() < 0.021);
}

#[test]
fn a_falling_ramp_latches_on_the_break_of_no() {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.level(12.0);
    for point in ["select_no", "ramp_mode", "event_no_break", "coil_drive"] {
        hand.set(point, true);
    }
    hand.wait(40.0);
    hand.level(4.0);
    hand.wait(60.0);
    hand.set("arm", true);
    hand.wait(1.0);
    let before = hand.gate_ms("gate_0");
    let mut volts = 4.0;
    while !hand.is_on("latch") {
        volts -= 0.0015;
        assert!(volts > 0.5, "no release");
        hand.level(volts);
        hand.wait(1.0);
    }
    let seen = 4.0 - 0.0015 * (hand.gate_ms("gate_0") - before) - 0.050;
    let truth = hand.world.truth()[0]["release_voltage_v"].as_f64().unwrap();
    assert!(
        (seen - truth).abs() < 0.12,
        "overshoot and temperature: {seen} against {truth}"
    );
}

#[test]
fn a_drifting_emf_moves_contact_drop_but_not_reference() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("world.toml");
    std::fs::write(&path, "[board]\nemf_drift_uv_per_s = 5000.0\n").unwrap();
    let mut hand = Hand::new(WorldOptions {
        world_file: Some(path.clone()),
        ..options(false)
    });
    hand.feed();
    let first = hand.value("contact_drop");
    hand.wait(100.0);
    let moved = hand.value("contact_drop") - first;
    assert!((moved - 0.0005).abs() < 1e-12, "{moved}");
    hand.set("reference_contact", true);
    let first = hand.value("contact_drop");
    hand.wait(100.0);
    assert_eq!(hand.value("contact_drop"), first);
}
