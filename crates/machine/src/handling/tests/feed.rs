//! The feed moves one part at a time from the track into the pocket, and only into a free nest.

use super::MockRig;
use super::device;
use crate::handling::feed::Feed;
use crate::handling::ledger::PartRole;
use crate::handling::moves::Move;
use crate::handling::place::{NestId, Place};
use crate::handling::serial::{Serials, Source};
use crate::rig::point::DigitalIn;
use std::collections::BTreeSet;
use units::Span;

fn step(feed: Feed, mock: &mut MockRig, wanted: bool) -> Feed {
    feed.step(&mut mock.turn(), NestId::FIRST, wanted, true)
}

/// Makes a rig with a part in the pocket and the escapement closed.
fn ready() -> (Feed, MockRig) {
    let mut mock = MockRig::at_rest();
    mock.ledger.enter_pocket();
    mock.set(DigitalIn::PocketPresent, true);
    mock.scan();
    (Feed::Ready, mock)
}

#[test]
fn a_part_gets_its_number_in_the_nest() {
    let mut mock = MockRig::at_rest();
    let feed = step(Feed::Empty, &mut mock, true);
    assert_eq!(mock.output.rig.motions, [Move::EscapementRelease]);
    mock.carried_out(Move::EscapementRelease);
    let feed = step(feed, &mut mock, true);
    assert!(matches!(feed, Feed::Releasing { .. }));
    mock.set(DigitalIn::PocketPresent, true);
    mock.after(50);
    let feed = step(feed, &mut mock, true);
    assert_eq!(
        (feed, &*mock.output.rig.motions),
        (Feed::Holding, &[Move::EscapementHold][..])
    );
    mock.carried_out(Move::EscapementHold);
    let feed = step(feed, &mut mock, true);
    let feed = step(feed, &mut mock, true);
    assert_eq!(
        (feed, &*mock.output.rig.motions),
        (Feed::Pushing, &[Move::PusherExtend][..])
    );
    mock.set(DigitalIn::NestPresent, true);
    mock.carried_out(Move::PusherExtend);
    let feed = step(feed, &mut mock, true);
    assert_eq!(
        (feed, &*mock.output.rig.motions),
        (Feed::Retracting, &[Move::PusherRetract][..])
    );
    assert_eq!(
        mock.ledger.part(Place::NEST).map(|part| part.role.clone()),
        Some(PartRole::Lot(1))
    );
    assert_eq!(step(feed, &mut mock, true), Feed::Retracting);
    mock.carried_out(Move::PusherRetract);
    assert_eq!(step(feed, &mut mock, false), Feed::Empty);
    assert!(mock.ledger.balances());
}

#[test]
fn releasing_needs_demand_and_a_retracted_pusher() {
    let mut mock = MockRig::at_rest();
    assert_eq!(step(Feed::Empty, &mut mock, false), Feed::Empty);
    mock.set(DigitalIn::PusherRetracted, false);
    mock.scan();
    assert_eq!(step(Feed::Empty, &mut mock, true), Feed::Empty);
    assert!(mock.output.rig.motions.is_empty());
}

#[test]
fn an_absent_part_is_an_alarm_after_three_attempts() {
    for (track, code) in [(true, "part_not_arrived"), (false, "magazine_empty")] {
        let mut mock = MockRig::at_rest();
        mock.set(DigitalIn::TrackLevel, track);
        mock.scan();
        let mut feed = step(Feed::Empty, &mut mock, true);
        for attempt in 1..=3 {
            assert_eq!(mock.output.rig.motions, [Move::EscapementRelease]);
            let since = mock.now;
            mock.carried_out(Move::EscapementRelease);
            mock.now = since + Span::ms(1500);
            mock.scan();
            feed = step(feed, &mut mock, true);
            assert!(mock.output.rig.motions.is_empty() && mock.alarms().is_empty());
            mock.after(1);
            feed = step(feed, &mut mock, true);
            assert_eq!(mock.output.rig.motions, [Move::EscapementHold]);
            let alarms = mock.alarms();
            let expected = if attempt < 3 {
                "escapement_retried"
            } else {
                code
            };
            assert_eq!(alarms, [expected]);
            mock.carried_out(Move::EscapementHold);
            feed = step(feed, &mut mock, true);
        }
        assert_eq!((feed, mock.ledger.came_in), (Feed::Empty, 0));
    }
}

#[test]
fn a_part_that_comes_late_takes_its_own_scan() {
    let mut mock = MockRig::at_rest();
    mock.serials = Serials::new(Source::Wedge, BTreeSet::new());
    for serial in ["S-1", "S-2"] {
        assert_eq!(mock.serials.scan(serial, &mock.ledger), Ok(()));
    }
    let feed = step(Feed::Empty, &mut mock, true);
    mock.carried_out(Move::EscapementRelease);
    mock.after(1501);
    let feed = step(feed, &mut mock, true);
    assert_eq!(feed, Feed::Closing { attempts: 1 });
    mock.set(DigitalIn::PocketPresent, true);
    mock.carried_out(Move::EscapementHold);
    let feed = step(feed, &mut mock, true);
    assert_eq!(step(feed, &mut mock, true), Feed::Ready);
    mock.turn().enter_nest(NestId::FIRST);
    let part = mock.ledger.part(Place::NEST).unwrap();
    assert_eq!(part.serial.as_deref(), Some("S-1"));
}

#[test]
fn a_part_in_the_pocket_is_fed_first() {
    let mut mock = MockRig::at_rest();
    mock.set(DigitalIn::PocketPresent, true);
    mock.scan();
    let feed = step(Feed::Empty, &mut mock, true);
    assert!(matches!(feed, Feed::Ready));
    assert!(mock.ledger.holds(Place::Pocket) && mock.ledger.came_in == 1);
}

#[test]
fn the_pusher_starts_only_into_a_free_nest() {
    let occupied: [(&str, &[(DigitalIn, bool)]); 6] = [
        ("part in the nest", &[(DigitalIn::NestPresent, true)]),
        ("left jaw closed", &[(DigitalIn::JawLeftOpen, false)]),
        ("right jaw closed", &[(DigitalIn::JawRightOpen, false)]),
        ("probes not down", &[(DigitalIn::ProbeDown, false)]),
        ("z not up", &[(DigitalIn::SortZUp, false)]),
        ("escapement open", &[(DigitalIn::EscapementHold, false)]),
    ];
    for (what, sensors) in occupied {
        let (feed, mut mock) = ready();
        for (point, state) in sensors {
            mock.set(*point, *state);
        }
        mock.scan();
        assert_eq!(step(feed, &mut mock, true), Feed::Ready, "{what}");
        assert!(mock.output.rig.motions.is_empty(), "{what}");
    }
    let (feed, mut mock) = ready();
    mock.now = mock.now + units::Span::ms(401);
    assert_eq!(step(feed, &mut mock, true), Feed::Ready, "stale sensors");
    let (feed, mut mock) = ready();
    assert_eq!(step(feed, &mut mock, false), Feed::Pushing, "nest is free");
}

#[test]
fn the_ledger_allows_one_part_per_nest() {
    let (feed, mut mock) = ready();
    mock.ledger.enter_nest(NestId::FIRST, None);
    mock.ledger.enter_pocket();
    assert_eq!(step(feed, &mut mock, true), Feed::Ready);
}

#[test]
fn a_pusher_at_an_empty_nest_is_an_alarm() {
    let (feed, mut mock) = ready();
    let feed = step(feed, &mut mock, true);
    mock.carried_out(Move::PusherExtend);
    assert_eq!(step(feed, &mut mock, true), Feed::Pushing);
    assert_eq!(mock.alarms(), ["part_not_in_nest"]);
    assert!(mock.ledger.holds(Place::Pocket) && !mock.ledger.holds(Place::NEST));
}

#[test]
fn reference_parts_come_first_in_magazine_order() {
    let (feed, mut mock) = ready();
    mock.reference_serials = device().reference_serials().into();
    let feed = step(feed, &mut mock, true);
    mock.set(DigitalIn::NestPresent, true);
    mock.carried_out(Move::PusherExtend);
    step(feed, &mut mock, true);
    assert_eq!(
        mock.ledger.part(Place::NEST).map(|part| part.role.clone()),
        Some(PartRole::Reference("G-12-1".into()))
    );
    assert_eq!(mock.reference_serials.len(), 4);
}

/// Attempts to feed for the given time while no part comes; the escapement closes again.
fn called_in_vain(mock: &mut MockRig, attempt: u8) -> Feed {
    let since = mock.now;
    mock.now = since + Span::ms(1501);
    mock.scan();
    let feed = step(Feed::Releasing { since, attempt }, mock, true);
    assert_eq!(feed, Feed::Closing { attempts: attempt });
    mock.carried_out(Move::EscapementHold);
    feed
}

#[test]
fn a_late_or_unwanted_part_ends_the_attempts() {
    for attempt in [1, 2] {
        let mut mock = MockRig::at_rest();
        let closed = called_in_vain(&mut mock, attempt);
        assert_eq!(step(closed, &mut mock, false), Feed::Empty);
        let again = step(closed, &mut mock, true);
        mock.set(DigitalIn::PocketPresent, true);
        mock.after(50);
        assert_eq!(
            step(closed, &mut mock, true),
            Feed::Empty,
            "it came while it closed"
        );
        assert_eq!(step(again, &mut mock, true), Feed::Holding);
    }
}
