//! Tests of operate and release instants against reference transients.

use super::*;
use crate::world::relay::lumped::{Element, Excitation, Model, Parameters, Waveform};

/// Ramps from `from_v` at `v_per_s` in steps of 20 us; returns the voltage at the first change.
fn ramp(
    relay: &mut Relay,
    t0_us: f64,
    from_v: f64,
    v_per_s: f64,
    contact: Contact,
    closed: bool,
) -> f64 {
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
fn operate_time_follows_the_step_voltage() {
    let world = still_world();
    for (volts, expected_ms) in [(9.0, 8.001_395), (12.0, 4.730_797), (16.0, 3.423_619)] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(volts));
        let ms = first(&mut relay, 50_000.0, Contact::No, true).unwrap() / 1000.0;
        assert!(
            (ms - expected_ms).abs() < 2e-4,
            "{volts} V: {ms} ms, expected {expected_ms}"
        );
    }
}

#[test]
fn a_rising_ramp_makes_no_with_the_reference_overshoot() {
    let world = cool(still_world());
    for (rate, expected_v) in [
        (2.0, 7.918_685),
        (10.0, 8.021_304),
        (50.0, 8.395_865),
        (100.0, 8.770_410),
    ] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(7.0));
        while relay.advance(400_000.0).is_some() {}
        let volts = ramp(&mut relay, 400_000.0, 7.0, rate, Contact::No, true);
        assert!(
            (volts - expected_v).abs() < 0.001,
            "{rate} V/s: {volts} V, expected {expected_v}"
        );
    }
}

#[test]
fn a_falling_ramp_opens_no_with_the_reference_overshoot() {
    let world = cool(still_world());
    for (rate, expected_v) in [
        (2.0, 2.307_529),
        (10.0, 2.193_789),
        (50.0, 1.741_857),
        (100.0, 1.259_328),
    ] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(12.0));
        while relay.advance(30_000.0).is_some() {}
        let high = 2.7 + 0.04 * rate;
        relay.drive(30_000.0, Supply::Volts(high));
        while relay.advance(90_000.0).is_some() {}
        let volts = ramp(&mut relay, 90_000.0, high, -rate, Contact::No, false);
        assert!(
            (volts - expected_v).abs() < 0.001,
            "{rate} V/s: {volts} V, expected {expected_v}"
        );
    }
}

/// Returns the operate time of a step of `above` above the dynamic threshold, ms, from all five states. The reference
/// gives a law of 5.67 ms per decade for less than 1e-6; farther above, a decade takes less.
fn exact_ms(above: f64) -> f64 {
    let model = Model::new(&Parameters::default());
    let step = Waveform::new(vec![[0.0, 7.855_922_332 * (1.0 + above)]]).unwrap();
    let whole = model.transient(model.at_rest(0.0), &Excitation::Source(step), 0.09, 1e-10);
    let events = whole.unwrap().events;
    let made = events.iter().find(|it| it.element == Element::No && it.on);
    1e3 * made.unwrap().t_s
}

#[test]
fn a_step_just_above_the_threshold_operates_late() {
    let world = still_world();
    let ms = |above: f64| {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(7.855_922_332 * (1.0 + above)));
        first(&mut relay, 90_000.0, Contact::No, true).map(|t| t / 1000.0)
    };
    let [one, two] = [1e-4, 1e-5].map(|above| ms(above).unwrap());
    let [exact_one, exact_two] = [1e-4, 1e-5].map(exact_ms);
    assert!(
        (two - one - (exact_two - exact_one)).abs() < 0.05,
        "{} ms in a decade, expected {}",
        two - one,
        exact_two - exact_one
    );
    assert_eq!(ms(-1e-4), None);
}

#[test]
fn a_zener_releases_quickly_and_a_diode_slowly() {
    let world = still_world();
    let release = |suppression_v: f64| {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(12.0));
        while relay.advance(100_000.0).is_some() {}
        relay.drive(100_000.0, Supply::Off { suppression_v });
        let open = first(&mut relay, 150_000.0, Contact::No, false).unwrap();
        let make = first(&mut relay, 150_000.0, Contact::Nc, true).unwrap();
        ((open - 1e5) / 1000.0, (make - 1e5) / 1000.0)
    };
    let (open, make) = release(60.0);
    assert!(
        (open - 1.961).abs() < 0.005 && (make - 2.865).abs() < 0.005,
        "{open} {make}"
    );
    let (open, make) = release(0.7);
    assert!(
        (open - 10.29).abs() < 0.02 && (make - 11.73).abs() < 0.02,
        "{open} {make}"
    );
}

#[test]
fn holding_the_equilibrium_moves_no_instant_by_a_microsecond() {
    use crate::world::relay::lumped::{Element, Excitation, Model, Outcome, Parameters, Waveform};
    let world = still_world();
    let points = [
        (0.0, 5.0),
        (40_000.0, 12.0),
        (80_000.0, 4.0),
        (120_000.0, 0.0),
        (150_000.0, 12.0),
    ];
    let mut relay = reference_relay(&world);
    let mut held = Vec::new();
    for (i, (t_us, volts)) in points.into_iter().enumerate() {
        relay.drive(t_us, Supply::Volts(volts));
        let end_us = points.get(i + 1).map_or(180_000.0, |next| next.0);
        while let Some(change) = relay.advance(end_us) {
            if change.contact == Contact::No {
                held.push(change.t_us);
            }
        }
    }
    let steps = points
        .windows(2)
        .flat_map(|w| [[w[0].0, w[0].1], [w[1].0, w[0].1]]);
    let wave: Vec<[f64; 2]> = steps
        .chain([[150_000.0, 12.0]])
        .map(|[t, v]| [t * 1e-6, v])
        .collect();
    let model = Model::new(&Parameters::default());
    let excitation = Excitation::Source(Waveform::new(wave).unwrap());
    let whole = model
        .transient(model.at_rest(0.0), &excitation, 0.18, 1e-8)
        .unwrap();
    let expected = Outcome::of(&whole.events);
    let last_make = whole
        .events
        .iter()
        .filter(|e| e.element == Element::No && e.t_s > 0.15 && e.on)
        .map(|e| e.t_s);
    let found = [held[0], *held.iter().find(|t| **t > 150_000.0).unwrap()];
    let exact = [
        expected.no_first_make.unwrap(),
        last_make.min_by(f64::total_cmp).unwrap(),
    ];
    for (one, other) in found.iter().zip(exact) {
        assert!(
            (one - other * 1e6).abs() < 2.0,
            "{one} us, integrated throughout {} us",
            other * 1e6
        );
    }
    let levels = relay.levels();
    assert!(levels.held_s > 0.05 && levels.moving_s > 0.02, "{levels:?}");
}
