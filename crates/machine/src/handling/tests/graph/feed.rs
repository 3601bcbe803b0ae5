//! The graph of the feed: eight states, eleven inputs.

use super::{Graph, SEEN, show, truths};
use crate::handling::feed::{Feed, TRIES};
use crate::handling::ledger::Ledger;
use crate::handling::place::{NestId, Place};
use crate::handling::tests::Shop;
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
fn states(shop: &Shop, ago: Span) -> Vec<Feed> {
    let since = units::RigTime(shop.now.0 - ago.0);
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

/// Returns the ledger content that a state requires: a part in the pocket while the feed has one.
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
    let mut shop = Shop::at_rest();
    shop.after(2000);
    for [pocket, seated, track, held, jaws, late] in truths() {
        for pusher in SEEN {
            shop.set(DigitalIn::PocketPresent, pocket);
            shop.set(DigitalIn::NestPresent, seated);
            shop.set(DigitalIn::TrackLevel, track);
            shop.set(DigitalIn::EscapementHold, held);
            shop.set(DigitalIn::JawLeftOpen, jaws);
            show(
                &mut shop,
                &[DigitalIn::PusherRetracted],
                &[DigitalIn::PusherExtended],
                pusher,
            );
            shop.after(1);
            let ago = if late { Span::ms(1501) } else { Span::ms(1500) };
            for feed in states(&shop, ago) {
                for [wanted, push, nest, found] in truths() {
                    // The pusher waits for an empty nest, so the nest is empty during a push.
                    let nest = nest && feed != Feed::Pushing;
                    shop.ledger = ledger(feed, nest, found);
                    let next = feed.step(&mut shop.turn(), NestId::FIRST, wanted, push);
                    graph.add(&name(feed), &name(next), &shop.wants);
                    assert!(shop.ledger.balances());
                }
            }
        }
    }
    graph.is("feed", include_str!("../golden/feed.dot"), 64 * 3 * 11 * 16);
    graph.is_told_by(FACTS, include_str!("../feed.rs"));
}

/// From, to, and the test of this edge.
const FACTS: &[(&str, &str, &str)] = &[
    (
        "Empty",
        "Releasing1",
        "a_part_goes_from_track_to_nest_and_gets_its_number_there",
    ),
    (
        "Releasing1",
        "Holding",
        "a_part_goes_from_track_to_nest_and_gets_its_number_there",
    ),
    (
        "Holding",
        "Ready",
        "a_part_goes_from_track_to_nest_and_gets_its_number_there",
    ),
    (
        "Ready",
        "Pushing",
        "the_pusher_starts_only_into_a_nest_that_is_free_in_every_respect",
    ),
    (
        "Pushing",
        "Retracting",
        "a_part_goes_from_track_to_nest_and_gets_its_number_there",
    ),
    (
        "Pushing",
        "Pushing",
        "a_pusher_at_an_empty_nest_is_an_alarm",
    ),
    (
        "Retracting",
        "Empty",
        "a_part_goes_from_track_to_nest_and_gets_its_number_there",
    ),
    (
        "Empty",
        "Ready",
        "a_part_left_in_the_pocket_is_fed_before_another_is_let_in",
    ),
    (
        "Releasing1",
        "Closing1",
        "a_part_that_does_not_come_is_called_three_times_before_it_is_an_alarm",
    ),
    (
        "Closing1",
        "Releasing2",
        "a_part_that_does_not_come_is_called_three_times_before_it_is_an_alarm",
    ),
    (
        "Releasing2",
        "Closing2",
        "a_part_that_does_not_come_is_called_three_times_before_it_is_an_alarm",
    ),
    (
        "Closing2",
        "Releasing3",
        "a_part_that_does_not_come_is_called_three_times_before_it_is_an_alarm",
    ),
    (
        "Releasing3",
        "Closing3",
        "a_part_that_does_not_come_is_called_three_times_before_it_is_an_alarm",
    ),
    (
        "Closing3",
        "Empty",
        "a_part_that_does_not_come_is_called_three_times_before_it_is_an_alarm",
    ),
    (
        "Releasing2",
        "Holding",
        "a_part_that_comes_at_a_later_call_or_is_not_wanted_any_more_ends_the_calls",
    ),
    (
        "Releasing3",
        "Holding",
        "a_part_that_comes_at_a_later_call_or_is_not_wanted_any_more_ends_the_calls",
    ),
    (
        "Closing1",
        "Empty",
        "a_part_that_comes_at_a_later_call_or_is_not_wanted_any_more_ends_the_calls",
    ),
    (
        "Closing2",
        "Empty",
        "a_part_that_comes_at_a_later_call_or_is_not_wanted_any_more_ends_the_calls",
    ),
];
