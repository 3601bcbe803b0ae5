//! Recipes that the modules cannot perform, and limits too narrow to judge.
#![allow(clippy::unwrap_used)]

use super::super::bins;
use super::super::{Parameter, Strategy};
use super::{faults, hindrance, nominal_v_per_s};
use crate::dut::Recipe;
use crate::dut::accuracy::AccuracySettings;
use crate::dut::device::Rig;
use crate::dut::em_relay::points::{AnalogOut, Points};
use crate::dut::em_relay::recipe::{CoilChannels, RelayRecipe};
use crate::dut::em_relay::settings::ReferenceSettings;
use crate::dut::recipe::{DeviceRecipe, Limits};
use crate::rig::fault::Fault;
use crate::rig::settings::RigSettings;
use crate::rig::wiring::{Module, Wiring};
use serde::Deserialize;

const RIG: &str = include_str!("../../../../../../config/rig.toml");

#[derive(Deserialize)]
struct Board {
    reference: ReferenceSettings,
}

#[derive(Deserialize)]
struct Promised {
    accuracy: AccuracySettings,
}

fn plant() -> (Wiring, AccuracySettings) {
    let settings: RigSettings = toml::from_str(RIG).unwrap();
    let promised: Promised = toml::from_str(RIG).unwrap();
    (
        Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap(),
        promised.accuracy,
    )
}

fn points(wiring: &Wiring) -> Points {
    Points::resolve(wiring).unwrap()
}

/// The default recipe with every threshold found by `strategy`.
fn recipe(strategy: Strategy) -> Recipe {
    let mut recipe: Recipe = toml::from_str(include_str!(
        "../../../../../../config/recipes/jzc-22f-012.toml"
    ))
    .unwrap();
    let DeviceRecipe::EmRelay(relay) = &mut recipe.device else {
        panic!("a relay");
    };
    relay.test.strategy.operate_voltage_v = strategy;
    relay.test.strategy.release_voltage_v = strategy;
    recipe
}

fn feasible(recipe: &Recipe, wiring: &Wiring, accuracy: &AccuracySettings) -> Result<(), Fault> {
    let DeviceRecipe::EmRelay(relay) = &recipe.device else {
        panic!("a relay");
    };
    faults_on(relay, &recipe.limits, wiring, accuracy)
        .into_iter()
        .next()
        .map_or(Ok(()), Err)
}

/// Every fault of the recipe on a rig with the references and reference parts of the default plant.
fn faults_on(
    relay: &RelayRecipe,
    limits: &Limits,
    wiring: &Wiring,
    accuracy: &AccuracySettings,
) -> Vec<Fault> {
    let golden = include_str!("../../../../../../config/golden.toml");
    let board: Board = toml::from_str(RIG).unwrap();
    let rig = Rig {
        wiring,
        reference: Some(&board.reference),
        accuracy,
        reference_parts: &toml::from_str(golden).unwrap(),
        certificate: None,
    };
    faults(relay, limits, &rig)
}

fn module<'a>(wiring: &'a mut Wiring, name: &str) -> &'a mut Module {
    let mut modules = wiring.modules.iter_mut();
    modules.find(|module| module.name == name).unwrap()
}

/// Key, found and expected value of the fault that `change` causes on the default plant.
fn refused(strategy: Strategy, change: impl Fn(&mut Wiring)) -> [String; 3] {
    let (mut wiring, accuracy) = plant();
    change(&mut wiring);
    let fault = feasible(&recipe(strategy), &wiring, &accuracy).unwrap_err();
    [fault.key, fault.found, fault.expected]
}

fn hindered(change: impl Fn(&mut Wiring)) -> Vec<Strategy> {
    let (mut wiring, accuracy) = plant();
    change(&mut wiring);
    let all = Strategy::ALL.into_iter();
    all.filter(|strategy| hindrance(*strategy, &wiring, &points(&wiring), &accuracy).is_some())
        .collect()
}

fn ramping() -> Vec<Strategy> {
    let all = Strategy::ALL.into_iter();
    all.filter(|strategy| strategy.ramps()).collect()
}

#[test]
fn the_default_plant_performs_every_strategy() {
    assert_eq!(hindered(|_| {}), []);
    let (wiring, accuracy) = plant();
    for strategy in Strategy::ALL {
        feasible(&recipe(strategy), &wiring, &accuracy).unwrap();
    }
    let rate = |output| nominal_v_per_s(&wiring, points(&wiring).source(output));
    assert_eq!(rate(AnalogOut::SupplyCoarse), 96.0);
    assert_eq!(rate(AnalogOut::SupplyFine), 1.5);
    assert_eq!(rate(AnalogOut::SupplyLevel), 0.0);
}

#[test]
fn a_rig_without_a_bin_for_relays_is_refused() {
    let (_, accuracy) = plant();
    let recipe = recipe(Strategy::ALL[0]);
    for bin in bins::BY_RANK {
        let mut settings: RigSettings = toml::from_str(RIG).unwrap();
        let removed = settings.bin.remove(bin.name()).unwrap();
        settings.digital_in.remove(&removed.beam);
        let wiring = Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap();
        let fault = feasible(&recipe, &wiring, &accuracy).unwrap_err();
        assert_eq!(fault.key, "kind");
        assert!(
            fault.expected.ends_with(&format!("no bin.{bin}")),
            "{fault}"
        );
    }
}

#[test]
fn only_ramps_need_a_slew_code() {
    for name in ["ao_coarse", "ao_fine"] {
        let steps = |wiring: &mut Wiring| {
            let code_0 = module(wiring, "ao_level").slew;
            module(wiring, name).slew = code_0;
        };
        assert_eq!(hindered(steps), ramping());
        let [key, found, expected] = refused(Strategy::CoarseFine, steps);
        assert_eq!(key, "test.strategy.operate_voltage_v");
        assert_eq!(found, "coarse_fine");
        assert!(
            expected.contains(&format!("module {name} steps")),
            "{expected}"
        );
    }
}

#[test]
fn a_level_that_slews_hinders_every_strategy() {
    let slews = |wiring: &mut Wiring| {
        let code = module(wiring, "ao_fine").slew;
        module(wiring, "ao_level").slew = code;
    };
    assert_eq!(hindered(slews), Strategy::ALL);
    let [_, _, expected] = refused(Strategy::Staircase, slews);
    assert!(expected.contains("module ao_level slews"), "{expected}");
}

#[test]
fn a_timer_that_does_not_count_hinders_every_strategy() {
    let absent = |wiring: &mut Wiring| {
        let other = module(wiring, "ao_fine").type_code;
        module(wiring, "timer").type_code = other;
    };
    assert_eq!(hindered(absent), Strategy::ALL);
    let [_, _, expected] = refused(Strategy::Ramp, absent);
    assert!(
        expected.contains("module timer does not count"),
        "{expected}"
    );
}

#[test]
fn a_masked_contact_channel_hinders_every_strategy() {
    let masked = |wiring: &mut Wiring| module(wiring, "contact_ai").mask = Some(0b10);
    assert_eq!(hindered(masked), Strategy::ALL);
    let [_, _, expected] = refused(Strategy::Pulse, masked);
    assert!(expected.contains("module contact_ai masks"), "{expected}");
}

#[test]
fn a_converter_must_convert_as_fast_as_promised() {
    for name in ["contact_ai", "coil_ai"] {
        let slow = |wiring: &mut Wiring| module(wiring, name).fast = false;
        assert_eq!(hindered(slow), Strategy::ALL);
        let [_, _, expected] = refused(Strategy::CoarseFine, slow);
        assert!(expected.contains(&format!("module {name} is not in fast mode")));
        let (mut wiring, mut accuracy) = plant();
        slow(&mut wiring);
        accuracy.conversions_per_s = 10.0;
        assert_eq!(
            hindrance(Strategy::CoarseFine, &wiring, &points(&wiring), &accuracy),
            None
        );
    }
}

#[test]
fn an_early_stop_needs_a_limit() {
    let (wiring, accuracy) = plant();
    let mut recipe = recipe(Strategy::CoarseFine);
    let DeviceRecipe::EmRelay(relay) = &mut recipe.device else {
        panic!("a relay");
    };
    relay.test.strategy.contact.stops_early = true;
    feasible(&recipe, &wiring, &accuracy).unwrap();
    recipe.limits = toml::from_str("[contact_resistance_no_mohm]\nhigh = 100.0\n").unwrap();
    let fault = feasible(&recipe, &wiring, &accuracy).unwrap_err();
    assert_eq!(fault.key, "test.strategy.contact.stops_early");
    assert!(fault.expected.contains("contact_resistance_nc_mohm"));
}

#[test]
fn ramps_need_a_refresh_every_two_milliseconds() {
    let (wiring, mut accuracy) = plant();
    accuracy.ao_refresh_ms = 2.0;
    assert_eq!(
        hindrance(Strategy::CoarseFine, &wiring, &points(&wiring), &accuracy),
        None
    );
    accuracy.ao_refresh_ms = 2.1;
    let why = hindrance(Strategy::CoarseFine, &wiring, &points(&wiring), &accuracy).unwrap();
    assert!(why.contains("every 2.1 ms only"), "{why}");
    assert_eq!(
        hindrance(Strategy::Bisection, &wiring, &points(&wiring), &accuracy),
        None
    );
}

#[test]
fn limits_narrower_than_the_guard_bands_are_refused() {
    let (wiring, accuracy) = plant();
    let around = |nominal: f64, width: f64| {
        let table = format!(
            "[coil_resistance_ohm]\nlow = {}\nhigh = {}\n",
            nominal - width / 2.0,
            nominal + width / 2.0
        );
        let mut recipe = recipe(Strategy::CoarseFine);
        recipe.limits = toml::from_str(&table).unwrap();
        feasible(&recipe, &wiring, &accuracy)
    };
    // 0.18 K of thermometer and part are 0.28 ohm of a 400 ohm coil: 2 U is 1.12 ohm.
    around(400.0, 1.3).unwrap();
    let fault = around(400.0, 0.9).unwrap_err();
    assert_eq!(fault.key, format!("limits.{}", Parameter::CoilResistance));
    assert_eq!(fault.found, "399.55 to 400.45");
    assert!(
        fault.expected.contains("leave nothing between"),
        "{}",
        fault.expected
    );
}

/// Checks that the default recipe has this fault on the default plant after a change of its sections.
#[track_caller]
fn assert_refused(change: impl Fn(&mut RelayRecipe), fault: &str) {
    let (wiring, accuracy) = plant();
    let recipe = recipe(Strategy::CoarseFine);
    let DeviceRecipe::EmRelay(mut relay) = recipe.device.clone() else {
        panic!("a relay");
    };
    change(&mut relay);
    let faults = faults_on(&relay, &recipe.limits, &wiring, &accuracy);
    let texts: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert!(texts.iter().any(|text| text == fault), "{texts:#?}");
}

#[test]
fn a_voltage_beyond_every_range_is_refused() {
    assert_refused(
        |relay| relay.part.nominal_v = 110.0,
        "part.nominal_v: found 110.05 V at the supply, expected at most 60 V: \
         rig.toml supply_range.x6.max_v",
    );
    assert_refused(
        |relay| relay.test.coarse_span_v = 60.0,
        "test.coarse_span_v: found 65.13 V at the supply, expected at most 60 V: \
         rig.toml supply_range.x6.max_v",
    );
}

#[test]
fn a_coil_current_beyond_its_range_is_refused() {
    // 36 V need the range of 60 V, which gives 40 mA.
    assert_refused(
        |relay| relay.part.nominal_v = 36.0,
        "limits.coil_resistance_ohm.low: found 100.0 mA at 36.02 V, expected at most 40.0 mA: \
         rig.toml supply_range.x6.max_ma",
    );
}

#[test]
fn a_pre_bias_beyond_the_voltage_channel_is_refused() {
    assert_refused(
        |relay| relay.test.prebias_v = 6.2,
        "test.prebias_v: found 6.2, expected at most 6.12 V: \
         coil_voltage_fine reads no more in this supply range",
    );
}

#[test]
fn a_current_channel_must_suit_the_coil() {
    assert_refused(
        |relay| relay.test.prebias_v = 6.0,
        "test.coil_channels: found fine, 16.7 mA at the pre-bias, expected channels that read it: \
         coil_current_fine reads at most 16.3 mA",
    );
    assert_refused(
        |relay| {
            relay.test.coil_channels = CoilChannels::HighCurrent;
            relay.test.prebias_v = 2.0;
        },
        "test.coil_channels: found high_current, 4.55 mA at the pre-bias, expected channels that tell it from none: \
         coil_current_high from 5.00 mA on",
    );
}

#[test]
fn limits_beyond_the_reach_of_the_test_are_refused() {
    let (wiring, accuracy) = plant();
    let faults_with = |limits: &str| -> Vec<String> {
        let mut recipe = recipe(Strategy::CoarseFine);
        recipe.limits = toml::from_str(limits).unwrap();
        let DeviceRecipe::EmRelay(relay) = &recipe.device else {
            panic!("a relay");
        };
        let faults = faults_on(relay, &recipe.limits, &wiring, &accuracy);
        faults.iter().map(ToString::to_string).collect()
    };
    let ramp = "the end of the coarse ramp, test.prebias_v + test.coarse_span_v";
    let beyond = "[operate_voltage_v]\nhigh = 44.0\n[release_voltage_v]\nlow = 12.0\n\
        [operate_time_ms]\nhigh = 61.0\n[contact_resistance_no_mohm]\nhigh = 200.0\n";
    assert_eq!(
        faults_with(beyond),
        [
            format!("limits.operate_voltage_v.high: found 44, expected at most 11.10 V: {ramp}"),
            format!("limits.release_voltage_v.low: found 12, expected at most 11.10 V: {ramp}"),
            "limits.operate_time_ms.high: found 61, expected at most 60.00 ms: the test waits no longer for a contact".to_owned(),
            "limits.contact_resistance_no_mohm.high: found 200, expected at most 196.00 mOhm: \
             contact_drop reads no more at 1 A".to_owned(),
        ]
    );
    let within = "[operate_voltage_v]\nhigh = 11.0\n[operate_time_ms]\nhigh = 60.0\n\
        [contact_resistance_no_mohm]\nhigh = 196.0\n";
    assert_eq!(faults_with(within), [""; 0]);
}

#[test]
fn a_channel_that_the_rig_lacks_is_refused() {
    let mut settings: RigSettings = toml::from_str(RIG).unwrap();
    settings.analog_in.remove("coil_current_high");
    let wiring = Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap();
    let mut recipe = recipe(Strategy::CoarseFine);
    let DeviceRecipe::EmRelay(relay) = &mut recipe.device else {
        panic!("a relay");
    };
    relay.test.coil_channels = CoilChannels::HighCurrent;
    let fault = feasible(&recipe, &wiring, &plant().1).unwrap_err();
    assert_eq!(fault.key, "test.coil_channels");
    assert!(fault.expected.ends_with("no [analog_in].coil_current_high"));
}

#[test]
fn a_coarse_ramp_too_quick_for_the_lot_is_refused() {
    assert_refused(
        |relay| relay.test.expected_operate_sd_v = 0.09,
        "test.expected_operate_sd_v: found 0.09, expected at least 0.096 V: \
         the coarse ramp of 96 V/s rises so far between two refreshes",
    );
}

#[test]
fn a_voltage_without_reference_parts_is_refused() {
    assert_refused(
        |relay| relay.part.nominal_v = 36.0,
        "part.nominal_v: found 36, expected a coil voltage with at least 3 reference parts; \
         there are some of 3 V, 5 V, 6 V, 9 V, 12 V, 18 V, 24 V, 48 V",
    );
}
