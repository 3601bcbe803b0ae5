//! The nest: eight states, ten inputs.

use super::{Graph, SEEN, show, truths};
use crate::dut::em_relay::measure::{Bench, Test};
use crate::dut::verdict::Bin;
use crate::instrument::act::JobDone;
use crate::rig::point::DigitalIn;
use crate::station::clamp::{Beside, Clamp};
use crate::station::ledger::Ledger;
use crate::station::sort::Sort;
use crate::station::tests::{Shop, bench};

const STATES: [&str; 9] = [
    "Empty",
    "Clamping",
    "Probing",
    "Testing",
    "TestOver",
    "Judged",
    "Gripping",
    "Unclamping",
    "Lifting",
];

/// The state of this name; a test that is over has only its switching off before it.
fn state(name: &str, shop: &Shop, bench: &Bench) -> Clamp {
    match name {
        "Empty" => Clamp::Empty,
        "Clamping" => Clamp::Clamping,
        "Probing" => Clamp::Probing,
        "Testing" => Clamp::Testing(Box::new(Test::begin(bench.clone(), shop.now))),
        "TestOver" => Clamp::Testing(Box::new(failed(shop, bench))),
        "Judged" => Clamp::Judged,
        "Gripping" => Clamp::Gripping,
        "Unclamping" => Clamp::Unclamping,
        "Lifting" => Clamp::Lifting,
        other => panic!("{other}"),
    }
}

fn failed(shop: &Shop, bench: &Bench) -> Test {
    let mut test = Test::begin(bench.clone(), shop.now);
    test.step(shop.now, None, &shop.image);
    test.step(shop.now, Some(&silent(shop)), &shop.image);
    test
}

fn silent(shop: &Shop) -> JobDone {
    JobDone {
        at: shop.now,
        trouble: Some("measure 05: silent".into()),
    }
}

fn name(clamp: &Clamp) -> &'static str {
    match clamp {
        Clamp::Empty => "Empty",
        Clamp::Clamping => "Clamping",
        Clamp::Probing => "Probing",
        Clamp::Testing(_) => "Testing",
        Clamp::Judged => "Judged",
        Clamp::Gripping => "Gripping",
        Clamp::Unclamping => "Unclamping",
        Clamp::Lifting => "Lifting",
    }
}

/// A part is in the nest in every state but the first, where it may be.
fn ledger(from: &str, part: bool, interrupted: bool, judged: bool) -> Ledger {
    let mut ledger = Ledger::default();
    if part || from != "Empty" {
        ledger.enter_pocket();
        ledger.enter_nest(None);
    }
    if let Some(part) = &mut ledger.nest {
        part.interrupted = interrupted.then(|| "by a reset".to_owned());
        part.bin = judged.then_some(Bin::RETEST);
    }
    ledger
}

#[test]
fn the_nest_is_the_drawing() {
    let mut graph = Graph::default();
    let mut shop = Shop::at_rest();
    let bench = bench();
    let jaws_open = [DigitalIn::JawLeftOpen, DigitalIn::JawRightOpen];
    let jaws_closed = [DigitalIn::JawLeftClosed, DigitalIn::JawRightClosed];
    for (jaws, probes) in SEEN.iter().flat_map(|one| SEEN.map(|other| (*one, other))) {
        for (z, gripper) in SEEN.iter().flat_map(|one| SEEN.map(|other| (*one, other))) {
            for [pusher, seated] in truths() {
                show(&mut shop, &jaws_open, &jaws_closed, jaws);
                show(
                    &mut shop,
                    &[DigitalIn::ProbeDown],
                    &[DigitalIn::ProbeUp],
                    probes,
                );
                show(&mut shop, &[DigitalIn::SortZUp], &[DigitalIn::SortZDown], z);
                show(
                    &mut shop,
                    &[DigitalIn::GripperOpen],
                    &[DigitalIn::GripperPart],
                    gripper,
                );
                shop.set(DigitalIn::PusherRetracted, pusher);
                shop.set(DigitalIn::NestPresent, seated);
                shop.after(1);
                for from in STATES {
                    for [part, interrupted, judged, around, resting] in truths() {
                        let clamp = state(from, &shop, &bench);
                        let job = (from == "TestOver").then(|| silent(&shop));
                        shop.ledger = ledger(from, part, interrupted, judged);
                        let mut sort = if around { Sort::AtPart } else { Sort::OverNest };
                        let mut turn = shop.turn();
                        turn.resting = resting;
                        let beside = Beside {
                            job,
                            bench: &bench,
                            sort: &mut sort,
                            last_left: &mut None,
                        };
                        let next = clamp.step(&mut turn, beside);
                        let drawn = if from == "TestOver" { "Testing" } else { from };
                        graph.add(drawn, name(&next), &shop.wants);
                        assert!(shop.ledger.balances());
                    }
                }
            }
        }
    }
    graph.is("nest", include_str!("../golden/nest.dot"), 81 * 4 * 9 * 32);
    graph.is_told_by(FACTS, include_str!("../clamp.rs"));
}

/// From, to, and the test that walks there.
const FACTS: &[(&str, &str, &str)] = &[
    (
        "Empty",
        "Clamping",
        "the_test_begins_with_the_pins_once_the_probes_are_up",
    ),
    (
        "Clamping",
        "Probing",
        "the_test_begins_with_the_pins_once_the_probes_are_up",
    ),
    (
        "Probing",
        "Testing",
        "the_test_begins_with_the_pins_once_the_probes_are_up",
    ),
    (
        "Testing",
        "Judged",
        "a_failed_job_voids_the_part_under_test_and_sends_it_to_retest",
    ),
    (
        "Clamping",
        "Judged",
        "a_part_that_was_interrupted_is_clamped_and_not_tested",
    ),
    (
        "Judged",
        "Gripping",
        "a_judged_part_stays_clamped_until_the_gripper_has_it",
    ),
    (
        "Gripping",
        "Unclamping",
        "a_judged_part_stays_clamped_until_the_gripper_has_it",
    ),
    (
        "Unclamping",
        "Lifting",
        "a_judged_part_stays_clamped_until_the_gripper_has_it",
    ),
    (
        "Lifting",
        "Empty",
        "the_part_changes_hands_when_z_is_up_and_the_nest_is_seen_empty",
    ),
];
