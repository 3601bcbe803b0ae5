//! Tests of trials on nominal chambers.
#![allow(clippy::unwrap_used)]

use super::*;

fn worst_k(medium: Medium, name: &str) -> f64 {
    let chamber = Plant::nominal(medium, 1).identify(medium).unwrap();
    nominal(Contender::named(name), medium, &chamber, 1.0)
        .track(5.0)
        .worst_k
}

#[test]
fn feed_forward_keeps_the_bar_in_every_medium() {
    for medium in [Medium::Air, Medium::Oil, Medium::Block] {
        let found = worst_k(medium, DEFAULT);
        assert!(found <= RATES[2].1, "{}: {found}", medium.name());
    }
}

#[test]
fn feedback_alone_misses_the_bar() {
    let found = worst_k(Medium::Air, "PID tc=th");
    assert!(found > 2.0 * RATES[2].1, "{found}");
}

#[test]
fn every_name_of_the_table_is_a_row_of_its_own() {
    for contender in CONTENDERS {
        assert_eq!(Contender::named(contender.name), contender);
    }
}
