//! Tests of small batches, and of the arithmetic of the figures.
#![allow(clippy::unwrap_used)]

use super::rig::{Outcome, Rig};
use super::score::{Miss, Quantity, coverage_pct, mean_k, misses, rms_k};
use super::world::Kind;
use super::*;
use machine::dut::thermostat::Parameter;

fn rig(kind: Kind) -> Rig {
    Rig::new(kind, world::DEFAULT, 1).unwrap()
}

#[test]
fn two_passes_find_the_lag_and_every_temperature() {
    let found = rig(Kind::KSD9700)
        .batch(&batch(0, 12, [5.0, 2.0]), None)
        .unwrap();
    assert_eq!(found.parts.len(), 12);
    let lag = found.lesson.lag.unwrap();
    // Behind the reference sensor, whose lag and delay are about 8 s.
    assert!((24.0..40.0).contains(&lag.seconds), "{lag:?}");
    for quantity in Quantity::ALL {
        for Miss { error_k, u_k } in misses([&found], quantity) {
            assert!(
                error_k.abs() < 2.0 * u_k,
                "{}: {error_k}, {u_k}",
                quantity.name()
            );
        }
    }
}

#[test]
fn a_known_lag_saves_a_pass() {
    let rig = rig(Kind::KSD9700);
    let two = rig.batch(&batch(0, 12, [5.0, 2.0]), None).unwrap();
    let one = rig.batch(&batch(1, 12, [5.0, 2.0]), Some(&two)).unwrap();
    assert!(
        one.minutes < 0.75 * two.minutes,
        "{} {}",
        one.minutes,
        two.minutes
    );
    let ranges = |it: &Outcome| {
        let parts = it.parts.iter();
        let all = parts.flat_map(|(found, _)| found.record.each(Parameter::Repeatability));
        all.count()
    };
    assert_eq!((ranges(&one), ranges(&two)), (0, 12));
}

#[test]
fn figures_of_errors_are_those_of_statistics() {
    let all: Vec<Miss> = [0.3, -0.1, 0.5, -0.7]
        .map(|error_k| Miss { error_k, u_k: 0.4 })
        .into();
    assert!((rms_k(&all).unwrap() - 0.21f64.sqrt()).abs() < 1e-12);
    assert!(mean_k(&all).unwrap().abs() < 1e-12);
    assert_eq!(coverage_pct(&all), Some(50.0));
    assert_eq!(coverage_pct(&[]), None);
}

#[test]
fn a_killed_batch_is_safe_and_restarts_cold() {
    let found = kill::kills(3, 2).unwrap();
    assert!(found.heating > 0 && found.hot > 0, "{found:?}");
    assert_eq!(
        (found.unsafe_after, found.wrong_starts),
        (0, 0),
        "{found:?}"
    );
    assert!(found.ended.is_empty(), "{found:?}");
}

#[test]
fn storms_over_batches_break_no_rule() {
    assert_eq!(storm::storms(1..=3).unwrap(), []);
}
