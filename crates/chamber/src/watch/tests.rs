//! Tests of the checks on a small model of a chamber: silent in a good run, and in time for each fault.

use super::*;
use crate::control::Controller;
use crate::ramp::Ramp;
use crate::test_plant::{AMBIENT_C, Plant, identified};

/// A running chamber with its checks.
struct Run {
    plant: Plant,
    controller: Controller,
    watch: Watch,
    ramp: Ramp,
}

impl Run {
    fn at(celsius: f64) -> Self {
        let chamber = identified();
        Self {
            plant: Plant::at(celsius),
            controller: Controller::usual(&chamber),
            watch: Watch::new(&chamber),
            ramp: Ramp::at(celsius),
        }
    }

    /// Runs for some seconds; `fault` may change what the checks see and what the plant gets. Returns the first trouble
    /// with its second.
    fn go(
        &mut self,
        seconds: usize,
        fault: impl Fn(&mut Second, &mut Command),
    ) -> Option<(usize, Trouble)> {
        let mut first = None;
        for second in 0..seconds {
            let seen = self.plant.seen();
            let set = self.ramp.step(seen.measured_c);
            let command = self.controller.step(&set, &seen);
            let mut now = Second {
                control_c: Some(seen.measured_c),
                reference_c: Some(seen.measured_c),
                ambient_c: AMBIENT_C,
                set,
                command,
                gain: self.controller.learnt_gain(),
            };
            let mut driven = command;
            fault(&mut now, &mut driven);
            let found = self.watch.step(&now);
            first = first.or(found.first().map(|it| (second, *it)));
            self.plant.step(driven);
        }
        first
    }
}

fn nothing(_: &mut Second, _: &mut Command) {}

#[test]
fn a_warm_chamber_that_loses_little_raises_no_trouble() {
    for loss in [0.7, 1.0, 1.6] {
        let mut run = Run::at(60.0);
        let chamber = identified();
        let loss_per_k = loss * chamber.loss_per_k;
        let chamber = Identified {
            loss_per_k,
            ..chamber
        };
        run.watch = Watch::new(&chamber);
        run.controller = Controller::usual(&chamber);
        for (end_c, rate_k_per_min) in [(95.0, 5.0), (80.0, 10.0), (95.0, 5.0), (85.0, 2.0)] {
            run.ramp.head_for(end_c, rate_k_per_min);
            assert_eq!(run.go(600, nothing), None, "{loss} {end_c}");
        }
    }
}

#[test]
fn a_batch_without_fault_raises_no_trouble() {
    for mains in [0.85, 1.0, 1.15] {
        let mut run = Run::at(AMBIENT_C);
        run.plant.mains = mains;
        for (end_c, rate, seconds) in [
            (78.0, 10.0, 500),
            (92.0, 2.0, 500),
            (72.0, 10.0, 300),
            (55.0, 2.0, 600),
            (45.0, 10.0, 400),
        ] {
            run.ramp.head_for(end_c, rate);
            assert_eq!(run.go(seconds, nothing), None, "mains {mains}, to {end_c}");
        }
    }
}

#[test]
fn an_open_heater_breaks_the_energy_balance() {
    let mut run = Run::at(AMBIENT_C);
    run.ramp.head_for(90.0, 5.0);
    run.go(400, nothing);
    let found = run.go(120, |_, driven| driven.heater = 0.0);
    assert!(
        matches!(found, Some((5..=75, Trouble::EnergyBalance))),
        "{found:?}"
    );
}

#[test]
fn a_power_unit_shorted_at_full_heat_is_found_in_half_a_minute() {
    let mut run = Run::at(60.0);
    run.go(900, nothing);
    let found = run.go(60, |_, driven| driven.heater = 1.0);
    assert!(matches!(found, Some((0..=30, _))), "{found:?}");
}

#[test]
fn a_little_heat_without_command_is_found_in_a_minute() {
    let mut run = Run::at(45.0);
    let little = Command {
        heater: 0.055,
        vent: 0.0,
    };
    for _ in 0..240 {
        run.plant.step(little);
    }
    let here_c = run.plant.seen().measured_c;
    let found = run.go(90, |now, driven| {
        now.command = Command::OFF;
        now.set = SetPoint::hold(here_c);
        *driven = little;
    });
    assert!(
        matches!(found, Some((55..=65, Trouble::HeatWithoutCommand))),
        "{found:?}"
    );
}

#[test]
fn the_checks_survive_a_gap_in_the_readings() {
    for missing in [None, Some(f64::NAN)] {
        let mut run = Run::at(AMBIENT_C);
        run.ramp.head_for(90.0, 5.0);
        assert_eq!(run.go(400, nothing), None);
        let gap = run.go(20, |now, _| now.control_c = missing);
        assert_eq!(gap, Some((0, Trouble::SensorBroken)));
        assert_eq!(run.go(200, nothing), None);
        let found = run.go(120, |_, driven| driven.heater = 0.0);
        assert!(
            matches!(found, Some((5..=75, Trouble::EnergyBalance))),
            "{found:?}"
        );
    }
}

#[test]
fn each_sensor_check_names_its_trouble() {
    let chamber = identified();
    let quiet = Second {
        control_c: Some(60.0),
        reference_c: Some(60.0),
        ambient_c: AMBIENT_C,
        set: SetPoint::hold(60.0),
        command: Command {
            heater: 0.05,
            vent: 0.0,
        },
        gain: 1.0,
    };
    let after = |change: &dyn Fn(&mut Second), seconds: usize| {
        let mut watch = Watch::new(&chamber);
        watch.step(&quiet);
        let mut now = quiet;
        change(&mut now);
        (0..seconds)
            .map(|_| watch.step(&now))
            .find(|it| !it.is_empty())
    };
    assert_eq!(
        after(&|it| it.control_c = None, 1),
        Some(vec![Trouble::SensorBroken])
    );
    assert_eq!(
        after(&|it| it.reference_c = Some(f64::NAN), 1).map(|it| it[0]),
        Some(Trouble::SensorBroken)
    );
    assert_eq!(
        after(&|it| it.control_c = Some(63.1), 1),
        Some(vec![Trouble::SensorJump])
    );
    assert_eq!(after(&|it| it.reference_c = Some(61.1), 9), None);
    assert_eq!(
        after(&|it| it.reference_c = Some(61.1), 10),
        Some(vec![Trouble::SensorsDiffer])
    );
    assert_eq!(
        after(&|it| it.set = SetPoint::hold(54.9), 1),
        Some(vec![Trouble::OverSetPoint])
    );
    assert_eq!(
        after(
            &|it| it.set = SetPoint {
                value_c: 63.5,
                rate_k_per_s: 0.1,
                waits: true,
                ..SetPoint::default()
            },
            301
        ),
        Some(vec![Trouble::RampNotReached])
    );
    assert_eq!(
        after(
            &|it| it.set = SetPoint {
                value_c: 56.5,
                rate_k_per_s: -0.1,
                waits: true,
                ..SetPoint::default()
            },
            301
        ),
        Some(vec![Trouble::CoolingTooSlow])
    );
    // The open vent takes what the heater gives: only the reading that stands still is strange.
    let balanced = |heater| {
        let command = Command { heater, vent: 1.0 };
        move |it: &mut Second| it.command = command
    };
    assert_eq!(after(&balanced(0.31), 59), None);
    assert_eq!(after(&balanced(0.31), 60), Some(vec![Trouble::SensorStuck]));
    assert_eq!(after(&balanced(0.29), 600), None);
}

#[test]
fn the_sliding_slope_sees_a_ramp_that_is_too_fast() {
    let mut slope = slope::SlidingSlope::default();
    let found: Vec<f64> = (0..200)
        .filter_map(|second| slope.step(60.0 + f64::from(second) * 0.01))
        .collect();
    assert_eq!(found.len(), 140);
    assert!(found.iter().all(|it| (it - 0.6).abs() < 1e-9));
    assert_eq!(slope.step(f64::NAN), None);
    assert_eq!((0..60).find_map(|_| slope.step(60.0)), None);
    assert_eq!(slope.step(60.0), Some(0.0));
}

#[test]
fn air_that_warms_behind_a_closing_vent_is_no_trouble() {
    let mut run = Run::at(AMBIENT_C);
    for (end_c, rate, seconds) in [(95.0, 5.0, 900), (54.0, 10.0, 420), (92.0, 10.0, 200)] {
        run.ramp.head_for(end_c, rate);
        assert_eq!(run.go(seconds, nothing), None, "to {end_c}");
    }
}
