//! Tests of whole control loops on a small model of a chamber.

use super::increment::{Increment, Rules};
use super::pid::Pid;
use super::scheduled::{FuzzyPid, Symmetry};
use super::split_range::{Command, SplitRange};
use super::{Controller, Law, Observed};
use crate::ramp::{Ramp, SetPoint};
use crate::test_plant::{AMBIENT_C, Plant, identified, identified_on};
use crate::tune::Settings;
use crate::tune::identify::{Identification, Step as IdentifyStep};
use crate::tune::relay::{RelayTune, Step};

fn all_laws() -> Vec<(&'static str, Controller)> {
    let chamber = identified();
    let tight = Settings::simc(&chamber.first_order, 1.0);
    let laws = [
        ("pid", Law::Pid(Pid::new(tight))),
        ("furnace", Law::Fuzzy(Increment::new(Rules::FURNACE))),
        (
            "macvicar",
            Law::Fuzzy(Increment::new(Rules::MACVICAR_WHELAN)),
        ),
        ("even", Law::FuzzyPid(FuzzyPid::new(tight, Symmetry::Even))),
    ];
    let split = SplitRange::of(&chamber);
    let with = |(name, law): (&'static str, Law)| {
        (
            name,
            Controller::new(law, split).with_feed_forward(&chamber),
        )
    };
    laws.map(with).into()
}

/// Runs a loop for some seconds and returns the readings with their set points.
fn run(
    plant: &mut Plant,
    controller: &mut Controller,
    ramp: &mut Ramp,
    seconds: usize,
) -> Vec<(Observed, SetPoint)> {
    let mut seen = plant.seen();
    let one = |_| {
        let set = ramp.step(seen.measured_c);
        seen = plant.step(controller.step(&set, &seen));
        (seen, set)
    };
    (0..seconds).map(one).collect()
}

#[test]
fn identification_finds_the_figures_of_the_chamber() {
    let found = identified();
    assert!((found.slope_k_per_s - 0.264).abs() < 0.03, "{found:?}");
    assert!((found.gain_k - 30.6).abs() < 3.0, "{found:?}");
    assert!((found.time_constant_s - 21.9).abs() < 4.0, "{found:?}");
    assert!((found.delay_s - 6.7).abs() < 1.5, "{found:?}");
    assert!((found.first_order.gain_k - 65.0).abs() < 5.0, "{found:?}");
    assert!((found.fan - 60.0 / 2200.0).abs() < 0.006, "{found:?}");
    assert!(
        (found.vent_per_k - 18.0 / 2200.0).abs() < 0.002,
        "{found:?}"
    );
}

#[test]
fn a_warm_chamber_is_cooled_before_its_identification() {
    let mut plant = Plant::at(90.0);
    let vented = Command {
        heater: 0.0,
        vent: 1.0,
    };
    while plant.step(vented).measured_c > 45.0 {}
    // The program takes the warm air for a hot room.
    let mut run = Identification::new(0.15, 38.0, 90.0);
    let (found, seconds) = (0..12_000)
        .find_map(|second| match run.step(plant.seen().measured_c).unwrap() {
            IdentifyStep::Go(command) => {
                plant.step(command);
                None
            }
            IdentifyStep::Done(found) => Some((found, second)),
        })
        .unwrap();
    let cold = identified();
    let close = |a: f64, b: f64, share: f64| (a / b - 1.0).abs() < share;
    assert!((1_800..5_400).contains(&seconds), "{seconds}");
    assert!(
        close(found.slope_k_per_s, cold.slope_k_per_s, 0.1),
        "{found:?}, {cold:?}"
    );
    assert!(
        close(found.loss_per_k, cold.loss_per_k, 0.4),
        "{found:?}, {cold:?}"
    );
    let ambient_c = run.ambient_c();
    assert!((ambient_c - AMBIENT_C).abs() < 3.0, "{ambient_c}");
}

#[test]
fn every_law_with_feed_forward_tracks_five_kelvin_a_minute() {
    for (name, mut controller) in all_laws() {
        let (mut plant, mut ramp) = (Plant::at(AMBIENT_C), Ramp::at(40.0));
        run(&mut plant, &mut controller, &mut ramp, 1800);
        ramp.head_for(100.0, 5.0);
        let all = run(&mut plant, &mut controller, &mut ramp, 1500);
        let delay = identified().delay_s.round() as usize;
        let errors = all[delay..]
            .iter()
            .zip(&all)
            .map(|((seen, _), (_, set))| set.value_c - seen.measured_c);
        let worst = errors.map(f64::abs).fold(0.0, f64::max);
        assert!(worst < 0.4, "{name}: {worst}");
    }
}

#[test]
fn half_a_heater_is_learnt_on_one_ramp() {
    let (_, mut controller) = all_laws().swap_remove(0);
    let (mut plant, mut ramp) = (Plant::at(AMBIENT_C), Ramp::at(40.0));
    plant.mains = 0.5;
    run(&mut plant, &mut controller, &mut ramp, 900);
    ramp.head_for(90.0, 5.0);
    run(&mut plant, &mut controller, &mut ramp, 1200);
    assert!(
        (controller.learnt_gain() - 0.5).abs() < 0.1,
        "{}",
        controller.learnt_gain()
    );
}

#[test]
fn the_relay_finds_a_gain_that_keeps_the_chamber_calm() {
    let chamber = identified();
    let split = SplitRange::of(&chamber);
    let mut plant = Plant::at(55.0);
    let mut tune = RelayTune::new(60.0, chamber.loss_per_k * 35.0 - chamber.fan);
    let found = loop {
        let seen = plant.seen();
        match tune.step(seen.measured_c).unwrap() {
            Step::Go(power) => drop(plant.step(split.command(power, &seen))),
            Step::Done(found) => break found,
        }
    };
    assert!((found.ultimate_per_k - 0.23).abs() < 0.08, "{found:?}");
    assert!((found.period_s - 18.0).abs() < 6.0, "{found:?}");
    let law = Law::Pid(Pid::new(found.settings()));
    let mut controller = Controller::new(law, split);
    let mut ramp = Ramp::at(60.0);
    run(&mut plant, &mut controller, &mut ramp, 900);
    let held = run(&mut plant, &mut controller, &mut ramp, 600);
    assert!(
        held.iter()
            .all(|(seen, _)| (seen.measured_c - 60.0).abs() < 0.1)
    );
}

#[test]
fn quick_and_slow_sensors_leave_the_loop_calm() {
    // At 60 C the heater holds, at 40 C the vent: the fan alone would lift the chamber higher.
    for (sensor_lag_s, held_c) in [4.0, 6.0, 12.0]
        .into_iter()
        .flat_map(|it| [(it, 60.0), (it, 40.0)])
    {
        let at = |celsius| {
            let mut plant = Plant::at(celsius);
            plant.sensor_lag_s = sensor_lag_s;
            plant
        };
        let mut controller = Controller::usual(&identified_on(at(AMBIENT_C)));
        let (mut plant, mut ramp) = (at(held_c), Ramp::at(held_c));
        run(&mut plant, &mut controller, &mut ramp, 1200);
        let held = run(&mut plant, &mut controller, &mut ramp, 300);
        let worst = held
            .iter()
            .map(|(seen, _)| (seen.measured_c - held_c).abs())
            .fold(0.0, f64::max);
        assert!(worst < 0.15, "{sensor_lag_s}, {held_c}: {worst}");
    }
}

#[test]
fn a_missing_reading_switches_off_and_leaves_the_state() {
    for (name, mut controller) in all_laws() {
        let (mut plant, mut ramp) = (Plant::at(60.0), Ramp::at(60.0));
        run(&mut plant, &mut controller, &mut ramp, 600);
        let before = controller.clone();
        for missing in [f64::NAN, f64::INFINITY] {
            let seen = Observed {
                measured_c: missing,
                ..plant.seen()
            };
            let command = controller.step(&ramp.now(), &seen);
            assert_eq!((command.heater, command.vent), (0.0, 0.0), "{name}");
        }
        assert_eq!(controller, before, "{name}");
        let after = run(&mut plant, &mut controller, &mut ramp, 300);
        assert!((after[299].0.measured_c - 60.0).abs() < 0.2, "{name}");
    }
}
