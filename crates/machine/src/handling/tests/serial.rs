//! Serial numbers: counted, read at the pocket, scanned before loading.

use crate::dut::reason::SerialFault;
use crate::handling::ledger::{Ledger, Part};
use crate::handling::place::{NestId, Place};
use crate::handling::serial::{ScanRefused, Serials, Source, counted, readable};
use crate::rig::bin::Bin;
use std::collections::BTreeSet;
use units::{RigTime, Span};

fn reader() -> Serials {
    let timeout = Span::ms(1000);
    Serials::new(Source::Reader { timeout }, BTreeSet::new())
}

/// Moves a part through pocket and nest with these readings; returns it.
fn feed(serials: &mut Serials, ledger: &mut Ledger, readings: &[Option<&str>]) -> Part {
    serials.released();
    ledger.enter_pocket();
    serials.arrived(RigTime(0), true);
    let readings: Vec<_> = readings.iter().map(|it| it.map(str::to_owned)).collect();
    serials.readings(&readings);
    ledger.enter_nest(NestId::FIRST, None);
    serials.assign(ledger, Place::NEST);
    let part = ledger.part(Place::NEST).unwrap().clone();
    ledger.lose(Place::NEST);
    part
}

fn fault(part: &Part) -> Option<SerialFault> {
    part.serial_fault.as_ref().map(|(fault, _)| *fault)
}

#[test]
fn a_template_takes_lot_and_number() {
    let said = |template| counted(template, "L-1", 17);
    assert_eq!(said("{lot}-{number:06}").as_deref(), Some("L-1-000017"));
    assert_eq!(said("SN{number}/{lot}").as_deref(), Some("SN17/L-1"));
    for wrong in [
        "{number}",
        "{lot}",
        "{lot}{number:6}",
        "{lot}{number}{x}",
        "{lot}{number:0x}",
    ] {
        assert_eq!(said(wrong), None, "{wrong}");
    }
}

#[test]
fn counted_numbers_go_on_after_earlier_runs() {
    let source = Source::Counted {
        template: "{lot}-{number}".into(),
        lot: "A".into(),
        given: 20,
    };
    let (mut serials, mut ledger) = (Serials::new(source, BTreeSet::new()), Ledger::default());
    let numbers = [(); 2].map(|()| feed(&mut serials, &mut ledger, &[]).serial.unwrap());
    assert_eq!(numbers, ["A-21", "A-22"]);
}

#[test]
fn each_part_gets_its_own_reading() {
    let (mut serials, mut ledger) = (reader(), Ledger::default());
    let part = feed(&mut serials, &mut ledger, &[Some(" S-1\n"), Some("S-1")]);
    assert_eq!((part.serial.as_deref(), fault(&part)), (Some("S-1"), None));
    let part = feed(&mut serials, &mut ledger, &[Some("S-2")]);
    assert_eq!((part.serial.as_deref(), fault(&part)), (Some("S-2"), None));
}

#[test]
fn missing_and_ambiguous_readings_give_no_number() {
    let (mut serials, mut ledger) = (reader(), Ledger::default());
    for (readings, expected) in [
        (&[][..], SerialFault::Missing),
        (&[None][..], SerialFault::Missing),
        (&[Some("\u{7}")][..], SerialFault::Missing),
        (&[Some("S-1"), Some("S-2")][..], SerialFault::Ambiguous),
    ] {
        let part = feed(&mut serials, &mut ledger, readings);
        assert_eq!((part.serial.clone(), fault(&part)), (None, Some(expected)));
        assert!(part.why_untested().is_some());
    }
}

#[test]
fn a_number_is_taken_once_its_part_has_landed() {
    let (mut serials, mut ledger) = (reader(), Ledger::default());
    let serial = "S-1".to_owned();
    serials.landed(Some(&serial), Bin::RETEST);
    let part = feed(&mut serials, &mut ledger, &[Some("S-1")]);
    assert_eq!(fault(&part), None, "a part from retest comes again");
    serials.landed(Some(&serial), Bin::PASS);
    let part = feed(&mut serials, &mut ledger, &[Some("S-1")]);
    assert_eq!(fault(&part), Some(SerialFault::Repeated));
    assert_eq!(part.serial, Some(serial));
}

#[test]
fn the_pusher_waits_for_a_reading() {
    let mut serials = reader();
    serials.released();
    serials.arrived(RigTime(0), true);
    assert!(!serials.is_settled(RigTime(1_000_000)));
    assert!(serials.is_settled(RigTime(1_000_001)));
    serials.readings(&[None]);
    assert!(serials.is_settled(RigTime(1)));
    serials.released();
    serials.readings(&[Some("S-1".into())]);
    serials.arrived(RigTime(5), true);
    assert!(serials.is_settled(RigTime(5)), "faster than the sensor");
}

#[test]
fn a_scan_goes_to_the_next_part() {
    let (mut serials, mut ledger) = (
        Serials::new(Source::Wedge, BTreeSet::new()),
        Ledger::default(),
    );
    assert!(!serials.may_release());
    for (text, answer) in [
        ("S-1", Ok(())),
        ("S-1", Err(ScanRefused::Repeated)),
        ("", Err(ScanRefused::Unreadable)),
        ("S-2", Ok(())),
        ("S-9", Ok(())),
    ] {
        assert_eq!(serials.scan(text, &ledger), answer, "{text}");
    }
    assert_eq!(serials.unscan(), Ok(()));
    assert!(serials.may_release());
    let parts = [(); 3].map(|()| feed(&mut serials, &mut ledger, &[]));
    let numbers = parts.each_ref().map(|it| it.serial.as_deref());
    assert_eq!(numbers, [Some("S-1"), Some("S-2"), None]);
    assert_eq!(fault(&parts[2]), Some(SerialFault::Missing));
    assert_eq!(reader().scan("S-3", &ledger), Err(ScanRefused::NotScanned));
}

#[test]
fn a_part_that_lay_in_the_pocket_takes_no_scan() {
    let (mut serials, ledger) = (
        Serials::new(Source::Wedge, BTreeSet::new()),
        Ledger::default(),
    );
    assert_eq!(serials.scan("S-1", &ledger), Ok(()));
    let waiting = |serials: &Serials| serials.waiting().unwrap().count();
    serials.arrived(RigTime(0), true);
    assert_eq!(waiting(&serials), 1, "no part was released");
    serials.released();
    serials.arrived(RigTime(1), false);
    assert_eq!(waiting(&serials), 1, "a reference part was released");
    serials.released();
    serials.arrived(RigTime(2), true);
    assert_eq!(waiting(&serials), 0);
}

#[test]
fn a_serial_number_is_printable_ascii() {
    assert_eq!(readable(" A 1\r"), Some("A 1"));
    let long = "x".repeat(65);
    for wrong in ["", " ", "é", "a\tb", &long] {
        assert_eq!(readable(wrong), None, "{wrong:?}");
    }
}
