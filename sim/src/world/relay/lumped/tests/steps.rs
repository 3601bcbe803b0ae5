//! Tests of steps, ramps and switch-off of the default relay.

use super::*;

/// Operations: volts; seconds until NC opens, NO makes, the armature seats, NO changes last; makes of NO.
const OPERATIONS: [(f64, f64, f64, f64, f64, u32); 3] = [
    (
        9.0,
        0.003892403627712,
        0.008001395012656,
        0.008436445289916,
        0.008714069774583,
        4,
    ),
    (
        12.0,
        0.002749658369733,
        0.004730797252093,
        0.004959338481975,
        0.005359616944904,
        4,
    ),
    (
        16.0,
        0.002124126786661,
        0.003423619376002,
        0.003657213588889,
        0.004110098349893,
        4,
    ),
];

/// Releases: volts of the suppression; seconds until NO opens, NC makes, the current is gone, NC changes last; makes of
/// NC.
const RELEASES: [(f64, f64, f64, f64, f64, u32); 3] = [
    (
        60.0,
        0.001961052470048,
        0.002864980409725,
        0.0004085774919145,
        0.005059644937856,
        5,
    ),
    (
        24.7,
        0.002665693092315,
        0.00356961254566,
        0.001652361284666,
        0.005764286661616,
        5,
    ),
    (
        0.7,
        0.01029104102338,
        0.01172859689256,
        0.0151890947326,
        0.01484081271587,
        9,
    ),
];

#[test]
fn a_step_operates_at_the_instants_of_the_reference() {
    let model = relay(&[]);
    for (volts, open, make, seat, last, makes) in OPERATIONS {
        let seen = outcome(&model, &step(volts), 0.012);
        near(seen.nc_first_open, open, 1e-10);
        near(seen.no_first_make, make, 1e-10);
        near(seen.seat_first, seat, 1e-10);
        near(seen.no_last_change, last, 1e-9);
        assert_eq!(seen.no_makes, makes, "{volts} V");
    }
}

#[test]
fn a_step_just_above_pickup_makes_three_times() {
    let model = relay(&[]);
    let pickup = model.pickup().volts;
    for (above, open, make, last) in [
        (0.01, 0.008783802380914, 0.0167961413017, 0.01736362140352),
        (0.001, 0.00896842102358, 0.02113620778044, 0.02170082492442),
    ] {
        let seen = outcome(&model, &step(pickup * (1.0 + above)), 0.03);
        near(seen.nc_first_open, open, 1e-10);
        near(seen.no_first_make, make, 1e-10);
        near(seen.no_last_change, last, 1e-9);
        assert_eq!(seen.no_makes, 3);
    }
}

#[test]
fn switch_off_releases_at_the_instants_of_the_reference() {
    let model = relay(&[]);
    for (suppression_v, open, make, dead, last, makes) in RELEASES {
        let seen = Outcome::of(&switched_off(&model, suppression_v, 0.018).events);
        near(seen.no_first_open, open, 1e-10);
        near(seen.nc_first_make, make, 1e-10);
        near(seen.coil_blocked_first, dead, 1e-10);
        near(seen.nc_last_change, last, 1e-8);
        assert_eq!(seen.nc_makes, makes, "{suppression_v} V");
    }
}

#[test]
fn with_a_diode_the_moving_armature_sustains_the_current() {
    let model = relay(&[]);
    let seen = Outcome::of(&switched_off(&model, 0.7, 0.018).events);
    assert!(
        seen.coil_blocked_first > seen.nc_first_make,
        "the armature is at the backstop before the current ends"
    );
    assert!(
        seen.nc_first_make.unwrap() > 0.008,
        "a data sheet allows 8 ms: with a diode every part fails"
    );
}

#[test]
fn overshoot_of_a_rising_ramp_grows_with_its_rate() {
    let model = relay(&[]);
    for (rate, no_v, nc_v) in [
        (10.0, 8.021303878, 7.912623278),
        (50.0, 8.395865365, 8.02446707),
        (100.0, 8.770410154, 8.157172523),
        (500.0, 10.94054335, 9.105509487),
    ] {
        let end_s = 12.0 / rate;
        let seen = outcome(&model, &ramp(&[[0.0, 0.0], [end_s, 12.0]]), end_s);
        near(seen.no_first_make.map(|t| t * rate), no_v, 1e-8);
        near(seen.nc_first_open.map(|t| t * rate), nc_v, 1e-8);
    }
}

#[test]
fn overshoot_of_a_falling_ramp_grows_with_its_rate() {
    let model = relay(&[]);
    for (rate, volts) in [
        (10.0, 2.193789072),
        (50.0, 1.741856865),
        (100.0, 1.259327707),
    ] {
        let fall = ramp(&[[0.0, 12.0], [12.0 / rate, 0.0]]);
        let seen = model
            .transient(model.sealed(12.0), &fall, 12.0 / rate, FINE)
            .unwrap();
        near(
            Outcome::of(&seen.events)
                .no_first_open
                .map(|t| 12.0 - t * rate),
            volts,
            1e-8,
        );
    }
}

#[test]
fn a_looser_tolerance_moves_events_below_a_nanosecond() {
    let model = relay(&[]);
    let start = model.at_rest(0.0);
    let fine = model.transient(start, &step(12.0), 0.008, 1e-12).unwrap();
    for (rtol, first_s, last_s) in [
        (1e-6, 1e-9, 1e-9),
        (1e-8, 2e-12, 1e-10),
        (1e-10, 1e-12, 1e-11),
    ] {
        let loose = model.transient(start, &step(12.0), 0.008, rtol).unwrap();
        assert_eq!(loose.events.len(), fine.events.len(), "rtol {rtol:e}");
        let (one, other) = (Outcome::of(&loose.events), Outcome::of(&fine.events));
        near(one.no_first_make, other.no_first_make.unwrap(), first_s);
        near(one.no_last_change, other.no_last_change.unwrap(), last_s);
        assert!(loose.evaluations < fine.evaluations);
    }
}
