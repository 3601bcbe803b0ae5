//! Made-up records and parts: ramps behind lags that the tests know.

use super::*;

/// Profile of the air: corners of time (s) and temperature (C).
const PASSES: [[f64; 2]; 9] = [
    [0.0, 25.0],
    [300.0, 75.0],
    [540.0, 95.0],
    [660.0, 85.0],
    [1080.0, 50.0],
    [1260.0, 78.0],
    [1740.0, 94.0],
    [1920.0, 75.0],
    [2640.0, 51.0],
];

fn air_c(instant_s: f64) -> f64 {
    let after = PASSES
        .iter()
        .position(|[at, _]| *at > instant_s)
        .unwrap_or(PASSES.len() - 1);
    let ([t0, c0], [t1, c1]) = (PASSES[after - 1], PASSES[after]);
    c0 + (c1 - c0) * (instant_s - t0) / (t1 - t0)
}

fn record() -> Record {
    let mut record = Record::new(0.0, 25.0);
    (0..2640).for_each(|second| record.push(air_c(f64::from(second))));
    record
}

/// Returns what a part with one lag does, in steps of 10 ms.
fn part(operate_c: f64, reset_c: f64, lag_s: f64) -> Switching {
    let (mut part, mut body_c, mut open) = (Switching::default(), 25.0, false);
    for step in 0..263_900 {
        let at = f64::from(step) / 100.0;
        body_c += (air_c(at) - body_c) * 0.01 / lag_s;
        if !open && body_c >= operate_c {
            part.operate.push(Transition::at(at));
            open = true;
        } else if open && body_c <= reset_c {
            part.reset.push(Transition::at(at));
            open = false;
        }
    }
    part
}

const NOISE: Noise = Noise {
    scatter_k: 0.15,
    sensor_lag_s: 0.0,
};
const LAG: LotLag = LotLag {
    seconds: 40.0,
    u_s: 1.0,
    spread: LAG_SPREAD,
    parts: 40,
};
const LAGS_S: [f64; 5] = [34.0, 37.0, 40.0, 43.0, 46.0];

fn lot() -> Vec<Switching> {
    (0..)
        .zip(LAGS_S)
        .map(|(i, lag)| part(84.0 + f64::from(i), 64.0 + f64::from(i), lag))
        .collect()
}

#[test]
fn filtering_with_the_true_lag_gives_the_switching_temperature() {
    let record = record();
    let part = part(85.0, 65.0, 39.0);
    assert_eq!((part.operate.len(), part.reset.len()), (2, 2));
    let filtered = record.filtered(39.0);
    for (all, truth) in [(&part.operate, 85.0), (&part.reset, 65.0)] {
        for it in all {
            let found = filtered.at(it.first_s).unwrap().celsius;
            assert!((found - truth).abs() < 0.01, "{found}");
        }
    }
}

#[test]
fn the_lag_of_a_lot_is_the_mean_of_its_parts() {
    let found = lot_lag(&record(), &lot(), &NOISE).unwrap();
    assert!((found.seconds - 40.0).abs() < 1.0, "{found:?}");
}

#[test]
fn a_wild_part_does_not_move_the_lag() {
    let mut parts = lot();
    let mut wild = parts[0].clone();
    wild.operate[1].first_s += 90.0;
    parts.push(wild);
    let found = lot_lag(&record(), &parts, &NOISE).unwrap();
    assert!((found.seconds - 40.0).abs() < 1.0, "{found:?}");
}

/// Returns a lot whose parts have these lags, s.
fn lot_of(lags_s: &[f64]) -> Vec<Switching> {
    let one = |(place, lag_s): (usize, &f64)| part(84.0 + 0.1 * place as f64, 64.0, *lag_s);
    lags_s.iter().enumerate().map(one).collect()
}

#[test]
fn a_mixture_of_lags_counts_whole() {
    let (record, lags_s) = (record(), [20.0, 80.0, 20.0, 80.0, 20.0, 80.0, 20.0]);
    let parts = lot_of(&lags_s);
    let lag = lot_lag(&record, &parts, &NOISE).unwrap();
    assert_eq!(lag.parts, lags_s.len());
    assert!((0.6..=0.75).contains(&lag.spread), "{lag:?}");
    assert_eq!(lot_scatter(&record, &parts, &lag, &NOISE), NOISE.scatter_k);
    for ((place, part), lag_s) in parts.iter().enumerate().zip(lags_s) {
        let found = estimate(&record, part, &lag, &NOISE).unwrap();
        let operate = found.operate.unwrap();
        let off_k = operate.value - 84.0 - 0.1 * place as f64;
        assert!(off_k.abs() < 0.05 && operate.u_k < 0.4, "{found:?}");
        assert!((found.lag_s / lag_s - 1.0).abs() < 0.05, "{found:?}");
    }
}

#[test]
fn a_few_slow_parts_widen_no_lot() {
    let (record, mut lags_s) = (record(), vec![36.0, 38.0, 40.0, 40.0, 42.0, 44.0]);
    lags_s.push(110.0);
    let parts = lot_of(&lags_s);
    let lag = lot_lag(&record, &parts, &NOISE).unwrap();
    assert_eq!((lag.parts, lag.spread), (6, LAG_SPREAD));
    let slow = estimate(&record, &parts[6], &lag, &NOISE).unwrap();
    assert!((90.0..115.0).contains(&slow.lag_s), "{slow:?}");
    assert!((slow.operate.unwrap().value - 84.6).abs() < 0.3, "{slow:?}");
}

#[test]
fn one_event_leaves_the_lag_of_the_lot() {
    let record = record();
    let mut once = part(85.0, 65.0, 80.0);
    once.operate.truncate(1);
    once.reset.clear();
    let narrow = estimate(&record, &once, &LAG, &NOISE).unwrap();
    let wide = LotLag { spread: 0.7, ..LAG };
    let wide = estimate(&record, &once, &wide, &NOISE).unwrap();
    for found in [narrow, wide] {
        assert!((found.lag_s - 40.0).abs() < 1e-9, "{found:?}");
    }
    let [narrow, wide] = [narrow, wide].map(|it| it.operate.unwrap());
    assert!(wide.u_k > 4.0 * narrow.u_k, "{narrow:?} {wide:?}");
    assert!((wide.value - 85.0).abs() < 2.0 * wide.u_k, "{wide:?}");
}

#[test]
fn events_of_nonsense_leave_finite_figures() {
    let record = record();
    let at = |all: &[f64]| all.iter().map(|it| Transition::at(*it)).collect();
    let all: [(&[f64], &[f64]); 4] = [
        (&[500.0, 300.0], &[900.0, 1000.0]),
        (&[10.0, 2600.0], &[]),
        (&[100.0, 100.0], &[100.0, 100.0]),
        (&[0.0], &[0.0, 2600.0]),
    ];
    for (operate, reset) in all {
        let part = Switching {
            operate: at(operate),
            reset: at(reset),
        };
        let found = estimate(&record, &part, &LAG, &NOISE).unwrap();
        let operate = found.operate.unwrap();
        assert!(operate.value.is_finite() && operate.u_k.is_finite());
        assert!((1.0..=1000.0).contains(&found.lag_s), "{found:?}");
        lot_lag(&record, &[part], &NOISE);
    }
}

#[test]
fn the_change_with_the_lag_is_the_derivative() {
    let record = record();
    for lag_s in [0.5, 3.0, 40.0, 300.0] {
        let [below, at, above] = [0.999, 1.0, 1.001].map(|it| record.filtered(it * lag_s));
        for instant_s in [100.3, 555.5, 1300.0, 2600.7] {
            let [below, at, above] = [&below, &at, &above].map(|it| it.at(instant_s).unwrap());
            let expected = (above.celsius - below.celsius) / (0.002 * lag_s);
            let found = at.per_lag_k_per_s;
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
    }
}

#[test]
fn one_pass_tells_no_lag() {
    let mut once = lot();
    for part in &mut once {
        part.operate.truncate(1);
        part.reset.truncate(1);
    }
    assert_eq!(lot_lag(&record(), &once, &NOISE), None);
}

#[test]
fn two_passes_take_out_the_lag_of_each_part() {
    let (record, parts) = (record(), lot());
    let lag = lot_lag(&record, &parts, &NOISE).unwrap();
    let noise = Noise {
        scatter_k: 0.05,
        sensor_lag_s: 0.0,
    };
    for (place, part) in (0..).zip(&parts) {
        let found = estimate(&record, part, &lag, &noise).unwrap();
        let operate = found.operate.unwrap();
        assert!(
            (operate.value - 84.0 - f64::from(place)).abs() < 2.0 * operate.u_k,
            "{found:?}"
        );
        assert!(
            (found.differential.unwrap().value - 20.0).abs() < 0.15,
            "{found:?}"
        );
        assert!(
            (found.lag_s - LAGS_S[place as usize]).abs() < 2.5,
            "{found:?}"
        );
    }
}

#[test]
fn one_pass_leaves_the_spread_of_lags_in_the_uncertainty() {
    let (record, parts) = (record(), lot());
    let mut once = parts[4].clone();
    once.operate.truncate(1);
    once.reset.truncate(1);
    let found = estimate(&record, &once, &LAG, &NOISE).unwrap();
    let rate = 5.0 / 60.0;
    let expected = (0.15f64.powi(2) + rate * rate * (0.25 + 37.0)).sqrt();
    assert!(
        (found.operate.unwrap().u_k - expected).abs() < 0.06,
        "{found:?}"
    );
}

#[test]
fn a_part_that_never_resets_has_no_reset_temperature() {
    let (record, parts) = (record(), lot());
    let lag = lot_lag(&record, &parts, &NOISE).unwrap();
    let mut stays = parts[2].clone();
    stays.reset.clear();
    stays.operate.truncate(1);
    let found = estimate(&record, &stays, &lag, &NOISE).unwrap();
    assert!(found.operate.is_some());
    assert_eq!(
        (found.reset, found.differential, found.range_k),
        (None, None, None)
    );
}

#[test]
fn an_event_outside_the_record_gives_nothing() {
    let record = record();
    let late = Switching {
        operate: vec![Transition::at(9e9)],
        reset: Vec::new(),
    };
    assert_eq!(estimate(&record, &late, &LAG, &NOISE), None);
    assert_eq!(record.filtered(40.0).at(f64::NAN), None);
}

#[test]
fn passes_that_disagree_raise_the_scatter_of_the_lot() {
    let (record, mut parts) = (record(), lot());
    let lag = lot_lag(&record, &parts, &NOISE).unwrap();
    assert_eq!(lot_scatter(&record, &parts, &lag, &NOISE), NOISE.scatter_k);
    assert_eq!(lot_scatter(&record, &[], &lag, &NOISE), NOISE.scatter_k);
    // 8 s at 5 K/min are 0.7 K, and at 2 K/min 0.3 K.
    for part in &mut parts {
        part.operate[0].first_s += 8.0;
        part.reset[1].first_s += 8.0;
    }
    let found = lot_scatter(&record, &parts, &lag, &NOISE);
    assert!((0.2..=0.75).contains(&found), "{found}");
}

#[test]
fn the_spread_of_lags_explains_no_scatter() {
    let (record, mut parts) = (record(), lot());
    for part in &mut parts {
        part.operate[0].first_s += 8.0;
        part.reset[1].first_s += 8.0;
    }
    let lag = lot_lag(&record, &parts, &NOISE).unwrap();
    let [narrow, wide] = [0.05, 0.7].map(|spread| {
        let lag = LotLag { spread, ..lag };
        lot_scatter(&record, &parts, &lag, &NOISE)
    });
    assert!((wide / narrow - 1.0).abs() < 1e-9, "{narrow} {wide}");
}

#[test]
fn the_lag_of_the_sensor_widens_the_spread_of_lags() {
    let (record, parts) = (record(), lot());
    let lag = lot_lag(&record, &parts, &NOISE).unwrap();
    let mut once = parts[2].clone();
    once.operate.truncate(1);
    once.reset.truncate(1);
    let u_k = |sensor_lag_s| {
        let found = estimate(
            &record,
            &once,
            &lag,
            &Noise {
                sensor_lag_s,
                ..NOISE
            },
        )
        .unwrap();
        found.operate.unwrap().u_k
    };
    assert!(u_k(8.0) > 1.1 * u_k(0.0), "{} {}", u_k(8.0), u_k(0.0));
}

#[test]
fn a_part_outside_the_record_leaves_the_others_their_spread() {
    let (record, mut parts) = (record(), lot());
    let expected = lot_lag(&record, &parts, &NOISE).unwrap();
    let mut wild = parts[0].clone();
    wild.operate[1].first_s += 90.0;
    wild.reset.clear();
    let mut late = parts[0].clone();
    late.operate[1].first_s = 9e9;
    late.reset.clear();
    parts.insert(0, wild);
    parts.insert(0, late);
    let found = lot_lag(&record, &parts, &NOISE).unwrap();
    assert_eq!(found.parts, expected.parts);
    assert!((found.seconds - expected.seconds).abs() < 1e-6, "{found:?}");
}

/// Returns the record of the profile without the readings of some seconds.
fn record_without(missing: std::ops::Range<i32>) -> Record {
    let mut record = Record::new(0.0, 25.0);
    for second in 0..2640 {
        let is_missing = missing.contains(&second);
        record.push(if is_missing {
            f64::NAN
        } else {
            air_c(f64::from(second))
        });
    }
    record
}

#[test]
fn missing_first_readings_keep_the_later_ones_in_place() {
    let (whole, late) = (record(), record_without(0..5));
    assert_eq!(late.seconds(), whole.seconds());
    let [expected, found] = [&whole, &late].map(|it| it.filtered(0.0).at(400.0).unwrap());
    assert!((found.celsius - expected.celsius).abs() < 1e-9);
    assert_eq!(late.filtered(40.0).at(2.0), None);
}

#[test]
fn a_short_gap_is_crossed_in_a_straight_line() {
    let (whole, gap) = (record(), record_without(700..703));
    for instant_s in [701.5, 720.0] {
        let [expected, found] =
            [&whole, &gap].map(|it| it.filtered(40.0).at(instant_s).unwrap().celsius);
        assert!((found - expected).abs() < 1e-9, "{found}, {expected}");
    }
}

#[test]
fn a_long_gap_gives_no_temperature_until_it_is_forgotten() {
    // The air turns at 540 s: a straight line cuts off the peak.
    let (whole, gap) = (record(), record_without(535..545));
    for lag_s in [0.0, 10.0, 40.0, 400.0] {
        let (whole, gap) = (whole.filtered(lag_s), gap.filtered(lag_s));
        let void = (0..2638)
            .filter(|second| gap.at(f64::from(*second)).is_none())
            .count();
        assert_eq!(void, 10 + 50, "{lag_s}");
        for second in (0..534).chain(595..2638) {
            let [expected, found] =
                [&whole, &gap].map(|it| it.at(f64::from(second)).unwrap().celsius);
            assert!((found - expected).abs() < 0.05, "{lag_s}, {second}");
        }
    }
}

#[test]
fn a_part_that_switches_in_a_gap_has_no_estimate() {
    let part = part(85.0, 65.0, 39.0);
    let second = part.operate[0].first_s as i32;
    let lag = LotLag {
        seconds: 39.0,
        ..LAG
    };
    let short = record_without(second..second + 3);
    let long = record_without(second..second + 4);
    assert!(estimate(&short, &part, &lag, &NOISE).is_some());
    assert_eq!(estimate(&long, &part, &lag, &NOISE), None);
}
