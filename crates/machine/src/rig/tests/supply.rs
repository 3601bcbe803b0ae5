//! Ranges of the supply: what `rig.toml` may say, which one serves a demand, and what a range changes.

use crate::rig::settings::RigSettings;
use crate::rig::supply::{READ_BACK, RangeMismatch, SELECT, SupplyDemand, code_of};
use crate::rig::wiring::Wiring;
use units::{Ampere, Volt};

fn settings() -> RigSettings {
    toml::from_str(include_str!("../../../../../config/rig.toml")).unwrap()
}

fn resolved(change: impl Fn(&mut RigSettings)) -> Result<Wiring, String> {
    let mut settings = settings();
    change(&mut settings);
    let wiring = Wiring::resolve(&settings, crate::dut::FIXTURES);
    wiring.map_err(|fault| fault.to_string())
}

fn shipped() -> Wiring {
    resolved(|_| {}).unwrap()
}

/// The shipped rig without its ranges.
fn one_range(settings: &mut RigSettings) {
    settings.supply_range.clear();
    for name in SELECT {
        settings.digital_out.remove(name);
    }
    for name in READ_BACK {
        settings.digital_in.remove(name);
    }
}

fn demand(volts: f64, milliampere: f64) -> SupplyDemand {
    SupplyDemand {
        volts: Volt(volts),
        volts_key: "part.nominal_v",
        current: Ampere(milliampere * 1e-3),
        current_key: "part.nominal_coil_ohm",
    }
}

fn served(wiring: &Wiring, volts: f64, milliampere: f64) -> Result<String, String> {
    let asked = demand(volts, milliampere);
    let range = asked.range(wiring).map(|range| range.name.clone());
    range.map_err(|fault| fault.to_string())
}

#[test]
fn the_smallest_range_that_serves_is_chosen() {
    let wiring = shipped();
    for (volts, milliampere, range) in [
        (3.0, 133.3, "x0_75"),
        (7.5, 150.0, "x0_75"),
        (7.6, 150.0, "x1_5"),
        (18.0, 22.0, "x3"),
        (48.0, 8.3, "x6"),
    ] {
        assert_eq!(served(&wiring, volts, milliampere).unwrap(), range);
    }
}

#[test]
fn a_demand_beyond_every_range_names_the_limit() {
    let wiring = shipped();
    assert_eq!(
        served(&wiring, 61.0, 5.0).unwrap_err(),
        "part.nominal_v: found 61.00 V at the supply, expected at most 60 V: rig.toml supply_range.x6.max_v"
    );
    assert_eq!(
        served(&wiring, 24.0, 80.0).unwrap_err(),
        "part.nominal_coil_ohm: found 80.0 mA at 24.00 V, expected at most 75.0 mA: \
         rig.toml supply_range.x3.max_ma"
    );
}

#[test]
fn a_rig_without_ranges_has_that_of_its_sources() {
    let wiring = resolved(one_range).unwrap();
    assert!(wiring.range_selector().is_none());
    assert_eq!(wiring.supply_ranges.len(), 1);
    assert!(served(&wiring, 15.0, 1e6).is_ok());
    let refused = served(&wiring, 15.1, 1.0).unwrap_err();
    assert!(refused.contains("expected at most 15 V: the full scale of module ao_"));
}

#[test]
fn a_range_scales_sources_and_the_inputs_behind_them() {
    let wiring = shipped();
    let ranged = wiring.in_range(demand(48.0, 8.0).range(&wiring).unwrap());
    let source = |wiring: &Wiring, name| {
        let point = wiring.analog_output(name).unwrap();
        wiring.analog_out(point).gain
    };
    let input = |wiring: &Wiring, name| {
        let point = wiring.analog_input(name).unwrap();
        wiring.analog_in(point).gain
    };
    for name in ["supply_level", "supply_coarse", "supply_fine"] {
        assert_eq!(source(&ranged, name), 4.0 * source(&wiring, name));
    }
    for (name, factor) in [
        ("coil_voltage", 4.0),
        ("coil_voltage_fine", 4.0),
        ("supply_voltage", 1.0),
        ("coil_current", 1.0),
    ] {
        assert_eq!(input(&ranged, name), input(&wiring, name) / factor);
    }
}

#[test]
fn two_ranges_of_one_code_are_refused() {
    let refused = resolved(|rig| rig.supply_range.get_mut("x6").unwrap().code = 2).unwrap_err();
    assert!(refused.contains(".code: found 2, expected a code of its own"));
}

#[test]
fn a_range_beyond_its_sources_is_refused() {
    let refused = resolved(|rig| rig.supply_range.get_mut("x3").unwrap().max_v = 31.0).unwrap_err();
    assert!(
        refused.starts_with("supply_range.x3.max_v: found 31, expected at most 30 V"),
        "{refused}"
    );
}

#[test]
fn ranges_and_their_points_come_together() {
    let refused = resolved(|rig| rig.supply_range.clear()).unwrap_err();
    assert!(refused.starts_with("digital_out.supply_range_0: found a point"));
    let refused = resolved(|rig| {
        rig.digital_in.remove("supply_range_1_set");
    });
    let refused = refused.unwrap_err();
    assert!(refused.starts_with("digital_in.supply_range_1_set: found nothing"));
}

#[test]
fn a_read_back_of_another_range_is_named() {
    let wiring = shipped();
    let selector = wiring.range_selector().unwrap();
    let range = demand(24.0, 16.0).range(&wiring).unwrap();
    assert_eq!(selector.select(range.code).map(|it| it.1), [false, true]);
    assert_eq!(selector.mismatch(range, code_of([false, true])), None);
    let mismatch = selector.mismatch(range, code_of([true, true]));
    let expected = RangeMismatch {
        selected: "x3".into(),
        found: "x6".into(),
    };
    assert_eq!(mismatch, Some(expected));
}
