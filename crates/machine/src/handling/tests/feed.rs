//! The feed moves one part at a time from the track into the pocket, and only into a free nest.

use super::Shop;
use super::device;
use crate::handling::feed::Feed;
use crate::handling::ledger::Kind;
use crate::handling::moves::Move;
use crate::handling::place::{NestId, Place};
use crate::rig::point::DigitalIn;
use units::Span;

fn step(feed: Feed, shop: &mut Shop, wanted: bool) -> Feed {
    feed.step(&mut shop.turn(), NestId::FIRST, wanted, true)
}

/// Makes a shop with a part in the pocket and the escapement closed.
fn ready() -> (Feed, Shop) {
    let mut shop = Shop::at_rest();
    shop.ledger.enter_pocket();
    shop.set(DigitalIn::PocketPresent, true);
    shop.scan();
    (Feed::Ready, shop)
}

#[test]
fn a_part_gets_its_number_in_the_nest() {
    let mut shop = Shop::at_rest();
    let feed = step(Feed::Empty, &mut shop, true);
    assert_eq!(shop.wants.rig.motions, [Move::EscapementRelease]);
    shop.carried_out(Move::EscapementRelease);
    let feed = step(feed, &mut shop, true);
    assert!(matches!(feed, Feed::Releasing { .. }));
    shop.set(DigitalIn::PocketPresent, true);
    shop.after(50);
    let feed = step(feed, &mut shop, true);
    assert_eq!(
        (feed, &*shop.wants.rig.motions),
        (Feed::Holding, &[Move::EscapementHold][..])
    );
    shop.carried_out(Move::EscapementHold);
    let feed = step(feed, &mut shop, true);
    let feed = step(feed, &mut shop, true);
    assert_eq!(
        (feed, &*shop.wants.rig.motions),
        (Feed::Pushing, &[Move::PusherExtend][..])
    );
    shop.set(DigitalIn::NestPresent, true);
    shop.carried_out(Move::PusherExtend);
    let feed = step(feed, &mut shop, true);
    assert_eq!(
        (feed, &*shop.wants.rig.motions),
        (Feed::Retracting, &[Move::PusherRetract][..])
    );
    assert_eq!(
        shop.ledger.part(Place::NEST).map(|part| part.kind.clone()),
        Some(Kind::Lot(1))
    );
    assert_eq!(step(feed, &mut shop, true), Feed::Retracting);
    shop.carried_out(Move::PusherRetract);
    assert_eq!(step(feed, &mut shop, false), Feed::Empty);
    assert!(shop.ledger.balances());
}

#[test]
fn releasing_needs_demand_and_a_retracted_pusher() {
    let mut shop = Shop::at_rest();
    assert_eq!(step(Feed::Empty, &mut shop, false), Feed::Empty);
    shop.set(DigitalIn::PusherRetracted, false);
    shop.scan();
    assert_eq!(step(Feed::Empty, &mut shop, true), Feed::Empty);
    assert!(shop.wants.rig.motions.is_empty());
}

#[test]
fn an_absent_part_is_an_alarm_after_three_attempts() {
    for (track, code) in [(true, "part_not_arrived"), (false, "magazine_empty")] {
        let mut shop = Shop::at_rest();
        shop.set(DigitalIn::TrackLevel, track);
        shop.scan();
        let mut feed = step(Feed::Empty, &mut shop, true);
        for attempt in 1..=3 {
            assert_eq!(shop.wants.rig.motions, [Move::EscapementRelease]);
            let since = shop.now;
            shop.carried_out(Move::EscapementRelease);
            shop.now = since + Span::ms(1500);
            shop.scan();
            feed = step(feed, &mut shop, true);
            assert!(shop.wants.rig.motions.is_empty() && shop.alarms().is_empty());
            shop.after(1);
            feed = step(feed, &mut shop, true);
            assert_eq!(shop.wants.rig.motions, [Move::EscapementHold]);
            let told = shop.alarms();
            let expected = if attempt < 3 {
                "escapement_retried"
            } else {
                code
            };
            assert_eq!(told, [expected]);
            shop.carried_out(Move::EscapementHold);
            feed = step(feed, &mut shop, true);
        }
        assert_eq!((feed, shop.ledger.came_in), (Feed::Empty, 0));
    }
}

#[test]
fn a_part_in_the_pocket_is_fed_first() {
    let mut shop = Shop::at_rest();
    shop.set(DigitalIn::PocketPresent, true);
    shop.scan();
    let feed = step(Feed::Empty, &mut shop, true);
    assert!(matches!(feed, Feed::Ready));
    assert!(shop.ledger.holds(Place::Pocket) && shop.ledger.came_in == 1);
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
        let (feed, mut shop) = ready();
        for (point, state) in sensors {
            shop.set(*point, *state);
        }
        shop.scan();
        assert_eq!(step(feed, &mut shop, true), Feed::Ready, "{what}");
        assert!(shop.wants.rig.motions.is_empty(), "{what}");
    }
    let (feed, mut shop) = ready();
    shop.now = shop.now + units::Span::ms(401);
    assert_eq!(step(feed, &mut shop, true), Feed::Ready, "stale sensors");
    let (feed, mut shop) = ready();
    assert_eq!(step(feed, &mut shop, false), Feed::Pushing, "nest is free");
}

#[test]
fn the_ledger_allows_one_part_per_nest() {
    let (feed, mut shop) = ready();
    shop.ledger.enter_nest(NestId::FIRST, None);
    shop.ledger.enter_pocket();
    assert_eq!(step(feed, &mut shop, true), Feed::Ready);
}

#[test]
fn a_pusher_at_an_empty_nest_is_an_alarm() {
    let (feed, mut shop) = ready();
    let feed = step(feed, &mut shop, true);
    shop.carried_out(Move::PusherExtend);
    assert_eq!(step(feed, &mut shop, true), Feed::Pushing);
    assert_eq!(shop.alarms(), ["part_not_in_nest"]);
    assert!(shop.ledger.holds(Place::Pocket) && !shop.ledger.holds(Place::NEST));
}

#[test]
fn reference_parts_come_first_in_magazine_order() {
    let (feed, mut shop) = ready();
    shop.golden = device().reference_serials().into();
    let feed = step(feed, &mut shop, true);
    shop.set(DigitalIn::NestPresent, true);
    shop.carried_out(Move::PusherExtend);
    step(feed, &mut shop, true);
    assert_eq!(
        shop.ledger.part(Place::NEST).map(|part| part.kind.clone()),
        Some(Kind::Reference("G-12-1".into()))
    );
    assert_eq!(shop.golden.len(), 4);
}

/// Attempts to feed for the given time while no part comes; the escapement closes again.
fn called_in_vain(shop: &mut Shop, attempt: u8) -> Feed {
    let since = shop.now;
    shop.now = since + Span::ms(1501);
    shop.scan();
    let feed = step(Feed::Releasing { since, attempt }, shop, true);
    assert_eq!(feed, Feed::Closing { attempts: attempt });
    shop.carried_out(Move::EscapementHold);
    feed
}

#[test]
fn a_late_or_unwanted_part_ends_the_attempts() {
    for attempt in [1, 2] {
        let mut shop = Shop::at_rest();
        let closed = called_in_vain(&mut shop, attempt);
        assert_eq!(step(closed, &mut shop, false), Feed::Empty);
        let again = step(closed, &mut shop, true);
        shop.set(DigitalIn::PocketPresent, true);
        shop.after(50);
        assert_eq!(
            step(closed, &mut shop, true),
            Feed::Empty,
            "it came while it closed"
        );
        assert_eq!(step(again, &mut shop, true), Feed::Holding);
    }
}
