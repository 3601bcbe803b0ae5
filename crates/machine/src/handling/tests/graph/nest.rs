//! The graph of the nest: eight states, ten inputs.

use super::{Graph, SEEN, show, truths};
use crate::dut::device::TestOrder;
use crate::dut::{Device, Procedure};
use crate::handling::ledger::Ledger;
use crate::handling::nest::{Nest, NestContext, NestState, TestTerms};
use crate::handling::place::{NestId, Place};
use crate::handling::sort::Sort;
use crate::handling::tests::{MockRig, device};
use crate::instrument::act::JobDone;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use texts::Message;

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

/// Returns the state with this name; a finished test has only its switching off left.
fn state(name: &str, mock: &MockRig, device: &Device) -> NestState {
    match name {
        "Empty" => NestState::Empty,
        "Clamping" => NestState::Clamping,
        "Probing" => NestState::Probing,
        "Testing" => NestState::Testing(begun(mock, device)),
        "TestOver" => NestState::Testing(failed(mock, device)),
        "Judged" => NestState::Judged,
        "Gripping" => NestState::Gripping,
        "Unclamping" => NestState::Unclamping,
        "Lifting" => NestState::Lifting,
        other => panic!("{other}"),
    }
}

fn begun(mock: &MockRig, device: &Device) -> Procedure {
    let order = TestOrder {
        thorough: false,
        teaching: None,
        number: 1,
    };
    device.begin(&order, mock.now)
}

fn failed(mock: &MockRig, device: &Device) -> Procedure {
    let mut test = begun(mock, device);
    test.step(mock.now, None, &mock.image);
    test.step(mock.now, Some(&silent(mock)), &mock.image);
    test
}

fn silent(mock: &MockRig) -> JobDone {
    JobDone::new(
        mock.now,
        Some(Message::detail("unread", "measure 05: silent")),
    )
}

fn name(state: &NestState) -> &'static str {
    match state {
        NestState::Empty => "Empty",
        NestState::Clamping => "Clamping",
        NestState::Probing => "Probing",
        NestState::Testing(_) => "Testing",
        NestState::Judged => "Judged",
        NestState::Gripping => "Gripping",
        NestState::Unclamping => "Unclamping",
        NestState::Lifting => "Lifting",
    }
}

/// Makes the ledger of a state: a part is in the nest in every state but the first, where it may be, and has its
/// verdict before the fingers close on it.
fn ledger(from: &str, part: bool, interrupted: bool, judged: bool) -> Ledger {
    let mut ledger = Ledger::default();
    if part || from != "Empty" {
        ledger.enter_pocket();
        ledger.enter_nest(NestId::FIRST, None);
    }
    if let Some(part) = ledger.part_mut(Place::NEST) {
        part.interrupted = interrupted.then(|| "reset".to_owned());
        let is_over = matches!(from, "Judged" | "Gripping" | "Unclamping" | "Lifting");
        part.bin = (judged || is_over).then_some(Bin::RETEST);
    }
    ledger
}

#[test]
fn the_nest_is_the_drawing() {
    let mut graph = Graph::default();
    let mut mock = MockRig::at_rest();
    let device = device();
    let jaws_open = [DigitalIn::JawLeftOpen, DigitalIn::JawRightOpen];
    let jaws_closed = [DigitalIn::JawLeftClosed, DigitalIn::JawRightClosed];
    for (jaws, probes) in SEEN.iter().flat_map(|one| SEEN.map(|other| (*one, other))) {
        for (z, gripper) in SEEN.iter().flat_map(|one| SEEN.map(|other| (*one, other))) {
            for [pusher, seated] in truths() {
                show(&mut mock, &jaws_open, &jaws_closed, jaws);
                show(
                    &mut mock,
                    &[DigitalIn::ProbeDown],
                    &[DigitalIn::ProbeUp],
                    probes,
                );
                show(&mut mock, &[DigitalIn::SortZUp], &[DigitalIn::SortZDown], z);
                show(
                    &mut mock,
                    &[DigitalIn::GripperOpen],
                    &[DigitalIn::GripperPart],
                    gripper,
                );
                mock.set(DigitalIn::PusherRetracted, pusher);
                mock.set(DigitalIn::NestPresent, seated);
                mock.after(1);
                for from in STATES {
                    for [part, interrupted, judged, around, resting] in truths() {
                        let mut nest = Nest {
                            id: NestId::FIRST,
                            state: state(from, &mock, &device),
                        };
                        let job = (from == "TestOver").then(|| silent(&mock));
                        mock.ledger = ledger(from, part, interrupted, judged);
                        let mut sort = if around { Sort::AtPart } else { Sort::OverNest };
                        let mut turn = mock.turn();
                        turn.resting = resting;
                        let context = NestContext {
                            done: job,
                            terms: TestTerms {
                                device: &device,
                                thorough: false,
                                teaching: None,
                            },
                            sort: &mut sort,
                            last_left: &mut None,
                        };
                        nest.step(&mut turn, context);
                        let drawn = if from == "TestOver" { "Testing" } else { from };
                        graph.add(drawn, name(&nest.state), &mock.output);
                        assert!(mock.ledger.balances());
                    }
                }
            }
        }
    }
    graph.assert_drawn("nest", include_str!("../golden/nest.dot"), 81 * 4 * 9 * 32);
    graph.assert_tests(FACTS, include_str!("../nest.rs"));
}

/// Each edge of the graph: from, to, and the test that covers it.
const FACTS: &[(&str, &str, &str)] = &[
    (
        "Empty",
        "Clamping",
        "with_probes_up_the_test_begins_with_the_pins",
    ),
    (
        "Clamping",
        "Probing",
        "with_probes_up_the_test_begins_with_the_pins",
    ),
    (
        "Probing",
        "Testing",
        "with_probes_up_the_test_begins_with_the_pins",
    ),
    ("Testing", "Judged", "a_failed_job_sends_the_part_to_retest"),
    (
        "Clamping",
        "Judged",
        "an_interrupted_part_is_clamped_and_not_tested",
    ),
    (
        "Judged",
        "Gripping",
        "the_nest_holds_a_judged_part_until_gripped",
    ),
    (
        "Gripping",
        "Unclamping",
        "the_nest_holds_a_judged_part_until_gripped",
    ),
    (
        "Unclamping",
        "Lifting",
        "the_nest_holds_a_judged_part_until_gripped",
    ),
    ("Lifting", "Empty", "the_gripper_owns_the_part_once_z_is_up"),
];
