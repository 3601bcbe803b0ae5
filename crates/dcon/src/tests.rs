//! Tests of the protocol as tables: bytes of each command, meaning of its reply, and replies that must be refused.

#![allow(clippy::unwrap_used)]

use super::*;
use proptest::prelude::*;
use rows::table;

mod module_rows;
mod rows;
mod values;
mod vectors;

const A1: Address = Address(1);
const VOLTS: InputForm = InputForm::eight(DataFormat::Engineering, TypeCode(0x08));
const PERCENT: InputForm = InputForm::eight(DataFormat::Percent, TypeCode(0x08));
const HEX: InputForm = InputForm::eight(DataFormat::Hex, TypeCode(0x08));
const PT100: InputForm = InputForm::three(DataFormat::Engineering, TypeCode(0x20));

fn ch(n: u8) -> Channel {
    UpTo::new(n).unwrap()
}

fn n(n: u8) -> UpTo<1> {
    UpTo::new(n).unwrap()
}

fn level(form: OutputForm, steps: i32) -> Level {
    Level::from_steps(form, steps).unwrap()
}

fn config(type_code: u8, baud: u8, format: u8) -> Config {
    Config {
        type_code: TypeCode(type_code),
        baud: BaudCode(baud),
        format: FormatByte(format),
    }
}

fn word(width: Width, bits: u16) -> Digital {
    Digital::Write(OutputWord::new(width, bits).unwrap())
}

/// Commands that return readings, with replies, which the tests below damage.
const READINGS: [(Command, &str); 7] = [
    (
        Command::AnalogIn(A1, AnalogIn::ReadAll(VOLTS)),
        ">+05.123+04.153+07.234-02.356+10.000-05.133+02.345+08.234",
    ),
    (
        Command::AnalogIn(A1, AnalogIn::ReadAll(VOLTS)),
        ">+05.123       +07.234-02.356+10.000-05.133+02.345+08.234",
    ),
    (
        Command::AnalogIn(A1, AnalogIn::ReadAll(PERCENT)),
        ">+051.23-100.00+100.00+000.00+999.99-999.99+001.00-001.00",
    ),
    (
        Command::AnalogIn(A1, AnalogIn::ReadAll(HEX)),
        ">0000012301257FFF1802744F98238124",
    ),
    (
        Command::AnalogIn(A1, AnalogIn::ReadAllHex(VOLTS)),
        ">00000123012580001802    98238124",
    ),
    (
        Command::AnalogIn(A1, AnalogIn::ReadAll(PT100)),
        ">+025.37-010.00+099.99",
    ),
    (
        Command::AnalogIn(A1, AnalogIn::ReadColdJunction),
        ">+0025.8",
    ),
];

fn sealed(text: &str, with_checksum: bool) -> Vec<u8> {
    let sum = if with_checksum {
        format!("{:02X}", checksum(text.as_bytes()))
    } else {
        String::new()
    };
    format!("{text}{sum}\r").into_bytes()
}

fn all_frames() -> Vec<(Command, &'static str)> {
    table()
        .into_iter()
        .map(|(command, _, reply, _)| (command, reply))
        .chain(READINGS)
        .collect()
}

fn read_one(form: InputForm, text: &str) -> Result<Value, ReplyError> {
    let command = AnalogIn::ReadOne {
        channel: ch(2),
        form,
    }
    .to(Address(3));
    match command.decode(&sealed(text, false), false)? {
        Reply::Reading(reading) => {
            assert_eq!(reading.text(), &text[1..]);
            Ok(reading.value)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_command_and_reply_matches_the_table() {
    for (command, request, reply, meaning) in table() {
        for with_checksum in [false, true] {
            let mut out = Vec::new();
            command.encode(with_checksum, &mut out);
            assert_eq!(out, sealed(request, with_checksum), "{command}");
            assert_eq!(
                command.decode(&sealed(reply, with_checksum), with_checksum),
                Ok(meaning),
                "{command}"
            );
            assert!(reply.len() < command.longest_reply(), "{command}");
            assert!(out.len() <= 21, "{command}");
        }
    }
}

#[test]
fn the_checksum_sums_all_characters_from_the_lead() {
    for (text, sum) in [
        ("$012", 0xB7),
        ("!01200600", 0xAA),
        ("!07+2.0500", 0xD8),
        ("~**", 0xD2),
        ("#**", 0x77),
        (">", 0x3E),
    ] {
        assert_eq!(checksum(text.as_bytes()), sum, "{text}");
    }
}

#[test]
fn a_truncated_reply_is_refused() {
    for (command, reply) in all_frames() {
        for with_checksum in [false, true] {
            let whole = sealed(reply, with_checksum);
            // The CR may be missing only where the length or the checksum proves the reply complete.
            for length in 0..whole.len() - 1 {
                let outcome = command.decode(&whole[..length], with_checksum);
                assert!(
                    outcome.is_err(),
                    "{command} {reply} cut to {length}: {outcome:?}"
                );
            }
        }
    }
}

#[test]
fn the_checksum_catches_every_flipped_bit() {
    for (command, reply) in all_frames() {
        let whole = sealed(reply, true);
        for (at, bit) in (0..whole.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
            let mut damaged = whole.clone();
            damaged[at] ^= 1 << bit;
            let outcome = command.decode(&damaged, true);
            assert!(
                outcome.is_err(),
                "{command} {reply} bit {bit} of {at}: {outcome:?}"
            );
        }
    }
}

#[test]
fn a_refusal_counts_only_from_the_addressed_module() {
    let read = AnalogIn::ReadOne {
        channel: ch(9),
        form: VOLTS,
    }
    .to(Address(2));
    assert_eq!(read.decode(b"?02\r", false), Err(ReplyError::Refused));
    let stranger = ReplyError::WrongAddress {
        found: Address(3),
        expected: Address(2),
    };
    assert_eq!(read.decode(b"?03\r", false), Err(stranger));
    assert_eq!(
        read.decode(b"?\r", false),
        Err(ReplyError::WrongLength { found: 1 })
    );
}

#[test]
fn output_commands_accept_bare_refusal_and_tripped_watchdog() {
    let write = word(Width::One, 3).to(A1);
    assert_eq!(write.decode(b"?\r", false), Err(ReplyError::Refused));
    assert_eq!(write.decode(b"?01A0\r", true), Err(ReplyError::Refused));
    assert_eq!(write.decode(b"!21\r", true), Err(ReplyError::Ignored));
    assert_eq!(
        Digital::ReadAll.to(A1).decode(b"!\r", false),
        Err(ReplyError::WrongLength { found: 1 })
    );
}

#[test]
fn replies_of_another_kind_or_module_are_refused() {
    let count = Counter::Read(n(0)).to(A1);
    assert_eq!(
        count.decode(b">0F00\r", false),
        Err(ReplyError::WrongLength { found: 5 })
    );
    assert_eq!(
        count.decode(b"!011\r", false),
        Err(ReplyError::WrongLead {
            found: b'!',
            expected: b'>'
        })
    );
    let status = Common::ReadResetStatus.to(A1);
    assert_eq!(
        status.decode(b"!021\r", false),
        Err(ReplyError::WrongAddress {
            found: Address(2),
            expected: A1
        })
    );
    assert_eq!(
        Digital::ReadAll.to(A1).decode(b"!010A0B\r", false),
        Err(ReplyError::BadField {
            at: 5,
            expected: "00"
        })
    );
}

#[test]
fn broadcasts_are_sent_and_never_answered() {
    let mut out = Vec::new();
    Command::HostOk.encode(true, &mut out);
    Command::SampleAll.encode(true, &mut out);
    assert_eq!(out, b"~**D2\r#**77\r");
    assert!(!Command::HostOk.has_reply() && Command::HostOk.longest_reply() == 0);
    assert_eq!(
        Command::HostOk.decode(b"!01\r", false),
        Err(ReplyError::Broadcast)
    );
}

#[test]
fn only_commands_without_effect_may_be_repeated() {
    for command in [
        Digital::ReadAll.to(A1),
        AnalogIn::ReadAll(HEX).to(A1),
        Counter::Read(n(0)).to(A1),
    ] {
        assert!(
            command.repeatable() && !command.writes_eeprom(),
            "{command}"
        );
    }
    let write = AnalogOut::Write {
        channel: None,
        level: level(OutputForm::Hex16, 0),
    };
    for command in [
        write.to(A1),
        word(Width::One, 0).to(A1),
        Common::ReadResetStatus.to(A1),
        Digital::ReadSampled.to(A1),
    ] {
        assert!(
            !command.repeatable() && !command.writes_eeprom(),
            "{command}"
        );
    }
    for command in [
        Common::WriteWatchdog {
            enabled: true,
            timeout_tenths: 1,
        }
        .to(A1),
        Digital::Store(Stored::Safe).to(A1),
    ] {
        assert!(
            command.writes_eeprom() && !command.repeatable(),
            "{command}"
        );
    }
}

proptest! {
    #[test]
    fn no_bytes_make_a_command_panic(frame in proptest::collection::vec(any::<u8>(), 0..80), sum: bool) {
        for (command, _) in all_frames() {
            let _ = command.decode(&frame, sum);
        }
    }

    #[test]
    fn every_accepted_value_has_valid_characters(frame in "[!>?][0-9A-F +.-]{0,12}\r") {
        for (command, _, reply, _) in table() {
            if command.decode(frame.as_bytes(), false).is_ok() {
                prop_assert_eq!(frame.as_bytes()[0], reply.as_bytes()[0]);
                prop_assert!(frame.len() <= command.longest_reply());
            }
        }
    }
}
