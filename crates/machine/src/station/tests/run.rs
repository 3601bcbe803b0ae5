//! Whole runs: every part lands, a stop finishes the parts inside, equal inputs give equal outputs.

use super::machine::{Machine, Specimen, quiet, station};
use crate::handling::moves::Move;
use crate::handling::place::Place;
use crate::station::wants::{Ending, Inputs};

const MIXED: [Specimen; 4] = [
    Specimen::MissingPin,
    Specimen::OpenCoil,
    Specimen::StuckNo,
    Specimen::OpenCoil,
];

#[test]
fn every_part_lands_in_its_bin_in_order() {
    let mut machine = Machine::new(Some(4), MIXED.to_vec());
    let ended = machine.run();
    assert_eq!(ended.record.ending, Some(Ending::Complete));
    assert!(ended.rig.safe && ended.record.alarms.is_empty());
    let expected: Vec<_> = (1..).zip(MIXED.map(Specimen::bin)).collect();
    assert_eq!(machine.landed, expected);
    assert_eq!((machine.left, machine.station.ledger().inside()), (4, 0));
}

#[test]
fn the_next_part_waits_in_the_pocket() {
    let mut machine = Machine::new(Some(4), MIXED.to_vec());
    let mut most = 0;
    for _ in 0..10_000 {
        let ended = machine.turn().record.ending.is_some();
        most = most.max(machine.station.ledger().inside());
        if ended {
            break;
        }
    }
    assert!(most >= 2, "at most {most} parts inside");
}

#[test]
fn an_order_to_stop_finishes_the_parts_inside() {
    let mut machine = Machine::new(None, vec![Specimen::MissingPin; 50]);
    while machine.landed.is_empty() {
        machine.turn();
    }
    machine.stop = true;
    let ended = machine.run();
    assert_eq!(ended.record.ending, Some(Ending::Stopped));
    let ledger = machine.station.ledger();
    assert!(!ledger.holds(Place::NEST) && !ledger.holds(Place::Gripper) && ledger.fall().is_none());
    assert_eq!(ledger.went_out as usize, machine.landed.len());
    assert!(ledger.went_out < 5);
}

#[test]
fn a_second_stop_ends_the_run_at_once() {
    for turns in (0..600).step_by(23) {
        let mut machine = Machine::new(None, vec![Specimen::MissingPin; 50]);
        while machine.landed.is_empty() {
            machine.turn();
        }
        (0..turns).for_each(|_| drop(machine.turn()));
        machine.stop = true;
        assert_eq!(machine.turn().record.ending, None, "{turns} turns");
        machine.abort = true;
        let wants = machine.turn();
        assert_eq!(wants.record.ending, Some(Ending::Stopped), "{turns} turns");
        assert!(
            wants.rig.safe && wants.rig.motions.is_empty(),
            "{turns}: {wants:?}"
        );
    }
}

#[test]
fn more_turns_than_needed_change_nothing() {
    let mut once = Machine::new(Some(4), MIXED.to_vec());
    once.run();
    let mut twice = Machine::new(Some(4), MIXED.to_vec());
    while twice.turn().record.ending.is_none() && twice.turn_without_scan().record.ending.is_none()
    {
    }
    assert_eq!(once.landed, twice.landed);
    let driven = |machine: &Machine| -> Vec<Move> {
        let told = machine.told.iter();
        told.flat_map(|told| told.driven.clone()).collect()
    };
    assert_eq!(driven(&once).len(), driven(&twice).len());
}

#[test]
fn the_same_inputs_give_the_same_wants() {
    let mut machine = Machine::new(Some(4), MIXED.to_vec());
    machine.run();
    let mut again = station(Some(4), &machine.shop);
    for told in &machine.told {
        let inputs = Inputs {
            image: &told.image,
            job: told.job.clone(),
            recorded: told.recorded,
            bus: told.bus.clone(),
            stop: told.stop,
            ..quiet(&told.image)
        };
        let wants = again.step(told.now, inputs);
        assert_eq!(format!("{wants:?}"), told.wants, "at {:?}", told.now);
        for movement in &told.driven {
            again.driven(*movement, told.now, &told.image);
        }
    }
    assert!(machine.told.len() > 500);
}
