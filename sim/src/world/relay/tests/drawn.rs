//! Tests of the relays that a lot draws from the world file.

use super::*;
use crate::world::relay::fit::TimeOrigin;

#[test]
fn a_specimen_shows_its_drawn_thresholds_and_times() {
    use crate::world::relay::lumped::Model;
    let world = still_world();
    for (nominal_v, nominal_coil_ohm) in [(12.0, 400.0), (9.0, 225.0)] {
        let scale = Scale {
            nominal_v,
            nominal_coil_ohm,
        };
        let lot = (0..650).map(|i| RelayValues::of_lot(&world, scale, 7, i));
        let (good, bad): (Vec<_>, Vec<_>) = lot.partition(|s| s.defect.is_none());
        for part in good.iter().take(6).chain(&bad) {
            let fit_target = part.fit_target(&world);
            let model = Model::new(&fit_target.fit(&world.relay.lumped));
            let what = format!("part {} {:?}", part.index, part.defect);
            let near = |found: f64, drawn: f64, within: f64| {
                assert!(
                    (found / drawn - 1.0).abs() < within,
                    "{what}: {found}, drawn {drawn}"
                );
            };
            near(model.pickup().volts, part.operate_v, 1e-9);
            near(model.release().volts, part.release_v, 1e-9);
            // The times of a defective part are drawn even if its springs do not permit them; the fit comes as near as
            // it can.
            let sound = part.defect.is_none() && part.time_origin == TimeOrigin::Lot;
            if sound || part.time_origin == TimeOrigin::Hinge {
                near(fit_target.operate_s(&model) * 1e3, part.operate_ms, 1e-3);
            }
            if sound || part.time_origin == TimeOrigin::Iron {
                near(fit_target.release_s(&model) * 1e3, part.release_ms, 1e-3);
            }
        }
    }
}

#[test]
fn the_lot_follows_the_table_and_contains_every_defect() {
    let world = read_world(&files(), None)
        .unwrap()
        .relays(&files())
        .unwrap();
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    let lot: Vec<RelayValues> = (0..2600)
        .map(|i| RelayValues::of_lot(&world, scale, 7, i))
        .collect();
    let good: Vec<&RelayValues> = lot.iter().filter(|s| s.defect.is_none()).collect();
    assert_eq!(lot.len() - good.len(), 104, "4 % of 2600");
    for &kind in Defect::ALL {
        let count = lot.iter().filter(|s| s.defect == Some(kind)).count();
        assert_eq!(count, 8, "{kind:?}");
    }
    let moments = |f: fn(&RelayValues) -> f64| {
        let n = good.len() as f64;
        let mean = good.iter().map(|s| f(s)).sum::<f64>() / n;
        (
            mean,
            (good.iter().map(|s| (f(s) - mean).powi(2)).sum::<f64>() / n).sqrt(),
        )
    };
    for (f, mean, sd) in [
        ((|s| s.operate_v) as fn(&RelayValues) -> f64, 7.88, 0.26),
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
fn a_seed_draws_the_recorded_relays() {
    let world = read_world(&files(), None)
        .unwrap()
        .relays(&files())
        .unwrap();
    let drawn = |seed, index, nominal_v, nominal_coil_ohm| {
        let scale = Scale {
            nominal_v,
            nominal_coil_ohm,
        };
        RelayValues::of_lot(&world, scale, seed, index)
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

#[test]
fn a_24_v_lot_has_twice_the_thresholds() {
    let world = read_world(&files(), None)
        .unwrap()
        .relays(&files())
        .unwrap();
    let of_lot = |nominal_v, nominal_coil_ohm, index| {
        let scale = Scale {
            nominal_v,
            nominal_coil_ohm,
        };
        RelayValues::of_lot(&world, scale, 7, index)
    };
    for index in 0..300 {
        let (part, scaled) = (of_lot(12.0, 400.0, index), of_lot(24.0, 1600.0, index));
        let twice = [part.operate_v * 2.0, part.release_v * 2.0];
        for (found, twice) in [scaled.operate_v, scaled.release_v].into_iter().zip(twice) {
            assert!((found / twice - 1.0).abs() < 1e-12, "{found}, not {twice}");
        }
        assert_eq!(scaled.coil_ohm, part.coil_ohm * 4.0);
        assert_eq!(scaled.defect, part.defect);
        assert_eq!(scaled.operate_ms, part.operate_ms);
    }
}
