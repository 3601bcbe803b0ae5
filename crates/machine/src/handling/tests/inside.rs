//! A part left by an earlier run is in its place, farther on, or reported.

use super::MockRig;
use crate::dut::em_relay::bins;
use crate::handling::inside::Inside;
use crate::handling::ledger::Ledger;
use crate::handling::place::{NestId, Place};
use crate::handling::recovery::{Recovery, SensedParts};
use crate::handling::trouble::Trouble;
use crate::rig::point::DigitalIn;

/// Makes a set of places from pocket, nest and gripper as bits.
fn left(places: u8) -> Inside {
    Inside {
        pocket: places & 1 != 0,
        nest: places & 2 != 0,
        gripper: places & 4 != 0,
        falling: None,
    }
}

fn seen(places: u8) -> SensedParts {
    SensedParts {
        pocket: places & 1 != 0,
        nest: places & 2 != 0,
        gripper: places & 4 != 0,
    }
}

/// Returns the greatest number of parts accounted for, over all assignments of sensed parts to parts left inside: one
/// from the pocket may be anywhere, one from nest or gripper in either.
fn accounted(left: u8, seen: u8) -> usize {
    let may = |part: usize, place: usize| part == 0 || place > 0;
    let of = |places: u8| (0..3).filter(move |bit| places & (1 << bit) != 0);
    match of(left).next() {
        None => 0,
        Some(part) => {
            let rest = left & !(1 << part);
            let taken = of(seen).filter(|place| may(part, *place));
            let with = taken.map(|place| 1 + accounted(rest, seen & !(1 << place)));
            with.chain([accounted(rest, seen)]).max().unwrap_or(0)
        }
    }
}

#[test]
fn each_missing_part_is_reported_once() {
    for places in 0..8_u8 {
        for found in 0..8_u8 {
            let troubles = left(places).missing(&seen(found)).len();
            let gone = places.count_ones() as usize - accounted(places, found);
            assert_eq!(troubles, gone, "left {places:03b}, seen {found:03b}");
        }
    }
}

#[test]
fn the_report_names_the_place_of_the_part() {
    for (places, found, place) in [
        (0b100, 0, Place::Gripper),
        (0b110, 0b100, Place::Nest(NestId::FIRST)),
        (0b101, 0b10, Place::Gripper),
    ] {
        let troubles = left(places).missing(&seen(found));
        assert_eq!(troubles, [Trouble::Gone(place)], "{places:03b} {found:03b}");
    }
}

#[test]
fn a_released_part_is_reported_unless_still_held() {
    let falling = Inside {
        falling: Some(bins::COIL),
        ..left(0b010)
    };
    let troubles = falling.missing(&seen(0b010));
    assert_eq!(troubles, [Trouble::FallUnseen(bins::COIL)]);
    assert!(falling.missing(&seen(0b110)).is_empty());
}

#[test]
fn a_removed_lifted_part_is_always_reported() {
    let mut written = left(0b011);
    for (places, without_it) in [
        (0b011, 0b001),
        (0b101, 0b001),
        (0b110, 0b010),
        (0b111, 0b011),
    ] {
        let now = left(places);
        if now.needs_record(written) {
            written = now;
        }
        let troubles = written.missing(&seen(without_it)).len();
        assert_eq!(troubles, 1, "{places:03b}");
    }
}

#[test]
fn only_the_first_homing_reports_missing_parts() {
    let mut mock = MockRig::at_rest();
    mock.ledger = Ledger::after(left(0b110));
    mock.set(DigitalIn::NestPresent, true);
    mock.scan();
    assert_eq!(
        mock.ledger.parts_to_find(),
        left(0b110),
        "still to be looked for"
    );
    let mut troubles = Vec::new();
    for _ in 0..2 {
        let mut recovery = Recovery::default();
        for _ in 0..10 {
            recovery.step(&mut mock.turn(), false);
            troubles.extend(mock.alarms());
            mock.after(20);
        }
    }
    assert_eq!(troubles, ["part_lost", "part_found"]);
    assert_eq!(
        mock.ledger.parts_to_find(),
        left(0b010),
        "the one that was found"
    );
    assert_eq!(mock.ledger.lost, 0, "it was none of this run's parts");
}
