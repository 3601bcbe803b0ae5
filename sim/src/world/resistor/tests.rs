//! Tests of the values that a lot of dummies draws, and of one dummy on the probes.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::config::read_world;
use crate::world::draw::{Draw, Subject};
use crate::world::probes::Contact;
use crate::world::specimen::Arrival;
use crate::world::tests::files;

/// Returns the arrival from a magazine at this temperature.
fn arrival(track_c: f64) -> Arrival {
    Arrival {
        t_us: 0.0,
        track_c,
        ambient_c: track_c,
        draw: Draw::new(1, Subject::LotOperations, 0),
        dirty_pin: None,
        misoriented: false,
    }
}

fn lot() -> Lot {
    Lot::new(&read_world(&files(), None).unwrap(), &files()).unwrap()
}

/// Returns the first part with this defect, or the first without one.
fn first(defect: Option<Defect>) -> Resistor {
    let lot = lot();
    let mut parts = (0..600).map(|i| lot.part(7, i, &arrival(REFERENCE_C)));
    parts.find(|part| part.defect == defect).unwrap()
}

#[test]
fn the_lot_scatters_about_its_nominal_value() {
    let lot = lot();
    let parts: Vec<Resistor> = (0..2400)
        .map(|i| lot.part(7, i, &arrival(REFERENCE_C)))
        .collect();
    let good: Vec<f64> = parts
        .iter()
        .filter(|part| part.defect.is_none())
        .map(|part| part.resistance_ohm)
        .collect();
    assert_eq!(parts.len() - good.len(), 120, "5 % of 2400");
    let n = good.len() as f64;
    let mean = good.iter().sum::<f64>() / n;
    let sd = (good.iter().map(|ohm| (ohm - mean).powi(2)).sum::<f64>() / n).sqrt();
    assert!((mean - 390.0).abs() < 0.1, "{mean} ohm");
    assert!((sd / 0.975 - 1.0).abs() < 0.06, "{sd} ohm");
}

#[test]
fn defects_are_equally_frequent_and_far_off() {
    let lot = lot();
    let parts: Vec<Resistor> = (0..1200)
        .map(|i| lot.part(7, i, &arrival(REFERENCE_C)))
        .collect();
    for &kind in Defect::OF_A_LOT {
        let bad: Vec<f64> = parts
            .iter()
            .filter(|part| part.defect == Some(kind))
            .map(|part| part.resistance_ohm)
            .collect();
        assert_eq!(bad.len(), 20, "{kind:?}");
        for ohm in bad {
            let fits = match kind {
                Defect::Open => ohm.is_infinite(),
                Defect::Short => (0.2..2.0).contains(&ohm),
                Defect::WrongValue => {
                    (255.0..330.0).contains(&ohm) || (460.0..595.0).contains(&ohm)
                }
                Defect::Misoriented => false,
            };
            assert!(fits, "{kind:?}: {ohm} ohm");
        }
    }
}

#[test]
fn the_current_follows_the_supply_at_once() {
    let mut part = first(None);
    for volts in [0.5, 2.5, 5.0] {
        part.drive(0.0, Supply::Volts(volts));
        assert_eq!(part.input_a(), volts / part.input_ohm());
        assert_eq!(part.advance(1e6), None);
    }
    part.drive(
        1e6,
        Supply::Off {
            suppression_v: 60.0,
        },
    );
    assert_eq!(part.input_a(), 0.0);
}

#[test]
fn an_open_part_carries_no_current() {
    let mut part = first(Some(Defect::Open));
    part.drive(0.0, Supply::Volts(5.0));
    assert_eq!(part.input_a(), 0.0);
}

#[test]
fn resistance_follows_temperature_by_its_coefficient() {
    let lot = lot();
    let [cold, warm] = [REFERENCE_C, REFERENCE_C + 10.0].map(|c| lot.part(7, 0, &arrival(c)));
    let ratio = warm.input_ohm() / cold.input_ohm();
    assert!((ratio - 1.000_25).abs() < 1e-8, "{ratio}");
    assert_eq!(warm.truth(), cold.truth(), "stated at 23 C");
}

#[test]
fn blind_pins_are_there_and_no_contact_closes() {
    let mut part = first(None);
    part.drive(0.0, Supply::Volts(20.0));
    assert_eq!(part.pins(), Pins::ALL);
    assert_eq!(part.contact_mohm(Contact::No), None);
    assert_eq!(part.contact_mohm(Contact::Nc), None);
}

#[test]
fn a_misoriented_dummy_matches_a_misoriented_relay() {
    let arrival = Arrival {
        misoriented: true,
        ..arrival(REFERENCE_C)
    };
    let part = lot().part(7, 0, &arrival);
    assert!(!part.pins().input());
    assert_eq!(part.pins().kelvin, [true, true, false, true, true]);
    assert_eq!(part.truth().defect, Some("turned"));
}

#[test]
fn the_truth_holds_one_value_and_the_defect() {
    let good = first(None);
    assert_eq!(good.truth().resistance_ohm, Some(good.resistance_ohm));
    assert_eq!(good.truth().defect, None);
    assert_eq!(good.truth().coil_resistance_ohm, None);
    for (defect, name) in [
        (Defect::Short, "short"),
        (Defect::WrongValue, "wrong_value"),
    ] {
        let bad = first(Some(defect));
        assert_eq!(bad.truth().resistance_ohm, Some(bad.resistance_ohm));
        assert_eq!(bad.truth().defect, Some(name));
    }
    let open = first(Some(Defect::Open)).truth();
    assert_eq!((open.resistance_ohm, open.defect), (None, Some("open")));
}
