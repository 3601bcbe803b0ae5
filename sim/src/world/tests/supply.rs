//! Tests of the coil supply and its ranges under manual control.

use super::hand::{Hand, options};
use super::resistor::{dummies, folder};
use super::*;
use crate::journal::{Entry, JournaledWorld};
use crate::truth::Overdrive;

/// Code, factor, volts and milliampere of each range in `config/rig.toml`.
const RANGES: [(u8, f64, f64, f64); 4] = [
    (0, 0.5, 7.5, 150.0),
    (1, 1.0, 15.0, 150.0),
    (2, 2.0, 30.0, 75.0),
    (3, 4.0, 60.0, 40.0),
];

fn near(found: f64, expected: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(
        off <= 1e-9 * expected.abs(),
        "{what}: {found}, expected {expected}"
    );
}

/// Returns a rig in a range with a resistor of `ohm` on its probes.
fn resistor(ohm: f64, code: u8) -> Hand {
    let folder = folder("resistor");
    let world = folder.path().join("world.toml");
    let text =
        format!("[resistor]\nnominal_ohm = {ohm}\ntolerance_sd_pct = 0.0\ndefects_pct = 0.0\n");
    std::fs::write(&world, text).unwrap();
    let mut hand = Hand::new(WorldOptions {
        world_file: Some(world.clone()),
        ..dummies(&folder)
    });
    hand.feed();
    hand.range(code);
    hand
}

#[test]
fn the_relays_report_the_range_after_five_milliseconds() {
    let mut hand = Hand::new(options(false));
    for code in [3, 2, 0, 1] {
        let before = hand.range_set();
        hand.set("supply_range_0", code & 1 != 0);
        hand.set("supply_range_1", code & 2 != 0);
        hand.wait(4.9);
        assert_eq!(hand.range_set(), before);
        hand.wait(0.2);
        assert_eq!(hand.range_set(), code);
    }
}

#[test]
fn a_rig_starts_in_range_code_zero() {
    let mut world = World::build(&options(false)).unwrap();
    world.analog_out("ao_level", 0, 4.0);
    near(world.analog_in("coil_ai", 4), 3.0 * 0.15, "supply");
}

#[test]
fn a_driven_coil_keeps_its_range() {
    let mut hand = Hand::new(options(false));
    for fed in [false, true] {
        if fed {
            hand.feed();
        }
        hand.set("coil_drive", true);
        hand.range(2);
        assert_eq!(hand.range_set(), 1);
        hand.set("coil_drive", false);
        hand.wait(6.0);
        assert_eq!(hand.range_set(), 2);
        hand.range(1);
    }
}

#[test]
fn each_source_above_zero_keeps_the_range() {
    let mut hand = Hand::new(options(false));
    for source in ["ao_level", "ao_coarse", "ao_fine"] {
        hand.world.analog_out(source, 0, 0.021);
        hand.range(3);
        assert_eq!(hand.range_set(), 1, "{source}");
        hand.world.analog_out(source, 0, 0.019);
        hand.wait(6.0);
        assert_eq!(hand.range_set(), 3, "{source}");
        hand.range(1);
    }
}

#[test]
fn a_source_that_moves_starts_the_change_anew() {
    let mut hand = Hand::new(options(false));
    hand.set("supply_range_1", true);
    hand.wait(4.0);
    hand.level(1.0);
    hand.wait(4.0);
    hand.level(0.0);
    hand.wait(4.0);
    assert_eq!(hand.range_set(), 1);
    hand.wait(2.0);
    assert_eq!(hand.range_set(), 3);
}

#[test]
fn supply_and_coil_voltage_scale_with_the_range() {
    for (code, factor, ..) in RANGES {
        let mut hand = resistor(6400.0, code);
        hand.world.analog_out("ao_level", 0, 4.0);
        hand.set("coil_drive", true);
        hand.wait(1.0);
        let terminal = |hand: &mut Hand, channel| hand.world.analog_in("coil_ai", channel);
        near(terminal(&mut hand, 0), 6.0 * 0.6, "coil voltage");
        near(terminal(&mut hand, 5), 6.0 * 1.6, "coil voltage, fine");
        near(terminal(&mut hand, 4), 6.0 * factor * 0.15, "supply");
        let amperes = hand.value("coil_current_fine");
        assert!((amperes / (6.0 * factor / 6400.0) - 1.0).abs() < 0.002);
    }
}

#[test]
fn each_range_limits_its_voltage_and_current() {
    for (code, _, max_v, max_ma) in RANGES {
        let mut hand = resistor(2.0, code);
        for source in ["ao_level", "ao_coarse"] {
            hand.world.analog_out(source, 0, 9.0);
        }
        hand.set("coil_drive", true);
        hand.wait(1.0);
        near(hand.value("supply_voltage"), max_v, "supply");
        near(hand.value("coil_current_high"), max_ma * 1e-3, "current");
    }
}

#[test]
fn the_movement_that_starts_a_ramp_scales() {
    for (code, ..) in RANGES {
        let mut hand = Hand::new(options(false));
        hand.range(code);
        for point in ["ramp_mode", "select_no", "arm"] {
            hand.set(point, true);
        }
        hand.world.analog_out("ao_fine", 0, 0.049 / 1.5);
        hand.wait(1.0);
        assert!(!hand.is_on("window"));
        hand.world.analog_out("ao_fine", 0, 0.051 / 1.5);
        assert!(hand.is_on("window"));
    }
}

/// Returns operate and release time of the first part, ms, from nominal voltage.
fn times(recipe: &str, nominal_v: f64, code: u8) -> [f64; 2] {
    let mut hand = Hand::new(WorldOptions {
        recipe: recipe.into(),
        ..options(false)
    });
    hand.feed();
    hand.range(code);
    hand.level(nominal_v);
    hand.set("coil_drive", true);
    hand.wait(60.0);
    hand.set("coil_drive", false);
    hand.wait(60.0);
    let truth = hand.world.truth();
    ["operate_time_ms", "release_time_ms"].map(|key| truth[0][key].as_f64().unwrap())
}

#[test]
fn scaled_parts_switch_alike_into_the_scaled_zener() {
    let [operate, release] = times("jzc-22f-012", 12.0, 1);
    for (recipe, nominal_v, code) in [
        ("jzc-22f-006", 6.0, 0),
        ("jzc-22f-024", 24.0, 2),
        ("jzc-22f-048", 48.0, 3),
    ] {
        let other = times(recipe, nominal_v, code);
        assert!(
            (other[0] / operate - 1.0).abs() < 2e-3,
            "{recipe}: {other:?}"
        );
        assert!(
            (other[1] / release - 1.0).abs() < 2e-3,
            "{recipe}: {other:?}"
        );
    }
    let narrow = times("jzc-22f-006", 6.0, 1);
    assert!(narrow[1] < release * 0.99, "60 V: {} ms", narrow[1]);
}

/// Creates a configuration folder whose rig has no ranges of the supply.
fn without_ranges() -> tempfile::TempDir {
    let folder = folder("resistor");
    let path = folder.path().join("rig.toml");
    let mut rig: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
    rig.remove("supply_range").unwrap();
    for (section, suffix) in [("digital_out", ""), ("digital_in", "_set")] {
        let points = rig[section].as_table_mut().unwrap();
        for bit in 0..2 {
            points
                .remove(&format!("supply_range_{bit}{suffix}"))
                .unwrap();
        }
    }
    std::fs::write(&path, rig.to_string()).unwrap();
    folder
}

#[test]
fn a_rig_without_ranges_has_limits_of_its_world() {
    let folder = without_ranges();
    let mut hand = Hand::new(dummies(&folder));
    hand.feed();
    hand.level(4.0);
    hand.set("coil_drive", true);
    hand.wait(1.0);
    near(hand.value("coil_voltage"), 4.0, "coil");
    for source in ["ao_level", "ao_coarse", "ao_fine"] {
        hand.world.analog_out(source, 0, 10.0);
    }
    near(hand.value("supply_voltage"), 20.0, "supply");
}

/// Returns a rig whose range relays stick at this code, with a part on its probes and range 1 commanded.
fn stuck(code: f64, reference_parts: bool) -> Hand {
    let mut hand = Hand::new(WorldOptions {
        faults: vec![("supply_range_stuck".into(), code)],
        ..options(reference_parts)
    });
    hand.feed();
    hand
}

#[test]
fn relays_stuck_above_overdrive_a_coil() {
    let mut hand = stuck(2.0, false);
    assert_eq!(hand.range_set(), 2);
    hand.level(12.0);
    assert!(hand.world.overdrives().is_empty(), "not driven");
    hand.set("coil_drive", true);
    hand.wait(1.0);
    near(hand.value("supply_voltage"), 24.0, "supply");
    near(
        hand.value("coil_voltage"),
        12.0,
        "reads like the commanded range",
    );
    hand.level(12.1);
    let expected = Overdrive {
        t_us: hand.t_us - 1000,
        commanded: 1,
        range: 2,
        supply_v: 24.0,
    };
    assert_eq!(hand.world.overdrives(), [expected], "one drive, one entry");
}

#[test]
fn relays_stuck_below_do_not_overdrive() {
    let mut hand = stuck(0.0, false);
    assert_eq!(hand.range_set(), 0);
    hand.level(12.0);
    hand.set("coil_drive", true);
    hand.wait(1.0);
    near(hand.value("supply_voltage"), 6.0, "supply");
    assert!(hand.world.overdrives().is_empty());
}

#[test]
fn a_drive_without_a_coil_overdrives_nothing() {
    let mut hand = stuck(3.0, false);
    hand.set("reference_coil", true);
    hand.level(5.0);
    hand.set("coil_drive", true);
    hand.wait(1.0);
    assert!(hand.world.overdrives().is_empty());
    hand.set("reference_coil", false);
    assert_eq!(hand.world.overdrives().len(), 1);
}

#[test]
fn a_lead_of_the_source_is_no_overdrive() {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.level(12.0);
    hand.set("source_on", true);
    hand.set("coil_drive", true);
    hand.set("select_no", true);
    hand.wait(40.0);
    assert!(hand.value("contact_current") > 0.9);
    let source_on_no = 1 << 2 | 1 << 3;
    hand.world.digital_out("board_do", source_on_no);
    hand.wait(1.0);
    assert!(hand.value("coil_voltage") > 11.9, "the drive lasts longer");
    hand.wait(10.0);
    assert!(hand.world.overdrives().is_empty());
}

#[test]
fn the_range_sticks_after_the_reference_parts() {
    let mut hand = stuck(3.0, true);
    assert_eq!(hand.range_set(), 1);
    for _ in 0..5 {
        hand.sort(7);
        hand.feed();
    }
    assert_eq!(hand.range_set(), 3);
}

#[test]
fn an_overdriven_coil_is_in_the_journal() {
    let mut hand = stuck(3.0, false);
    hand.level(12.0);
    let bits = hand.bits["board_do"];
    let mut journal = JournaledWorld::new(Box::new(hand.world));
    let entries = journal.listen();
    journal.digital_out("board_do", bits | 1);
    journal.advance(hand.t_us + 1000);
    let entries: Vec<_> = entries.try_iter().collect();
    let [Entry::Output { .. }, Entry::CoilOverdriven(overdrive)] = entries[..] else {
        panic!("{entries:?}");
    };
    assert_eq!((overdrive.commanded, overdrive.range), (1, 3));
    let line = serde_json::to_value(&entries[1]).unwrap();
    assert_eq!(line["type"], "coil_overdriven");
    assert_eq!(line["supply_v"], 48.0);
}

#[test]
fn an_unknown_range_cannot_be_stuck() {
    let stuck_in = |code, folder: &std::path::Path| {
        let options = WorldOptions {
            files: folder.into(),
            faults: vec![("supply_range_stuck".into(), code)],
            recipe: "dummy".into(),
            ..options(false)
        };
        World::build(&options).unwrap_err().to_string()
    };
    let (ranged, single) = (folder("resistor"), without_ranges());
    let error = stuck_in(4.0, ranged.path());
    assert!(
        error.ends_with("found 4, expected the code of a range: 0, 1, 2, 3"),
        "{error}"
    );
    let error = stuck_in(0.0, single.path());
    assert!(error.ends_with("the rig has no [supply_range]"), "{error}");
}
