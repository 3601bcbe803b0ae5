//! Visits every state of the sorter that its inputs can reach: nine states, eleven inputs, and the fall of the part.

use super::{Graph, SEEN, SensedEnd, show, truths};
use crate::handling::ledger::Ledger;
use crate::handling::moves::Move;
use crate::handling::place::{NestId, Place};
use crate::handling::sort::Sort;
use crate::handling::tests::MockRig;
use crate::handling::tests::mock_rig::Output;
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

fn name(sort: Sort) -> &'static str {
    match sort {
        Sort::Returning => "Returning",
        Sort::OverNest => "OverNest",
        Sort::Lowering => "Lowering",
        Sort::AtPart => "AtPart",
        Sort::Loaded => "Loaded",
        Sort::Carrying(_) => "Carrying",
        Sort::OverBin(..) => "OverBin",
        Sort::LettingGo(..) => "LettingGo",
        Sort::Opening => "Opening",
    }
}

/// Returns every state, with its station of the axis.
fn states(mock: &MockRig) -> [(Sort, AxisStation); 9] {
    let over = RigTime(mock.now.0 - 500);
    let bin = AxisStation::Bin(Bin::PASS);
    [
        (Sort::Returning, AxisStation::Nest),
        (Sort::OverNest, AxisStation::Nest),
        (Sort::Lowering, AxisStation::Nest),
        (Sort::AtPart, AxisStation::Nest),
        (Sort::Loaded, bin),
        (Sort::Carrying(Bin::PASS), bin),
        (Sort::OverBin(Bin::PASS, over), bin),
        (Sort::LettingGo(Bin::PASS, 0), bin),
        (Sort::Opening, bin),
    ]
}

/// Makes the ledger of a state: a part is in the gripper from `Loaded` to `LettingGo`, and a released one may be
/// falling since `since`.
fn ledger(sort: Sort, falling: bool, since: RigTime) -> Ledger {
    let mut ledger = Ledger::default();
    let mut lift = || {
        ledger.enter_pocket();
        ledger.enter_nest(NestId::FIRST, None);
        ledger.lift(NestId::FIRST);
    };
    if falling {
        lift();
    }
    let carries = matches!(
        sort,
        Sort::Loaded | Sort::Carrying(_) | Sort::OverBin(..) | Sort::LettingGo(..)
    );
    if falling {
        ledger.drop_over(Bin::PASS, since, 0);
    }
    if carries {
        ledger.enter_pocket();
        ledger.enter_nest(NestId::FIRST, None);
        ledger.lift(NestId::FIRST);
    }
    if let Some(part) = ledger.part_mut(Place::Gripper) {
        part.bin = Some(Bin::PASS);
    }
    ledger
}

#[test]
fn the_sorter_is_the_drawing() {
    let mut graph = Graph::default();
    let mut mock = MockRig::at_rest();
    let table = mock.wiring.axis().clone();
    for number in 0..9 {
        let (_, station) = states(&mock)[number];
        mock.show_end(Move::AxisTo(station));
        mock.carried_out(Move::AxisTo(station));
        for (z, gripper) in SEEN.iter().flat_map(|one| SEEN.map(|other| (*one, other))) {
            for [axis, pusher, dark, part] in truths() {
                show(&mut mock, &[DigitalIn::SortZUp], &[DigitalIn::SortZDown], z);
                mock.set(DigitalIn::AxisInPosition, axis);
                mock.set(DigitalIn::PusherRetracted, pusher);
                mock.set(DigitalIn::GripperOpen, gripper == SensedEnd::Rest);
                mock.set(DigitalIn::GripperPart, part);
                mock.set(table.beam(Bin::PASS), dark);
                mock.after(1);
                for [counted, testing, resting, falling, late, recorded] in truths() {
                    if counted {
                        mock.beam(table.beam(Bin::PASS), 0);
                    }
                    let (sort, _) = states(&mock)[number];
                    let ago = if late { Span::ms(501) } else { Span::ms(500) };
                    mock.ledger = ledger(sort, falling, RigTime(mock.now.0 - ago.0));
                    mock.recorded = if recorded { u64::MAX } else { 0 };
                    let mut turn = mock.turn();
                    turn.resting = resting;
                    let next = sort.step(&mut turn, &table, testing);
                    graph.add(name(sort), name(next), &mock.output);
                    assert!(mock.ledger.balances());
                    if matches!(sort, Sort::LettingGo(..)) && !falling {
                        let driven = sort.driven(Move::GripperOpen, &mut mock.ledger, mock.now);
                        graph.add(name(sort), name(driven), &Output::default());
                        assert!(mock.ledger.balances());
                    }
                }
            }
        }
    }
    graph.assert_drawn(
        "sorter",
        include_str!("../golden/sorter.dot"),
        9 * 9 * 16 * 64 + 9 * 16 * 32,
    );
    graph.assert_tests(FACTS, include_str!("../sort.rs"));
}

/// Each edge of the graph: from, to, and the test that covers it.
const FACTS: &[(&str, &str, &str)] = &[
    ("Returning", "OverNest", "z_comes_down_only_during_a_test"),
    ("OverNest", "Lowering", "z_comes_down_only_during_a_test"),
    (
        "Lowering",
        "AtPart",
        "the_fingers_surround_the_part_once_z_is_down",
    ),
    (
        "Loaded",
        "Carrying",
        "an_unjudged_part_is_carried_to_retest",
    ),
    (
        "Carrying",
        "OverBin",
        "an_unjudged_part_is_carried_to_retest",
    ),
    ("OverBin", "LettingGo", "a_release_needs_a_durable_record"),
    (
        "LettingGo",
        "Opening",
        "the_fingers_own_the_part_until_they_open",
    ),
    (
        "Opening",
        "Returning",
        "open_fingers_return_only_when_empty",
    ),
    ("Opening", "Opening", "a_sticking_part_is_reported_and_kept"),
];
