//! Tests of the magazine that an operator empties and refills.

use super::*;
use crate::config::read_world;
use crate::world::fault::WorldFaults;
use crate::world::magazine::Magazine;

fn loaded(parts: u64) -> Magazine {
    let options = WorldOptions {
        files: files(),
        seed: 1,
        recipe: "jzc-22f-012".into(),
        parts: Some(parts),
        reference_parts: true,
        ..WorldOptions::default()
    };
    let world = read_world(&files(), None).unwrap();
    Magazine::load(&options, &world, &WorldFaults::default(), 23.0, 23.0).unwrap()
}

/// Empties the magazine; returns number in the lot (`None` for a reference part) and coil resistance (ohm) of each
/// part.
fn emptied(magazine: &mut Magazine) -> Vec<(Option<u64>, f64)> {
    let mut faults = WorldFaults::default();
    let parts = std::iter::from_fn(|| magazine.take(0, &mut faults));
    let told = parts.map(|part| (part.number, part.truth().coil_resistance_ohm.unwrap()));
    told.collect()
}

#[test]
fn a_refilled_magazine_repeats_only_the_reference_parts() {
    let mut first = loaded(2);
    let one = emptied(&mut first);
    let mut second = loaded(3).continuing(&first);
    assert!(second.waiting() > 3);
    let two = emptied(&mut second);
    let reference_parts = |parts: &[(Option<u64>, f64)]| -> Vec<f64> {
        let reference_parts = parts.iter().filter(|(number, _)| number.is_none());
        reference_parts.map(|(_, coil)| *coil).collect()
    };
    assert_eq!(reference_parts(&one), reference_parts(&two));
    assert_eq!(reference_parts(&one).len() + 2, one.len());
    let numbers: Vec<u64> = two.iter().filter_map(|(number, _)| *number).collect();
    assert_eq!(numbers, [3, 4, 5], "no lot part repeats");
    assert_eq!(second.waiting(), 0);
}

#[test]
fn another_day_changes_only_temperatures_of_reference_parts() {
    let on = |day: Option<f64>| {
        let asked: Vec<_> = day
            .map(|it| ("noise_seed".into(), it))
            .into_iter()
            .collect();
        let world = read_world(&files(), None).unwrap();
        let mut faults = WorldFaults::resolve(&asked, &world.fault, &config_dir()).unwrap();
        let part = loaded(0).take(0, &mut faults).unwrap();
        let Specimen::Relay(relay) = part.specimen else {
            unreachable!("a recipe for relays")
        };
        (relay.values().operate_v, relay.values().offset_k)
    };
    let (bodies, kelvin): (Vec<f64>, Vec<f64>) =
        [on(None), on(Some(2.0)), on(Some(3.0))].into_iter().unzip();
    assert_eq!(bodies, [bodies[0]; 3]);
    assert!(
        kelvin[0] != kelvin[1] && kelvin[1] != kelvin[2],
        "{kelvin:?}"
    );
    assert_eq!(on(Some(2.0)), on(Some(2.0)));
}

#[test]
fn a_seed_gives_the_recorded_relays() {
    let recorded = [
        393.939_916_647_943_96,
        396.990_396_147_178_33,
        400.027_266_584_083_6,
        403.064_008_903_734_76,
        406.062_275_600_925,
        400.077_689_582_399_67,
        396.387_549_121_208_9,
    ];
    let found = emptied(&mut loaded(2));
    assert_eq!(found.len(), recorded.len());
    for ((_, ohm), recorded) in found.iter().zip(recorded) {
        assert!((ohm / recorded - 1.0).abs() < 1e-9, "{found:?}");
    }
}
