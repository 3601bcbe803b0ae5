//! Laws of the relay and scatter of the lot.

#![allow(clippy::unwrap_used)]

use super::drawn::{ContactFilm, Scale};
use super::fit::Pace;
use super::*;
use crate::config::read_world;
use crate::world::draw::Subject;
use crate::world::tests::config_dir;

/// The default world without any scatter.
fn still_world() -> WorldTable {
    let mut world = read_world(&config_dir(), None).unwrap();
    world.lot.threshold_scatter_sd_mv = 0.0;
    world.lot.bounce_ln_sd = 0.0;
    world
}

/// The same with copper that does not warm: a ramp of half a second moves pickup by 1.7 mV otherwise.
fn cool(mut world: WorldTable) -> WorldTable {
    world.relay.coil_heat_j_per_k = 1e9;
    world
}

/// The relay of the reference figures: pickup 7.8835 V, release 2.3429 V.
fn reference_relay(world: &WorldTable) -> Relay {
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    let mut specimen = Drawn::of_lot(world, scale, 1, 0);
    specimen.defect = None;
    specimen.coil_ohm = 400.0;
    specimen.operate_v = 7.883_477_479_837_58;
    specimen.release_v = 2.342_888_313_119_52;
    specimen.operate_ms = 4.730_797_252;
    specimen.release_ms = 2.864_980_410;
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
fn a_rising_ramp_makes_no_as_late_as_the_reference_transients() {
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
fn a_falling_ramp_opens_no_as_late_as_the_reference_transients() {
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

#[test]
fn a_step_just_above_the_threshold_operates_late_but_surely() {
    let world = still_world();
    let ms = |above: f64| {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(7.855_922_332 * (1.0 + above)));
        first(&mut relay, 90_000.0, Contact::No, true).map(|t| t / 1000.0)
    };
    let [one, two] = [1e-4, 1e-5].map(|above| ms(above).unwrap());
    assert!(
        (two - one - 5.67).abs() < 0.3,
        "a log law: {} ms per decade",
        two - one
    );
    assert_eq!(ms(-1e-4), None);
}

#[test]
fn switch_off_into_the_zener_is_quick_and_into_a_diode_slow() {
    let world = still_world();
    let release = |clamp_v: f64| {
        let mut relay = reference_relay(&world);
        relay.drive(0.0, Supply::Volts(12.0));
        while relay.advance(100_000.0).is_some() {}
        relay.drive(100_000.0, Supply::Off { clamp_v });
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
    assert!(first(&mut relay, 2_900.0, Contact::Nc, false).is_some());
    while relay.advance(2_900.0).is_some() {}
    relay.drive(2_900.0, Supply::Off { clamp_v: 60.0 });
    assert!(first(&mut relay, 60_000.0, Contact::Nc, true).is_some());
    assert!(first(&mut relay, 60_000.0, Contact::No, true).is_none());
}

#[test]
fn thresholds_and_resistance_follow_the_copper() {
    let world = still_world();
    let specimen = reference_relay(&world).drawn().clone();
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
    let drawn: f64 = relay.drawn().bounce_no_us.iter().skip(1).step_by(2).sum();
    relay.drive(0.0, Supply::Volts(12.0));
    while relay.advance(40_000.0).is_some() {}
    assert!((relay.record.bounce_ms(Contact::No).unwrap() - drawn / 1000.0).abs() < 1e-6);
    assert!((relay.record.time_ms(Contact::No).unwrap() - 4.7308).abs() < 0.001);
}

/// A release at `at_us`: open time of NC after its first make, and the last change after that make, both microseconds.
fn released(relay: &mut Relay, at_us: f64) -> (f64, f64) {
    relay.drive(at_us, Supply::Off { clamp_v: 60.0 });
    let (mut open_us, mut last_us) = (0.0, 0.0);
    let (mut since, mut made_us) = (None, None);
    while let Some(change) = relay.advance(at_us + 70_000.0) {
        if change.contact == Contact::Nc {
            match (change.closed, since.take()) {
                (true, Some(since)) => open_us += change.t_us - since,
                (true, None) => made_us = Some(change.t_us),
                (false, _) => since = Some(change.t_us),
            }
            last_us = change.t_us - made_us.unwrap_or(change.t_us);
        }
    }
    (open_us, last_us)
}

#[test]
fn the_record_holds_openings_that_come_after_the_bounce_list_has_ended() {
    let world = still_world();
    let reference = reference_relay(&world).drawn().clone();
    let mut latest_us = 0.0_f64;
    for step in 0..24 {
        let mut specimen = reference.clone();
        specimen.operate_v = 6.2;
        specimen.release_v = 0.3 + 0.1 * f64::from(step);
        let draw = Draw::new(1, Subject::LotOperations, 0);
        let mut relay = Relay::new(specimen, &world, draw, 0.0, 23.0, 23.0);
        relay.drive(0.0, Supply::Volts(12.0));
        while relay.advance(50_000.0).is_some() {}
        let (open_us, last_us) = released(&mut relay, 50_000.0);
        let recorded_us = relay.record.bounce_ms(Contact::Nc).unwrap() * 1000.0;
        assert!(
            (recorded_us - open_us).abs() < 1e-3,
            "{recorded_us} of {open_us}"
        );
        latest_us = latest_us.max(last_us);
    }
    assert!(latest_us > 8_000.0, "none opened late: {latest_us} us");
}

#[test]
fn holding_the_equilibrium_moves_no_instant_by_a_microsecond() {
    use crate::world::relay::lumped::{Excitation, Kind, Model, Outcome, Parameters, Waveform};
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
        .filter(|e| e.kind == Kind::No && e.t_s > 0.15 && e.on)
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

#[test]
fn a_drawn_specimen_moves_with_the_thresholds_and_times_that_were_drawn() {
    use crate::world::relay::lumped::Model;
    let world = still_world();
    for (nominal_v, nominal_coil_ohm) in [(12.0, 400.0), (9.0, 225.0)] {
        let scale = Scale {
            nominal_v,
            nominal_coil_ohm,
        };
        let lot = (0..650).map(|i| Drawn::of_lot(&world, scale, 7, i));
        let (good, bad): (Vec<_>, Vec<_>) = lot.partition(|s| s.defect.is_none());
        for part in good.iter().take(6).chain(&bad) {
            let wanted = part.wanted(&world);
            let model = Model::new(&wanted.fit(&world.relay.lumped));
            let what = format!("part {} {:?}", part.index, part.defect);
            let near = |found: f64, drawn: f64, within: f64| {
                assert!(
                    (found / drawn - 1.0).abs() < within,
                    "{what}: {found}, drawn {drawn}"
                );
            };
            near(model.pickup().volts, part.operate_v, 1e-9);
            near(model.release().volts, part.release_v, 1e-9);
            // A defect is drawn without regard to the times that a relay with such springs can have: they come as near as they can.
            let sound = part.defect.is_none() && part.pace == Pace::Drawn;
            if sound || part.pace == Pace::Hinge {
                near(wanted.operate_s(&model) * 1e3, part.operate_ms, 1e-3);
            }
            if sound || part.pace == Pace::Iron {
                near(wanted.release_s(&model) * 1e3, part.release_ms, 1e-3);
            }
        }
    }
}

#[test]
fn the_lot_scatters_as_the_table_says_and_every_defect_is_in_it() {
    let world = read_world(&config_dir(), None).unwrap();
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    let lot: Vec<Drawn> = (0..2600)
        .map(|i| Drawn::of_lot(&world, scale, 7, i))
        .collect();
    let good: Vec<&Drawn> = lot.iter().filter(|s| s.defect.is_none()).collect();
    assert_eq!(lot.len() - good.len(), 104, "4 % of 2600");
    for &kind in Defect::ALL {
        let count = lot.iter().filter(|s| s.defect == Some(kind)).count();
        assert_eq!(count, 8, "{kind:?}");
    }
    let moments = |f: fn(&Drawn) -> f64| {
        let n = good.len() as f64;
        let mean = good.iter().map(|s| f(s)).sum::<f64>() / n;
        (
            mean,
            (good.iter().map(|s| (f(s) - mean).powi(2)).sum::<f64>() / n).sqrt(),
        )
    };
    for (f, mean, sd) in [
        ((|s| s.operate_v) as fn(&Drawn) -> f64, 7.88, 0.26),
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

#[test]
fn a_relay_that_was_operated_and_released_carries_the_current_of_its_coil_again() {
    let world = read_world(&config_dir(), None).unwrap();
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    for i in 0..300 {
        let specimen = Drawn::of_lot(&world, scale, 3, i);
        if specimen.coil_ohm.is_infinite() {
            continue;
        }
        let draw = Draw::new(3, Subject::LotOperations, i);
        let mut relay = Relay::new(specimen, &world, draw, 0.0, 23.0, 23.0);
        let off = Supply::Off {
            clamp_v: world.board.zener_v,
        };
        let (mut t, mut steps) = (0.0, Vec::new());
        for (supply, ms) in [
            (Supply::Volts(12.0), 64.3),
            (off, 58.1),
            (Supply::Volts(5.0), 40.7),
        ] {
            relay.drive(t, supply);
            t += ms * 1e3;
            while relay.advance(t).is_some() {}
            steps.push(relay.coil_current_a());
        }
        let expected = 5.0 / relay.coil_ohm();
        assert!(
            (steps[2] / expected - 1.0).abs() < 0.01,
            "specimen {i}: {steps:?} A, expected {expected} at last"
        );
    }
}

#[test]
fn a_seed_draws_the_relays_that_it_always_drew() {
    let world = read_world(&config_dir(), None).unwrap();
    let drawn = |seed, index, nominal_v, nominal_coil_ohm| {
        let scale = Scale {
            nominal_v,
            nominal_coil_ohm,
        };
        Drawn::of_lot(&world, scale, seed, index)
    };
    let near = |found: &[f64], recorded: &[f64]| {
        assert_eq!(found.len(), recorded.len());
        for (one, other) in found.iter().zip(recorded) {
            assert!(
                (one / other - 1.0).abs() < 1e-9,
                "{found:?}, recorded {recorded:?}"
            );
        }
    };
    for (part, recorded) in [
        (
            drawn(7, 0, 12.0, 400.0),
            [
                401.511_188_744_249_6,
                7.967_415_220_424_96,
                2.433_121_701_086_573,
                4.666_511_589_636_086_5,
                2.942_183_166_974_364_5,
                224.787_348_413_739_58,
                476.562_963_023_108_24,
                0.008_331_520_656_415_613,
                1.868_740_064_397_995_6e-6,
            ],
        ),
        (
            drawn(1, 0, 9.0, 225.0),
            [
                225.043_700_390_099_81,
                5.863_349_987_004_486,
                1.811_359_684_970_613,
                4.574_565_416_007_003,
                3.053_115_215_277_251,
                186.408_768_336_615,
                454.037_948_318_580_56,
                -0.149_521_722_064_091_4,
                1.538_452_732_939_932e-5,
            ],
        ),
    ] {
        let found = [
            part.coil_ohm,
            part.operate_v,
            part.release_v,
            part.operate_ms,
            part.release_ms,
            part.bounce_no_us[1],
            part.bounce_nc_us[1],
            part.offset_k,
            part.emf_v,
        ];
        near(&found, &recorded);
    }
    let defects: Vec<(u64, &str)> = (0..230)
        .filter_map(|i| Some((i, drawn(7, i, 12.0, 400.0).defect?.name())))
        .collect();
    let recorded = [
        (11, "turned"),
        (52, "open_coil"),
        (134, "stuck_no"),
        (172, "unstable_contact"),
        (178, "stiff_spring"),
        (188, "missing_pin"),
        (200, "shorted_turns"),
        (215, "high_contact"),
        (226, "bouncing"),
    ];
    assert_eq!(defects, recorded);
    let shorted = drawn(7, 200, 12.0, 400.0);
    near(
        &[shorted.coil_ohm, shorted.operate_v],
        &[313.800_691_032_685_73, 7.926_989_756_170_821],
    );
    let pinless = drawn(7, 188, 12.0, 400.0);
    assert_eq!(pinless.pins.present, [true, true, false, true, true]);
}
