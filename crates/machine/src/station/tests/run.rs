//! Whole runs: every part lands, a stop finishes the parts inside, equal inputs give equal outputs.

use super::machine::{Machine, Specimen, quiet, station};
use crate::handling::moves::Move;
use crate::handling::place::Place;
use crate::station::turn::{Ending, Inputs};

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
        let output = machine.turn();
        assert_eq!(output.record.ending, Some(Ending::Stopped), "{turns} turns");
        assert!(
            output.rig.safe && output.rig.motions.is_empty(),
            "{turns}: {output:?}"
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
        let turns = machine.turns.iter();
        turns.flat_map(|turn| turn.driven.clone()).collect()
    };
    assert_eq!(driven(&once).len(), driven(&twice).len());
}

#[test]
fn equal_inputs_give_equal_output() {
    let mut machine = Machine::new(Some(4), MIXED.to_vec());
    machine.run();
    let mut again = station(Some(4), &machine.mock);
    for turn in &machine.turns {
        let inputs = Inputs {
            image: &turn.image,
            job: turn.job.clone(),
            recorded: turn.recorded,
            bus: turn.bus.iter().cloned().collect(),
            stop: turn.stop,
            ..quiet(&turn.image)
        };
        let output = again.step(turn.now, inputs);
        assert_eq!(format!("{output:?}"), turn.output, "at {:?}", turn.now);
        for movement in &turn.driven {
            again.driven(*movement, turn.now, &turn.image);
        }
    }
    assert!(machine.turns.len() > 500);
}
