#![allow(clippy::unwrap_used)]
use super::*;

fn lag1(values: &[f64]) -> Option<f64> {
    lag1_about(&Spread::of(values), values)
}

/// Returns the number of correct decimal digits in `found`.
fn digits(found: f64, certified: f64) -> f64 {
    -((found - certified).abs() / certified.abs())
        .max(1e-16)
        .log10()
}

/// Returns one of NIST's reference data sets NumAcc2, 3 and 4: one value, then two values in turn.
fn numacc(first: f64, low: f64, high: f64) -> Vec<f64> {
    let rest = (0..1000).map(|n| if n % 2 == 0 { low } else { high });
    std::iter::once(first).chain(rest).collect()
}

#[test]
fn numacc1_keeps_all_digits() {
    let values = [10_000_001.0, 10_000_003.0, 10_000_002.0];
    let spread = Spread::of(&values);
    assert_eq!(
        (spread.mean(), spread.sd(), lag1(&values)),
        (Some(10_000_002.0), Some(1.0), Some(-0.5))
    );
}

#[test]
fn numacc2_has_fourteen_digits() {
    let values = numacc(1.2, 1.1, 1.3);
    let spread = Spread::of(&values);
    assert!(digits(spread.mean().unwrap(), 1.2) > 14.0);
    assert!(digits(spread.sd().unwrap(), 0.1) > 14.0);
    assert!(digits(lag1(&values).unwrap(), -0.999) > 14.0);
}

#[test]
fn numacc3_has_the_digits_that_f64_data_allow() {
    let values = numacc(1_000_000.2, 1_000_000.1, 1_000_000.3);
    let spread = Spread::of(&values);
    assert!(digits(spread.mean().unwrap(), 1_000_000.2) > 14.0);
    assert!(digits(spread.sd().unwrap(), 0.1) >= 9.4);
    assert!(digits(lag1(&values).unwrap(), -0.999) > 9.0);
}

#[test]
fn numacc4_has_the_digits_that_f64_data_allow() {
    let values = numacc(10_000_000.2, 10_000_000.1, 10_000_000.3);
    let spread = Spread::of(&values);
    assert!(digits(spread.mean().unwrap(), 10_000_000.2) > 14.0);
    assert!(digits(spread.sd().unwrap(), 0.1) >= 8.2);
    assert!(digits(lag1(&values).unwrap(), -0.999) > 8.0);
}

/// Checks the figures of a NIST reference data set against its certified mean, deviation and lag-1 autocorrelation.
fn certified(text: &str, n: usize, mean: f64, sd: f64, autocorrelation: f64) {
    let values: Vec<f64> = text
        .split_whitespace()
        .map(|it| it.parse().unwrap())
        .collect();
    let spread = Spread::of(&values);
    assert_eq!(values.len(), n);
    assert!(digits(spread.mean().unwrap(), mean) > 14.5);
    assert!(digits(spread.sd().unwrap(), sd) > 12.0);
    assert!(digits(lag1(&values).unwrap(), autocorrelation) > 12.0);
}

#[test]
fn lottery_has_the_certified_digits() {
    let text = include_str!("nist/lottery.txt");
    certified(
        text,
        218,
        518.958715596330,
        291.699727470969,
        -0.120948622967393,
    );
}

#[test]
fn lew_has_the_certified_digits() {
    let text = include_str!("nist/lew.txt");
    certified(
        text,
        200,
        -177.435000000000,
        277.332168044316,
        -0.307304800605679,
    );
}

#[test]
fn mavro_has_the_certified_digits() {
    let text = include_str!("nist/mavro.txt");
    certified(
        text,
        50,
        2.00185600000000,
        0.000429123454003053,
        0.937989183438248,
    );
}

#[test]
fn michelso_has_the_certified_digits() {
    let text = include_str!("nist/michelso.txt");
    certified(
        text,
        100,
        299.852400000000,
        0.0790105478190518,
        0.535199668621283,
    );
}

#[test]
fn shards_merge_to_the_figures_of_the_whole() {
    let values = numacc(10_000_000.2, 10_000_000.1, 10_000_000.3);
    let whole = Spread::of(&values);
    for size in [1, 2, 7, 100, 1000] {
        let merged = values
            .chunks(size)
            .map(Spread::of)
            .fold(Spread::default(), Spread::merged);
        assert_eq!(merged.n(), whole.n());
        assert_eq!(merged.mean(), whole.mean(), "shards of {size}");
        assert!(
            digits(merged.sd().unwrap(), whole.sd().unwrap()) > 15.0,
            "shards of {size}"
        );
        assert_eq!((merged.min(), merged.max()), (whole.min(), whole.max()));
    }
}

#[test]
fn few_or_equal_values_have_no_spread() {
    assert_eq!(
        (Spread::of(&[]).mean(), Spread::of(&[1.0]).sd()),
        (None, None)
    );
    assert_eq!(
        (Spread::of(&[2.0, 2.0]).sd(), lag1(&[2.0, 2.0])),
        (Some(0.0), None)
    );
    assert_eq!(Spread::of(&[1.0, f64::NAN]).mean(), None);
}

#[test]
fn the_median_is_exact() {
    assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
    assert_eq!(median(&[]), None);
}

#[test]
fn overflowing_squares_give_no_deviation() {
    let spread = Spread::of(&[1e308, -1e308, 0.0]);
    assert_eq!((spread.mean(), spread.sd()), (Some(0.0), None));
}
