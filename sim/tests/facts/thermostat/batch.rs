//! Tests of a batch: the person loads it; it is heated, measured and unloaded.

use super::hand::{Hand, options};

/// Follows a ramp with a simple controller; returns for each contact the reference temperature at its first change.
fn ramp(hand: &mut Hand, to_c: f64, k_per_min: f64) -> Vec<Option<f64>> {
    let [_, mut goal, _] = hand.temperatures();
    let mut changed = vec![None; 40];
    let first = hand.closed();
    let sign = (to_c - goal).signum();
    while (to_c - goal) * sign > 0.0 {
        hand.wait(1.0);
        goal += sign * k_per_min / 60.0;
        let [control, reference, _] = hand.temperatures();
        let u = 0.15 * (goal - control) + sign * k_per_min / 60.0 / 0.264;
        hand.drive(u.clamp(0.0, 1.0), (-u).clamp(0.0, 1.0));
        let now = hand.closed();
        for (place, (before, after)) in first.iter().zip(now).enumerate() {
            if *before != after && changed[place].is_none() {
                changed[place] = Some(reference);
            }
        }
    }
    changed
}

/// Returns for each part the true value with this key.
fn truth(hand: &Hand, key: &str) -> Vec<Option<f64>> {
    let each = hand.rig.truth();
    each.iter().map(|it| it[key].as_f64()).collect()
}

#[test]
fn contacts_change_at_their_temperatures_behind_a_lag() {
    let mut hand = Hand::new(&[]);
    hand.load();
    hand.start();
    let up = ramp(&mut hand, 105.0, 3.0);
    hand.wait(200.0);
    let down = ramp(&mut hand, 45.0, 3.0);
    let mut found = 0;
    let (operate, reset) = (
        truth(&hand, "operate_temperature_c"),
        truth(&hand, "reset_temperature_c"),
    );
    let defects = hand.rig.truth();
    // 39 s of lag at 3 K/min, less 8 s of the sensor, give 1.5 K; lags and sockets scatter.
    for place in 0..40 {
        if !defects[place]["defect"].is_null() {
            continue;
        }
        let late_k = up[place].unwrap() - operate[place].unwrap();
        assert!((0.2..3.2).contains(&late_k), "{place}: {late_k}");
        let late_k = reset[place].unwrap() - down[place].unwrap();
        assert!((0.2..3.2).contains(&late_k), "{place}: {late_k}");
        found += 1;
    }
    assert!(found > 30, "{found}");
}

#[test]
fn the_truth_names_socket_batch_and_order() {
    let mut hand = Hand::new(&[]);
    assert!(hand.rig.truth().is_empty());
    hand.load();
    let first = hand.rig.truth();
    assert_eq!(first.len(), 40);
    assert_eq!(first[6]["seq"], 7);
    assert_eq!(first[6]["socket"], 7);
    assert_eq!(first[6]["batch"], 1);
    for key in [
        "operate_temperature_c",
        "reset_temperature_c",
        "differential_k",
        "contact_resistance_mohm",
        "creep_k",
        "chatter_edges",
        "repeatability_k",
        "defect",
    ] {
        assert!(first[6].get(key).is_some(), "{key}");
    }
    hand.set(&["lamp_unload", "door_lock_release"], true);
    hand.wait(130.0);
    assert!(hand.closed().iter().all(|closed| !closed));
    hand.set(&["lamp_unload"], false);
    hand.wait(130.0);
    let second = hand.rig.truth();
    assert_eq!(second.len(), 80);
    assert_eq!(
        (&second[40]["seq"], &second[40]["batch"]),
        (&41.into(), &2.into())
    );
    hand.set(&["lamp_unload"], true);
    hand.wait(130.0);
    hand.set(&["lamp_unload"], false);
    hand.wait(400.0);
    assert_eq!(hand.rig.truth().len(), 100, "the lot ends");
}

#[test]
fn the_door_is_open_while_the_person_loads() {
    let mut hand = Hand::new(&[]);
    hand.set(&["door_lock_release"], true);
    assert!(hand.is_on("door_closed") && !hand.is_on("door_locked"));
    hand.wait(10.0);
    assert!(!hand.is_on("door_closed"));
    hand.wait(120.0);
    assert!(hand.is_on("door_closed"));
    let closed = hand.closed().iter().filter(|it| **it).count();
    assert!(closed > 30, "{closed}");
}

#[test]
fn the_multiplexer_measures_the_selected_contact() {
    let mut hand = Hand::new(&[]);
    hand.load();
    let resistances = truth(&hand, "contact_resistance_mohm");
    let closed = hand.closed();
    for place in [0, 5, 17, 39] {
        hand.select(place as u8);
        hand.wait(0.1);
        let zero_mv = hand.drop_mv();
        hand.set(&["contact_current"], true);
        hand.wait(0.1);
        let drop_mv = hand.drop_mv();
        hand.set(&["contact_current"], false);
        if closed[place] {
            let mohm = (drop_mv - zero_mv) / 0.1;
            let known = resistances[place].unwrap();
            assert!((mohm / known - 1.0).abs() < 0.6, "{place}: {mohm} {known}");
        } else {
            assert!(drop_mv > 190.0, "{place}: {drop_mv}");
        }
    }
    let own = truth(&hand, "contact_resistance_mohm");
    assert!(
        own[17] != resistances[17] || !closed[17],
        "the measured closure counts"
    );
}

#[test]
fn counters_count_chatter_between_polls() {
    let mut hand = Hand::in_world("[thermostat.defects]\nrate_pct = 100.0\n");
    hand.load();
    let defects = hand.rig.truth();
    let place = |name: &str| {
        let found = defects.iter().position(|it| it["defect"] == name);
        found.expect("every defect is there")
    };
    let (chatter, clean) = (place("chatter"), place("high_resistance"));
    let before = [hand.count(chatter), hand.count(clean)];
    hand.start();
    ramp(&mut hand, 105.0, 3.0);
    assert!(hand.count(chatter) > before[0] + 4);
    assert_eq!(hand.count(clean), before[1]);
}

#[test]
fn a_broken_wire_reads_open() {
    let mut hand = Hand::new(&["socket_open=3"]);
    hand.load();
    assert!(!hand.is_closed(2));
    let wrong = rigsim::build(&options(1, &["socket_open=41"]));
    let message = wrong.expect_err("no such socket").to_string();
    assert!(
        message.contains("41") && message.contains("socket"),
        "{message}"
    );
}

#[test]
fn the_same_seed_gives_the_same_batch() {
    let run = |seed| {
        let mut hand = Hand::of(&options(seed, &[]));
        hand.load();
        hand.start();
        let changes = ramp(&mut hand, 70.0, 20.0);
        (changes, hand.temperatures(), hand.rig.truth())
    };
    assert_eq!(run(5), run(5));
    assert_ne!(run(5).1, run(6).1);
}

#[test]
fn a_lot_without_parts_leaves_the_rack_empty() {
    let none = rigsim::Options {
        parts: Some(0),
        ..options(1, &[])
    };
    let mut hand = Hand::of(&none);
    hand.set(&["door_lock_release"], true);
    hand.wait(300.0);
    assert!(hand.is_on("door_closed") && hand.rig.truth().is_empty());
    hand.rig.refill(&options(1, &[])).expect("a lot");
    hand.wait(130.0);
    assert_eq!(hand.rig.truth().len(), 40);
}
