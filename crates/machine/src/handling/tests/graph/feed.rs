//! The graph of the feed: eight states, eleven inputs.

use super::{Graph, SEEN, show, truths};
use crate::handling::feed::{Feed, TRIES};
use crate::handling::ledger::Ledger;
use crate::handling::place::{NestId, Place};
use crate::handling::tests::MockRig;
use crate::rig::point::DigitalIn;
use units::Span;

fn name(feed: Feed) -> String {
    match feed {
        Feed::Empty => "Empty".into(),
        Feed::Releasing { attempt, .. } => format!("Releasing{attempt}"),
        Feed::Closing { attempts } => format!("Closing{attempts}"),
        Feed::Holding => "Holding".into(),
        Feed::Ready => "Ready".into(),
        Feed::Pushing => "Pushing".into(),
        Feed::Retracting => "Retracting".into(),
    }
}

/// Returns every state; a release began `ago` before now.
fn states(mock: &MockRig, ago: Span) -> Vec<Feed> {
    let since = units::RigTime(mock.now.0 - ago.0);
    let mut states = vec![
        Feed::Empty,
        Feed::Holding,
        Feed::Ready,
        Feed::Pushing,
        Feed::Retracting,
    ];
    for attempt in 1..=TRIES {
        states.push(Feed::Releasing { since, attempt });
        states.push(Feed::Closing { attempts: attempt });
    }
    states
}

/// Returns true for a state that requires a part in the pocket.
fn holds(feed: Feed) -> bool {
    matches!(feed, Feed::Holding | Feed::Ready | Feed::Pushing)
}

fn ledger(feed: Feed, nest: bool, found: bool) -> Ledger {
    let mut ledger = Ledger::default();
    if nest {
        ledger.enter_pocket();
        ledger.enter_nest(NestId::FIRST, None);
    }
    match (holds(feed), found) {
        (true, true) => ledger.find(Place::Pocket),
        (true, false) => ledger.enter_pocket(),
        (false, _) => {}
    }
    ledger
}

#[test]
fn the_feed_is_the_drawing() {
    let mut graph = Graph::default();
    let mut mock = MockRig::at_rest();
    mock.after(2000);
    for [pocket, seated, track, held, jaws, late] in truths() {
        for pusher in SEEN {
            mock.set(DigitalIn::PocketPresent, pocket);
            mock.set(DigitalIn::NestPresent, seated);
            mock.set(DigitalIn::TrackLevel, track);
            mock.set(DigitalIn::EscapementHold, held);
            mock.set(DigitalIn::JawLeftOpen, jaws);
            show(
                &mut mock,
                &[DigitalIn::PusherRetracted],
                &[DigitalIn::PusherExtended],
                pusher,
            );
            mock.after(1);
            let ago = if late { Span::ms(1501) } else { Span::ms(1500) };
            for feed in states(&mock, ago) {
                for [wanted, push, nest, found] in truths() {
                    // The pusher waits for an empty nest, so the nest is empty during a push.
                    let nest = nest && feed != Feed::Pushing;
                    mock.ledger = ledger(feed, nest, found);
                    let next = feed.step(&mut mock.turn(), NestId::FIRST, wanted, push);
                    graph.add(&name(feed), &name(next), &mock.output);
                    assert!(mock.ledger.balances());
                }
            }
        }
    }
    graph.assert_drawn("feed", include_str!("../golden/feed.dot"), 64 * 3 * 11 * 16);
    graph.assert_tests(FACTS, include_str!("../feed.rs"));
}

/// Each edge of the graph: from, to, and the test that covers it.
const FACTS: &[(&str, &str, &str)] = &[
    ("Empty", "Releasing1", "a_part_gets_its_number_in_the_nest"),
    (
        "Releasing1",
        "Holding",
        "a_part_gets_its_number_in_the_nest",
    ),
    ("Holding", "Ready", "a_part_gets_its_number_in_the_nest"),
    (
        "Ready",
        "Pushing",
        "the_pusher_starts_only_into_a_free_nest",
    ),
    (
        "Pushing",
        "Retracting",
        "a_part_gets_its_number_in_the_nest",
    ),
    (
        "Pushing",
        "Pushing",
        "a_pusher_at_an_empty_nest_is_an_alarm",
    ),
    ("Retracting", "Empty", "a_part_gets_its_number_in_the_nest"),
    ("Empty", "Ready", "a_part_in_the_pocket_is_fed_first"),
    (
        "Releasing1",
        "Closing1",
        "an_absent_part_is_an_alarm_after_three_attempts",
    ),
    (
        "Closing1",
        "Releasing2",
        "an_absent_part_is_an_alarm_after_three_attempts",
    ),
    (
        "Releasing2",
        "Closing2",
        "an_absent_part_is_an_alarm_after_three_attempts",
    ),
    (
        "Closing2",
        "Releasing3",
        "an_absent_part_is_an_alarm_after_three_attempts",
    ),
    (
        "Releasing3",
        "Closing3",
        "an_absent_part_is_an_alarm_after_three_attempts",
    ),
    (
        "Closing3",
        "Empty",
        "an_absent_part_is_an_alarm_after_three_attempts",
    ),
    (
        "Releasing2",
        "Holding",
        "a_late_or_unwanted_part_ends_the_attempts",
    ),
    (
        "Releasing3",
        "Holding",
        "a_late_or_unwanted_part_ends_the_attempts",
    ),
    (
        "Closing1",
        "Empty",
        "a_late_or_unwanted_part_ends_the_attempts",
    ),
    (
        "Closing2",
        "Empty",
        "a_late_or_unwanted_part_ends_the_attempts",
    ),
];
