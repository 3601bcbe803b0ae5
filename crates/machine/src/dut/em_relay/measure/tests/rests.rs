//! Conclusions before the armature moves: pins, resting contacts, NC resistance, coil; and those of the stage `off`.

use super::super::{coil, contact, kelvin};
use super::{PULLED, RESTING, assert_ends, at_23_c, context, drop_of, ended, good, scan};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::bins;
use crate::dut::em_relay::contact::ContactDrop;
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::measure::TestState;
use crate::dut::em_relay::readings::{BoardInputs, CoilScan, Readings};
use crate::dut::em_relay::recipe::CoilChannels;
use crate::dut::em_relay::sampling::Polarities;
use crate::dut::verdict::Bin;
use crate::rig::sample::{Quality, Sample};
use std::sync::Arc;
use units::{Celsius, Volt};

fn kelvin_of(boards: Vec<BoardInputs>) -> TestState {
    let readings = Readings {
        boards,
        ..Readings::default()
    };
    let mut state = TestState::new(&context());
    assert_eq!(kelvin::conclude(&readings, &mut state), None);
    state
}

fn pins(open: &[usize]) -> BoardInputs {
    let mut board = RESTING;
    for pin in open {
        board.kelvin[*pin] = false;
    }
    board
}

#[test]
fn the_pin_map_separates_missing_misoriented_and_stuck() {
    let welded = BoardInputs {
        nc_closed: true,
        ..PULLED
    };
    let nc_open = BoardInputs {
        nc_closed: false,
        ..RESTING
    };
    let cases: [(BoardInputs, Bin, &str); 11] = [
        (pins(&[0]), Bin::RETEST, "coil A"),
        (pins(&[1]), Bin::RETEST, "coil B"),
        (pins(&[2]), Bin::RETEST, "turned"),
        (pins(&[3]), Bin::RETEST, "NO"),
        (pins(&[4]), Bin::RETEST, "NC"),
        (pins(&[0, 1]), Bin::RETEST, "coil A, coil B"),
        (pins(&[2, 4]), Bin::RETEST, "COM, NC"),
        (pins(&[0, 1, 2, 3, 4]), Bin::RETEST, "coil A"),
        (PULLED, bins::CONTACT, "NO closed at rest"),
        (welded, bins::CONTACT, "NO closed at rest"),
        (nc_open, bins::CONTACT, "NC open at rest"),
    ];
    for (board, bin, word) in cases {
        let state = kelvin_of(vec![board]);
        assert_ends(&state, bin, word);
    }
    assert_eq!(ended(&kelvin_of(vec![RESTING])), None);
}

#[test]
fn unknown_temperature_or_unread_pins_void_the_part() {
    let over = drop_of(Quality::OverRange, 0.0);
    let drops = || [drop_of(Quality::Good, -1.1)];
    for (track, known) in [
        (vec![], None),
        (vec![over], None),
        (vec![good(23.4, 1.0)], Some(Celsius(23.4))),
    ] {
        let readings = Readings {
            boards: vec![RESTING],
            drops: drops().to_vec(),
            track,
            ..Readings::default()
        };
        let mut state = TestState::new(&context());
        contact::conclude_nc(&context(), &readings, &mut state);
        assert_eq!(state.record.own.track, known);
        match known {
            Some(_) => assert_eq!(ended(&state), None),
            None => assert_ends(&state, Bin::RETEST, "temperature"),
        }
    }
    let state = kelvin_of(Vec::new());
    assert_ends(&state, Bin::RETEST, "board not read");
}

fn both_directions() -> Context {
    let mut context = context();
    let strategy = &mut Arc::make_mut(&mut context.relay).test.strategy;
    strategy.contact.polarities = Polarities::PlusMinus;
    context
}

fn nc_of(forward: Sample, reverse: Option<Sample>, compliance: bool) -> TestState {
    let board = BoardInputs {
        compliance,
        ..RESTING
    };
    let readings = Readings {
        boards: vec![board],
        drops: [Some(forward), reverse].into_iter().flatten().collect(),
        track: vec![good(23.0, 1.0)],
        ..Readings::default()
    };
    let mut state = at_23_c();
    contact::conclude_nc(&both_directions(), &readings, &mut state);
    state
}

#[test]
fn both_polarities_give_contact_resistance_and_zero() {
    let zero = 0.015;
    let forward = drop_of(Quality::Good, 1.1 + zero);
    let reverse = drop_of(Quality::Good, -1.1 + zero);
    let state = nc_of(forward, Some(reverse), false);
    assert_eq!(ended(&state), None);
    let nc = state.record.result(Parameter::ContactResistanceNc).unwrap();
    assert!((nc.value - 22.0).abs() < 1e-9);
    let read = state.plan.zero.unwrap();
    let forward = ContactDrop::single(Volt(1.1 + zero), false, 0.003);
    assert!((forward.without(read).0 - 1.1).abs() < 1e-12);
    assert_eq!(
        state
            .record
            .evidence(Parameter::ContactResistanceNc)
            .count(),
        2
    );
}

#[test]
fn compliance_explains_an_over_range_drop() {
    let fine = || drop_of(Quality::Good, -1.1);
    let of = |quality| drop_of(quality, 0.0);
    let cases = [
        (
            of(Quality::OverRange),
            fine(),
            false,
            bins::CONTACT,
            "over range",
        ),
        (of(Quality::OverRange), fine(), true, bins::CONTACT, "open"),
        (
            fine(),
            of(Quality::UnderRange),
            false,
            bins::CONTACT,
            "over range",
        ),
        (fine(), of(Quality::UnderRange), true, bins::CONTACT, "open"),
        (
            of(Quality::Blank),
            fine(),
            true,
            Bin::RETEST,
            "not readable",
        ),
        (
            fine(),
            of(Quality::Blank),
            false,
            Bin::RETEST,
            "not readable",
        ),
    ];
    for (forward, reverse, compliance, bin, word) in cases {
        let state = nc_of(forward, Some(reverse), compliance);
        assert_ends(&state, bin, word);
        assert_ends(&state, bin, "NC contact");
        assert_eq!(state.record.attempts(Parameter::ContactResistanceNc), 0);
    }
    let half = nc_of(fine(), None, false);
    assert_ends(&half, Bin::RETEST, "not readable");
}

fn coil_of(scans: Vec<CoilScan>, celsius: f64) -> TestState {
    let readings = Readings {
        coil: scans,
        ..Readings::default()
    };
    let mut state = at_23_c();
    state.record.own.track = Some(Celsius(celsius));
    coil::conclude(&context(), &readings, &mut state);
    state
}

fn with(quality: Quality, of: fn(&mut CoilScan) -> &mut Option<Sample>) -> CoilScan {
    let mut scan = scan(5.0, 0.0125);
    *of(&mut scan) = Some(drop_of(quality, 0.0));
    scan
}

#[test]
fn a_coil_is_reported_at_the_reference_temperature() {
    let state = coil_of(vec![scan(5.0, 0.0125)], 23.0);
    let coil = state.record.result(Parameter::CoilResistance).unwrap();
    assert!((coil.value - 400.0).abs() < 1e-9 && coil.expanded() < 1.0);
    let warm = coil_of(vec![scan(5.0, 0.0125)], 28.0);
    let coil = warm.record.result(Parameter::CoilResistance).unwrap();
    assert!((coil.value - 400.0 * 257.5 / 262.5).abs() < 1e-9);
}

#[test]
fn open_shorted_and_unreadable_coils_differ_in_finding() {
    let over = with(Quality::OverRange, |scan| &mut scan.current_fine);
    let volts_over = with(Quality::OverRange, |scan| &mut scan.voltage_fine);
    let volts_blank = with(Quality::Blank, |scan| &mut scan.voltage_fine);
    let masked = CoilScan {
        current_fine: None,
        ..scan(5.0, 0.0125)
    };
    let cases = [
        (scan(5.0, 0.0), bins::COIL, "coil open"),
        (scan(5.0, 0.0002), bins::COIL, "coil open"),
        (scan(5.0, -0.0002), bins::COIL, "coil open"),
        (over, bins::COIL, "over range"),
        (volts_over, Bin::RETEST, "not readable"),
        (volts_blank, Bin::RETEST, "not readable"),
        (masked, Bin::RETEST, "no voltage or current"),
    ];
    for (scan, bin, word) in cases {
        let state = coil_of(vec![scan], 23.0);
        assert_ends(&state, bin, word);
        assert_eq!(state.record.attempts(Parameter::CoilResistance), 0);
    }
}

#[test]
fn a_low_coil_resistance_needs_the_wide_channel() {
    let mut context = context();
    Arc::make_mut(&mut context.relay).test.coil_channels = CoilChannels::CoarseCurrent;
    let scan = CoilScan {
        current_wide: Some(good(0.03, 200.0)),
        current_fine: None,
        ..scan(3.0, 0.0)
    };
    let readings = Readings {
        coil: vec![scan],
        ..Readings::default()
    };
    let mut state = at_23_c();
    coil::conclude(&context, &readings, &mut state);
    let coil = state.record.result(Parameter::CoilResistance).unwrap();
    assert!((coil.value - 100.0).abs() < 1e-9);
}

#[test]
fn a_test_is_void_while_coil_current_remains() {
    let of = |scan: CoilScan| scan.current_fine;
    let cases = [
        (of(scan(0.0, 0.0005)), false),
        (of(scan(0.0, -0.0005)), false),
        (of(scan(0.0, 0.0011)), true),
        (
            of(with(Quality::Blank, |scan| &mut scan.current_fine)),
            true,
        ),
        (
            of(with(Quality::OverRange, |scan| &mut scan.current_fine)),
            true,
        ),
        (None, true),
    ];
    for (current, void) in cases {
        let readings = Readings {
            currents: current.into_iter().collect(),
            ..Readings::default()
        };
        let mut state = at_23_c();
        coil::conclude_off(&readings, &mut state);
        let bin = ended(&state).map(|(bin, _)| bin);
        assert_eq!(bin, void.then_some(Bin::RETEST));
    }
}
