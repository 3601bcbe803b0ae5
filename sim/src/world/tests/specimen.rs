//! Laws of the relay and scatter of the lot.

use super::*;
use crate::config::read_world;
use crate::world::defect;
use crate::world::draw::{Draw, Subject};
use crate::world::mode::step_time;
use crate::world::relay::{Contact, Relay, Supply, laws};
use crate::world::specimen::{ContactFilm, Scale, Specimen};
use crate::world::table::WorldTable;

/// The default world without any scatter.
fn still_world() -> WorldTable {
    let mut world = read_world(&config_dir(), None).unwrap();
    world.lot.threshold_scatter_sd_mv = 0.0;
    world.lot.bounce_ln_sd = 0.0;
    world
}

/// The relay of the reference figures: pickup 7.8835 V, release 2.3429 V.
fn reference_relay(world: &WorldTable) -> Relay {
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    let mut specimen = Specimen::of_lot(world, scale, 1, 0);
    specimen.defect = None;
    specimen.coil_ohm = 400.0;
    specimen.operate_v = 7.883_477;
    specimen.release_v = 2.342_888;
    specimen.operate_ms = 4.7308;
    specimen.release_ms = 2.8650;
    specimen.offset_k = 0.0;
    specimen.film_no = ContactFilm::Steady {
        median_mohm: 18.0,
        ln_sd: 0.0,
    };
    Relay::new(
        specimen,
        world,
        Draw::new(1, Subject::LotOperations, 0),
        0.0,
        23.0,
        23.0,
    )
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
fn operate_time_follows_the_step_voltage_as_the_reference_transients_do() {
    let world = still_world();
    for (volts, expected_ms) in [(9.0, 8.0014), (12.0, 4.7308), (16.0, 3.4236)] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(volts));
        let ms = first(&mut relay, 50_000.0, Contact::No, true).unwrap() / 1000.0;
        assert!(
            (ms - expected_ms).abs() < 0.3,
            "{volts} V: {ms} ms, expected {expected_ms}"
        );
    }
}

#[test]
fn a_rising_ramp_makes_no_as_late_as_the_reference_transients() {
    let world = still_world();
    for (rate, expected_v) in [
        (2.0, 7.918_7),
        (10.0, 8.021_3),
        (50.0, 8.395_9),
        (100.0, 8.770_4),
    ] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(7.0));
        while relay.advance(40_000.0).is_some() {}
        let volts = ramp(&mut relay, 40_000.0, 7.0, rate, Contact::No, true);
        assert!(
            (volts - expected_v).abs() < 0.006,
            "{rate} V/s: {volts} V, expected {expected_v}"
        );
    }
}

#[test]
fn a_falling_ramp_opens_no_as_late_as_the_reference_transients() {
    let world = still_world();
    for (rate, expected_v) in [
        (2.0, 2.3075),
        (10.0, 2.1938),
        (50.0, 1.7419),
        (100.0, 1.2593),
    ] {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(12.0));
        while relay.advance(30_000.0).is_some() {}
        let high = 2.7 + 0.04 * rate;
        relay.drive(30_000.0, Supply::Volts(high));
        while relay.advance(90_000.0).is_some() {}
        let volts = ramp(&mut relay, 90_000.0, high, -rate, Contact::No, false);
        assert!(
            (volts - expected_v).abs() < 0.008,
            "{rate} V/s: {volts} V, expected {expected_v}"
        );
    }
}

#[test]
fn a_step_just_above_the_threshold_operates_late_but_surely() {
    let world = still_world();
    let (operate, _) = laws(&world.relay);
    let ms = |above: f64| step_time(operate, 0.0, 8.0 * (1.0 + above), 8.0).unwrap() + 0.6;
    assert!((ms(0.01) - 16.8).abs() < 1.0, "{}", ms(0.01));
    let decades = [1e-3, 1e-4, 1e-5].map(ms);
    let (one, two) = (decades[1] - decades[0], decades[2] - decades[1]);
    assert!(
        one > 5.0 && (one / two - 1.0).abs() < 0.02,
        "a log law: {one} {two} ms per decade"
    );
    assert!(step_time(operate, 0.0, 7.999, 8.0).is_none());
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
    assert!(
        (open - 1.96).abs() < 0.1 && (make - 2.865).abs() < 0.05,
        "{open} {make}"
    );
    let (open, make) = release(true, 0.7);
    assert!(
        (open - 10.29).abs() < 0.5 && (make - 11.73).abs() < 1.0,
        "{open} {make}"
    );
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
    relay.drive(
        2_400.0,
        Supply::Off {
            clamp_v: 60.0,
            slow: false,
        },
    );
    assert!(first(&mut relay, 60_000.0, Contact::Nc, true).is_some());
    assert!(first(&mut relay, 60_000.0, Contact::No, true).is_none());
}

#[test]
fn thresholds_and_resistance_follow_the_copper() {
    let world = still_world();
    let specimen = reference_relay(&world).specimen().clone();
    let draw = Draw::new(1, Subject::LotOperations, 0);
    let mut relay = Relay::new(specimen, &world, draw, 0.0, 60.0, 60.0);
    assert!(
        (relay.coil_ohm() - 457.476).abs() < 0.01,
        "{}",
        relay.coil_ohm()
    );
    relay.drive(0.0, Supply::Volts(8.9));
    assert!(
        first(&mut relay, 100_000.0, Contact::No, true).is_none(),
        "9.016 V at 60 C"
    );
}

#[test]
fn a_held_coil_warms_as_two_heat_stores_do() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    relay.drive(0.0, Supply::Volts(12.0));
    while relay.advance(5e6).is_some() {}
    assert!(
        (relay.coil_ohm() - 402.08).abs() < 0.05,
        "{} ohm after 5 s",
        relay.coil_ohm()
    );
}

#[test]
fn the_record_holds_the_bounce_as_it_happened() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    let drawn: f64 = relay
        .specimen()
        .bounce_no_us
        .iter()
        .skip(1)
        .step_by(2)
        .sum();
    relay.drive(0.0, Supply::Volts(12.0));
    while relay.advance(40_000.0).is_some() {}
    assert!((relay.record.bounce_ms(Contact::No).unwrap() - drawn / 1000.0).abs() < 1e-6);
    assert!((relay.record.time_ms(Contact::No).unwrap() - 4.7308).abs() < 0.001);
}

#[test]
fn the_lot_scatters_as_the_table_says_and_every_defect_is_in_it() {
    let world = read_world(&config_dir(), None).unwrap();
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    let lot: Vec<Specimen> = (0..2600)
        .map(|i| Specimen::of_lot(&world, scale, 7, i))
        .collect();
    let good: Vec<&Specimen> = lot.iter().filter(|s| s.defect.is_none()).collect();
    assert_eq!(lot.len() - good.len(), 104, "4 % of 2600");
    for &kind in defect::Defect::ALL {
        let count = lot.iter().filter(|s| s.defect == Some(kind)).count();
        assert_eq!(count, 8, "{kind:?}");
    }
    let moments = |f: fn(&Specimen) -> f64| {
        let n = good.len() as f64;
        let mean = good.iter().map(|s| f(s)).sum::<f64>() / n;
        (
            mean,
            (good.iter().map(|s| (f(s) - mean).powi(2)).sum::<f64>() / n).sqrt(),
        )
    };
    for (f, mean, sd) in [
        ((|s| s.operate_v) as fn(&Specimen) -> f64, 7.88, 0.26),
        (|s| s.release_v, 2.35, 0.10),
        (|s| s.coil_ohm, 400.0, 6.0),
        (|s| s.operate_ms, 4.7, 0.25),
        (|s| s.release_ms, 2.9, 0.15),
    ] {
        let (m, s) = moments(f);
        assert!(
            (m - mean).abs() < 4.0 * sd / 50.0 && (s / sd - 1.0).abs() < 0.06,
            "{m} {s}"
        );
    }
}
