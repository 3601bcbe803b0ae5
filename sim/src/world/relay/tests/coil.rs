//! Tests of coil temperature and coil current.

use super::*;

#[test]
fn thresholds_and_resistance_follow_the_copper() {
    let world = still_world();
    let specimen = reference_relay(&world).values().clone();
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
fn a_released_relay_carries_full_coil_current_again() {
    let world = read_world(&files(), None)
        .unwrap()
        .relays(&files())
        .unwrap();
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    for i in 0..300 {
        let specimen = RelayValues::of_lot(&world, scale, 3, i);
        if specimen.coil_ohm.is_infinite() {
            continue;
        }
        let draw = Draw::new(3, Subject::LotOperations, i);
        let mut relay = Relay::new(specimen, &world, draw, 0.0, 23.0, 23.0);
        let off = Supply::Off {
            suppression_v: world.board.zener_v,
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
