//! Tests of the order of contacts, and of the recorded bounce.

use super::*;

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
fn a_short_pulse_recloses_nc_and_never_makes_no() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    relay.drive(0.0, Supply::Volts(12.0));
    assert!(first(&mut relay, 2_900.0, Contact::Nc, false).is_some());
    while relay.advance(2_900.0).is_some() {}
    relay.drive(
        2_900.0,
        Supply::Off {
            suppression_v: 60.0,
        },
    );
    assert!(first(&mut relay, 60_000.0, Contact::Nc, true).is_some());
    assert!(first(&mut relay, 60_000.0, Contact::No, true).is_none());
}

#[test]
fn the_record_holds_the_actual_bounce() {
    let world = still_world();
    let mut relay = reference_relay(&world);
    let drawn: f64 = relay.values().bounce_no_us.iter().skip(1).step_by(2).sum();
    relay.drive(0.0, Supply::Volts(12.0));
    while relay.advance(40_000.0).is_some() {}
    assert!((relay.record.bounce_ms(Contact::No).unwrap() - drawn / 1000.0).abs() < 1e-6);
    assert!((relay.record.time_ms(Contact::No).unwrap() - 4.7308).abs() < 0.001);
}

/// Releases at `at_us`; returns open time of NC after its first make, and its last change after that make,
/// microseconds.
fn released(relay: &mut Relay, at_us: f64) -> (f64, f64) {
    relay.drive(
        at_us,
        Supply::Off {
            suppression_v: 60.0,
        },
    );
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
fn the_record_holds_openings_after_the_bounce_list() {
    let world = still_world();
    let reference = reference_relay(&world).values().clone();
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
