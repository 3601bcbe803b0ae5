#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use super::draw::{Draw, Subject};
use super::mode::step_time;
use super::relay::{Contact, Relay, Supply, laws};
use super::specimen::{ContactFilm, Scale, Specimen};
use super::table::WorldTable;
use super::*;

fn config_dir() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../config"))
}

/// The default world without any scatter.
fn still_world() -> WorldTable {
    let mut world = read_world(&config_dir(), None).unwrap();
    world.lot.threshold_scatter_sd_mv = 0.0;
    world.lot.bounce_ln_sd = 0.0;
    world
}

/// The relay of the reference figures: pickup 7.8835 V, release 2.3429 V.
fn reference_relay(world: &WorldTable) -> Relay {
    let scale = Scale { nominal_v: 12.0, nominal_coil_ohm: 400.0 };
    let mut specimen = Specimen::of_lot(world, scale, 1, 0);
    specimen.defect = None;
    specimen.coil_ohm = 400.0;
    specimen.operate_v = 7.883_477;
    specimen.release_v = 2.342_888;
    specimen.operate_ms = 4.7308;
    specimen.release_ms = 2.8650;
    specimen.offset_k = 0.0;
    specimen.film_no = ContactFilm::Steady { median_mohm: 18.0, ln_sd: 0.0 };
    Relay::new(specimen, world, Draw::new(1, Subject::LotOperations, 0), 0.0, 23.0, 23.0)
}

/// First time at or before `t_us` at which a contact reaches a state.
fn first(relay: &mut Relay, t_us: f64, contact: Contact, closed: bool) -> Option<f64> {
    while let Some(change) = relay.advance(t_us) {
        if change.contact == contact && change.closed == closed {
            return Some(change.t_us);
        }
    }
    None
}

/// Ramps from `from_v` at `v_per_s` in steps of 20 us; the voltage at the first change.
fn ramp(relay: &mut Relay, t0_us: f64, from_v: f64, v_per_s: f64, contact: Contact, closed: bool) -> f64 {
    let mut t = t0_us;
    loop {
        let volts = from_v + v_per_s * (t - t0_us + 10.0) * 1e-6;
        assert!((0.0..20.0).contains(&volts), "no event on the ramp");
        relay.drive(t, Supply::Volts(volts));
        t += 20.0;
        if let Some(at) = first(relay, t, contact, closed) {
            return from_v + v_per_s * (at - t0_us) * 1e-6;
        }
    }
}

#[test]
fn operate_time_follows_the_step_voltage_as_the_reference_transients_do() {
    let world = still_world();
    for (volts, expected_ms) in [(9.0, 8.0014), (12.0, 4.7308), (16.0, 3.4236)] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(volts));
        let ms = first(&mut relay, 50_000.0, Contact::No, true).unwrap() / 1000.0;
        assert!((ms - expected_ms).abs() < 0.3, "{volts} V: {ms} ms, expected {expected_ms}");
    }
}

#[test]
fn a_rising_ramp_makes_no_as_late_as_the_reference_transients() {
    let world = still_world();
    for (rate, expected_v) in [(2.0, 7.918_7), (10.0, 8.021_3), (50.0, 8.395_9), (100.0, 8.770_4)] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(7.0));
        while relay.advance(40_000.0).is_some() {}
        let volts = ramp(&mut relay, 40_000.0, 7.0, rate, Contact::No, true);
        assert!((volts - expected_v).abs() < 0.006, "{rate} V/s: {volts} V, expected {expected_v}");
    }
}

#[test]
fn a_falling_ramp_opens_no_as_late_as_the_reference_transients() {
    let world = still_world();
    for (rate, expected_v) in [(2.0, 2.3075), (10.0, 2.1938), (50.0, 1.7419), (100.0, 1.2593)] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(12.0));
        while relay.advance(30_000.0).is_some() {}
        relay.drive(30_000.0, Supply::Volts(3.2));
        while relay.advance(90_000.0).is_some() {}
        let volts = ramp(&mut relay, 90_000.0, 3.2, -rate, Contact::No, false);
        assert!((volts - expected_v).abs() < 0.008, "{rate} V/s: {volts} V, expected {expected_v}");
    }
}

#[test]
fn one_decade_nearer_to_the_threshold_costs_growth_times_ln_ten() {
    let world = still_world();
    let (operate, _) = laws(&world.relay);
    let at = |above: f64| step_time(operate, 0.0, 8.0 * (1.0 + above), 8.0).unwrap();
    let per_decade = at(1e-7) - at(1e-6);
    assert!((per_decade - operate.growth * 10f64.ln()).abs() < 0.05, "{per_decade} ms");
}

#[test]
fn switch_off_into_the_zener_is_quick_and_into_a_diode_slow() {
    let world = still_world();
    let release = |slow: bool, clamp_v: f64| {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(12.0));
        while relay.advance(100_000.0).is_some() {}
        relay.drive(100_000.0, Supply::Off { clamp_v, slow });
        let open = first(&mut relay, 150_000.0, Contact::No, false).unwrap();
        let make = first(&mut relay, 150_000.0, Contact::Nc, true).unwrap();
        ((open - 1e5) / 1000.0, (make - 1e5) / 1000.0)
    };
    let (open, make) = release(false, 60.0);
    assert!((open - 1.96).abs() < 0.1 && (make - 2.865).abs() < 0.05, "{open} {make}");
    let (open, make) = release(true, 0.7);
    assert!((open - 10.29).abs() < 0.5 && (make - 11.73).abs() < 1.0, "{open} {make}");
}

#[test]
fn nc_opens_before_no_makes_and_no_before_nc() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    relay.drive(0.0, Supply::Volts(12.0));
    assert!(first(&mut relay, 40_000.0, Contact::Nc, false).is_some());
    assert!(!relay.is_closed(Contact::No));
    assert!(first(&mut relay, 40_000.0, Contact::No, true).is_some());
}

#[test]
fn a_pulse_that_ends_too_early_lets_nc_close_again_and_never_makes_no() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    relay.drive(0.0, Supply::Volts(12.0));
    assert!(first(&mut relay, 2_400.0, Contact::Nc, false).is_some());
    while relay.advance(2_400.0).is_some() {}
    relay.drive(2_400.0, Supply::Off { clamp_v: 60.0, slow: false });
    assert!(first(&mut relay, 60_000.0, Contact::Nc, true).is_some());
    assert!(first(&mut relay, 60_000.0, Contact::No, true).is_none());
}

#[test]
fn thresholds_and_resistance_follow_the_copper() {
    let world = still_world();
    let specimen = reference_relay(&world).specimen().clone();
    let draw = Draw::new(1, Subject::LotOperations, 0);
    let mut relay = Relay::new(specimen, &world, draw, 0.0, 60.0, 60.0);
    assert!((relay.coil_ohm() - 457.476).abs() < 0.01, "{}", relay.coil_ohm());
    relay.drive(0.0, Supply::Volts(8.9));
    assert!(first(&mut relay, 100_000.0, Contact::No, true).is_none(), "9.016 V at 60 C");
}

#[test]
fn a_held_coil_warms_as_two_heat_stores_do() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    relay.drive(0.0, Supply::Volts(12.0));
    while relay.advance(5e6).is_some() {}
    assert!((relay.coil_ohm() - 402.08).abs() < 0.05, "{} ohm after 5 s", relay.coil_ohm());
}

#[test]
fn the_record_holds_the_bounce_as_it_happened() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    let drawn: f64 = relay.specimen().bounce_no_us.iter().skip(1).step_by(2).sum();
    relay.drive(0.0, Supply::Volts(12.0));
    while relay.advance(40_000.0).is_some() {}
    assert!((relay.record.bounce_ms(Contact::No).unwrap() - drawn / 1000.0).abs() < 1e-6);
    assert!((relay.record.time_ms(Contact::No).unwrap() - 4.7308).abs() < 0.001);
}

#[test]
fn the_lot_scatters_as_the_table_says_and_every_defect_is_in_it() {
    let world = read_world(&config_dir(), None).unwrap();
    let scale = Scale { nominal_v: 12.0, nominal_coil_ohm: 400.0 };
    let lot: Vec<Specimen> = (0..2600).map(|i| Specimen::of_lot(&world, scale, 7, i)).collect();
    let good: Vec<&Specimen> = lot.iter().filter(|s| s.defect.is_none()).collect();
    assert_eq!(lot.len() - good.len(), 104, "4 % of 2600");
    for &kind in defect::Defect::ALL {
        let count = lot.iter().filter(|s| s.defect == Some(kind)).count();
        assert_eq!(count, 8, "{kind:?}");
    }
    let moments = |f: fn(&Specimen) -> f64| {
        let n = good.len() as f64;
        let mean = good.iter().map(|s| f(s)).sum::<f64>() / n;
        (mean, (good.iter().map(|s| (f(s) - mean).powi(2)).sum::<f64>() / n).sqrt())
    };
    for (f, mean, sd) in [
        ((|s| s.operate_v) as fn(&Specimen) -> f64, 7.88, 0.26),
        (|s| s.release_v, 2.35, 0.10),
        (|s| s.coil_ohm, 400.0, 6.0),
        (|s| s.operate_ms, 4.7, 0.25),
        (|s| s.release_ms, 2.9, 0.15),
    ] {
        let (m, s) = moments(f);
        assert!((m - mean).abs() < 4.0 * sd / 50.0 && (s / sd - 1.0).abs() < 0.06, "{m} {s}");
    }
}

/// A hand on the terminals: commands by name, time in milliseconds.
struct Hand {
    world: World,
    rig: RigFile,
    bits: std::collections::BTreeMap<String, u16>,
    t_us: u64,
}

impl Hand {
    fn new(options: WorldOptions) -> Self {
        let rig = read_rig(&config_dir()).unwrap();
        let world = World::build(&options).unwrap();
        Self { world, rig, bits: std::collections::BTreeMap::new(), t_us: 0 }
    }

    fn set(&mut self, point: &str, on: bool) {
        let terminal = self.rig.digital_out[point].clone();
        let bits = self.bits.entry(terminal.module.clone()).or_default();
        *bits = if on { *bits | 1 << terminal.channel } else { *bits & !(1 << terminal.channel) };
        self.world.digital_out(&terminal.module, *bits);
    }

    fn wait(&mut self, ms: f64) {
        self.t_us += (ms * 1000.0) as u64;
        self.world.advance(self.t_us);
    }

    fn pulse(&mut self, point: &str, ms: f64) {
        self.set(point, true);
        self.wait(ms);
        self.set(point, false);
    }

    fn sees(&mut self, point: &str) -> bool {
        let terminal = self.rig.digital_in[point].clone();
        let high = self.world.digital_in(&terminal.module) >> terminal.channel & 1 == 1;
        high != terminal.active_low
    }

    fn level(&mut self, supply_v: f64) {
        self.world.analog_out("ao_level", supply_v / 1.5);
    }

    fn reads(&mut self, point: &str) -> f64 {
        let t = self.rig.analog_in[point].clone();
        self.world.analog_in(&t.module, t.channel) / t.gain
    }

    fn gate_ms(&mut self, point: &str) -> f64 {
        let t = self.rig.counter[point].clone();
        self.world.gate_open_us(&t.module, t.channel) / 1000.0
    }

    fn axis(&mut self, point: u8) {
        for (i, name) in ["axis_point_0", "axis_point_1", "axis_point_2"].into_iter().enumerate() {
            self.set(name, point >> i & 1 == 1);
        }
        self.pulse("axis_drive", 900.0);
        assert!(self.sees("axis_in_position"));
    }

    /// Magazine to nest, clamped, probes up.
    fn feed(&mut self) {
        self.pulse("escapement_release", 300.0);
        assert!(self.sees("pocket_present"));
        self.pulse("pusher_extend", 500.0);
        assert!(self.sees("nest_present") && !self.sees("pocket_present"));
        self.wait(500.0);
        self.pulse("clamp_close", 200.0);
        assert!(self.sees("jaw_left_closed") && self.sees("jaw_right_closed"));
        self.set("probe_lift", true);
        self.wait(250.0);
        assert!(self.sees("probe_up") && self.sees("probe_chain"));
    }

    /// Nest to bin, axis back at the nest.
    fn sort(&mut self, point: u8) {
        self.set("axis_servo_on", true);
        self.axis(0);
        self.set("sort_z_lower", true);
        self.wait(400.0);
        self.pulse("gripper_close", 200.0);
        assert!(self.sees("gripper_part"));
        self.set("probe_lift", false);
        self.wait(250.0);
        self.pulse("clamp_open", 200.0);
        self.set("sort_z_lower", false);
        self.wait(400.0);
        assert!(!self.sees("nest_present") && self.sees("sort_z_up"));
        self.axis(point);
        self.pulse("gripper_release", 500.0);
        self.axis(0);
    }
}

fn options(golden: bool) -> WorldOptions {
    WorldOptions {
        config_dir: config_dir(),
        seed: 3,
        recipe: "jzc-22f-012".into(),
        parts: Some(3),
        golden,
        ..WorldOptions::default()
    }
}

/// Terminal of the beam over a bin.
fn beam(hand: &Hand, bin: &str) -> (String, u8) {
    let name = &hand.rig.bins.iter().find(|b| b.name == bin).unwrap().beam;
    let t = &hand.rig.digital_in[name];
    (t.module.clone(), t.channel)
}

#[test]
fn a_part_goes_by_hand_from_the_magazine_through_a_timed_test_into_its_bin() {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.set("kelvin_test", true);
    assert!(hand.sees("kelvin_com") && hand.sees("kelvin_no") && hand.sees("nc_closed"));
    hand.level(12.0);
    hand.set("select_no", true);
    hand.set("arm", true);
    hand.wait(1.0);
    let before = hand.gate_ms("gate_0");
    let before_1 = hand.gate_ms("gate_1");
    hand.set("coil_drive", true);
    hand.wait(40.0);
    assert!(hand.sees("latch") && hand.sees("no_closed") && !hand.sees("nc_closed"));
    assert!((hand.reads("coil_voltage") - 12.0).abs() < 1e-9);
    assert!((hand.reads("coil_current") - 0.03).abs() < 0.002);
    let operate = hand.gate_ms("gate_0") - before;
    let bounce = hand.gate_ms("gate_1") - before_1 - operate;
    hand.set("source_on", true);
    hand.wait(10.0);
    let plus = hand.reads("contact_drop");
    hand.set("source_reverse", true);
    hand.wait(10.0);
    let mohm = (plus - hand.reads("contact_drop")) / 2.0 * 1000.0;
    hand.set("source_on", false);
    hand.set("coil_drive", false);
    hand.wait(50.0);
    assert!(hand.sees("nc_closed") && !hand.sees("no_closed"));
    hand.sort(4);
    let (module, channel) = beam(&hand, "voltage");
    assert_eq!(hand.world.edges(&module, channel), 1);
    let truth = &hand.world.truth()[0];
    let value = |key: &str| truth[key].as_f64().unwrap();
    assert_eq!(truth["seq"], 1);
    assert_eq!(truth["landed_in"], "voltage");
    assert!((value("operate_time_ms") - operate).abs() < 0.011, "gate delay within 10 us");
    assert!((value("operate_bounce_ms") - bounce).abs() < 0.021);
    assert!((value("contact_resistance_no_mohm") / mohm - 1.0).abs() < 0.0015);
    assert!(hand.world.crashes().is_empty(), "{:?}", hand.world.crashes());
}

#[test]
fn golden_parts_come_first_and_are_not_in_the_truth() {
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
fn the_source_goes_off_two_milliseconds_before_the_drive_changes() {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.set("source_on", true);
    hand.wait(10.0);
    assert!((hand.reads("contact_current") - 1.0).abs() < 0.0011);
    hand.level(12.0);
    hand.set("coil_drive", true);
    hand.wait(1.9);
    assert_eq!(hand.reads("contact_current"), 0.0);
    assert_eq!(hand.reads("coil_voltage"), 0.0);
    hand.wait(0.2);
    assert!((hand.reads("coil_voltage") - 12.0).abs() < 1e-9);
}

#[test]
fn nothing_is_driven_without_the_probe_up_chain() {
    let mut hand = Hand::new(options(false));
    hand.level(12.0);
    hand.set("coil_drive", true);
    hand.wait(10.0);
    assert_eq!(hand.reads("coil_voltage"), 0.0);
    assert!((hand.reads("supply_voltage") - 12.0).abs() < 1e-9);
}

#[test]
fn arm_on_the_reference_contact_gives_a_pulse_of_one_millisecond_on_both_gates() {
    let mut hand = Hand::new(options(false));
    hand.set("reference_contact", true);
    hand.pulse("arm", 5.0);
    for gate in ["gate_0", "gate_1"] {
        let ms = hand.gate_ms(gate);
        assert!((ms - 1.0).abs() <= 0.010, "{gate}: {ms}");
    }
}

#[test]
fn a_ramp_starts_the_window_when_the_supply_has_moved_fifty_millivolts() {
    let mut hand = Hand::new(options(false));
    hand.level(5.0);
    hand.set("ramp_mode", true);
    hand.set("select_no", true);
    hand.set("arm", true);
    hand.world.analog_out("ao_fine", 0.049 / 1.5);
    hand.wait(1.0);
    assert!(!hand.sees("window"));
    hand.world.analog_out("ao_fine", 0.051 / 1.5);
    assert!(hand.sees("window"));
}

#[test]
fn the_pusher_against_raised_probes_is_a_crash() {
    let mut hand = Hand::new(options(false));
    hand.set("probe_lift", true);
    hand.wait(300.0);
    hand.set("pusher_extend", true);
    hand.wait(10.0);
    assert_eq!(hand.world.crashes().len(), 1);
}

#[test]
fn without_air_the_pusher_returns_and_the_clamp_stays() {
    let mut o = options(false);
    o.faults = vec![("air".into(), 3.0)];
    let mut hand = Hand::new(o);
    hand.pulse("clamp_close", 300.0);
    hand.set("pusher_extend", true);
    hand.wait(1000.0);
    assert!(hand.sees("pusher_extended"));
    hand.wait(2500.0);
    assert!(!hand.sees("air_ok") && hand.sees("pusher_retracted") && hand.sees("jaw_left_closed"));
}

#[test]
fn a_double_part_darkens_the_beam_twice_and_a_fallen_one_lands_nowhere() {
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
fn a_jammed_pusher_goes_through_at_the_second_stroke() {
    let mut o = options(false);
    o.faults = vec![("jam_pusher".into(), 1.0)];
    let mut hand = Hand::new(o);
    hand.pulse("escapement_release", 300.0);
    hand.pulse("pusher_extend", 800.0);
    assert!(!hand.sees("pusher_extended") && !hand.sees("nest_present"));
    hand.wait(800.0);
    hand.pulse("pusher_extend", 800.0);
    assert!(hand.sees("nest_present"));
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
fn an_unknown_key_of_a_world_file_is_named_with_file_and_line() {
    let path = std::env::temp_dir().join(format!("rigsim-world-{}.toml", std::process::id()));
    std::fs::write(&path, "[lot]\noperate_v_mean = 7.7\noperate_v_men = 7.8\n").unwrap();
    let error = read_world(&config_dir(), Some(&path)).unwrap_err().to_string();
    std::fs::write(&path, "[lot]\noperate_v_mean = 7.7\n").unwrap();
    let world = read_world(&config_dir(), Some(&path)).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(error.contains(".toml:3: unknown field `operate_v_men`"), "{error}");
    assert_eq!(world.lot.operate_v_mean, 7.7);
    assert_eq!(world.lot.release_v_mean, 2.35);
}
