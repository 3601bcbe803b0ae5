#![allow(clippy::unwrap_used)]
use super::*;

/// Correct decimal digits of `found`.
fn digits(found: f64, certified: f64) -> f64 {
    -((found - certified).abs() / certified.abs())
        .max(1e-16)
        .log10()
}

/// NumAcc2, 3, 4 of the NIST reference data sets: one value, then two values in turn.
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
fn few_or_equal_values_have_no_spread_to_speak_of() {
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
