//! The protocol as tables: what a command puts on the wire, what its reply means, and what is refused.

#![allow(clippy::unwrap_used)]

use super::*;
use proptest::prelude::*;

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

fn bits(first: u8, second: u8) -> Reply {
    Reply::Bits(Bits { first, second })
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

/// Command, request without checksum, reply without checksum, meaning.
fn table() -> Vec<(Command, &'static str, &'static str, Reply)> {
    let mut rows = common_rows();
    rows.extend(analog_rows());
    rows.extend(digital_rows());
    rows.extend(counter_rows());
    rows
}

fn common_rows() -> Vec<(Command, &'static str, &'static str, Reply)> {
    let done = Reply::Accepted;
    let set = Common::WriteConfig {
        address: Address(2),
        config: config(0x30, 6, 0),
    };
    let watchdog = |enabled| Reply::Watchdog {
        enabled,
        timeout_tenths: 100,
    };
    let text = |text: &str| Reply::Text(reply::Text::new(text.as_bytes()).unwrap());
    vec![
        (
            Common::ReadConfig.to(A1),
            "$012",
            "!01500600",
            Reply::Config {
                address: A1,
                config: config(0x50, 6, 0),
            },
        ),
        (
            Common::ReadConfig.to(Address(0)),
            "$002",
            "!04080700",
            Reply::Config {
                address: Address(4),
                config: config(8, 7, 0),
            },
        ),
        (set.to(A1), "%0102300600", "!02", done),
        (
            Common::ReadResetStatus.to(A1),
            "$015",
            "!011",
            Reply::Flag(true),
        ),
        (Common::ReadFirmware.to(A1), "$01F", "!01A2.0", text("A2.0")),
        (Common::ReadName.to(A1), "$01M", "!017017R", text("7017R")),
        (
            Common::WriteName(ModuleName::new("7080X").unwrap()).to(A1),
            "~01O7080X",
            "!01",
            done,
        ),
        (
            Common::ReadInitPin.to(Address(2)),
            "$02I",
            "!021",
            Reply::Flag(true),
        ),
        (
            Common::ReadWatchdogStatus.to(Address(2)),
            "~020",
            "!0204",
            Reply::Byte(4),
        ),
        (Common::ClearWatchdogStatus.to(A1), "~011", "!01", done),
        (
            Common::ReadWatchdog.to(A1),
            "~012",
            "!01164",
            watchdog(Some(true)),
        ),
        (Common::ReadWatchdog.to(A1), "~012", "!0164", watchdog(None)),
        (
            Common::WriteWatchdog {
                enabled: true,
                timeout_tenths: 100,
            }
            .to(A1),
            "~013164",
            "!01",
            done,
        ),
        (
            Common::ReadResponseDelay.to(A1),
            "~01RD",
            "!010A",
            Reply::Byte(10),
        ),
        (
            Common::WriteResponseDelay {
                delay_ms: UpTo::new(30).unwrap(),
            }
            .to(Address(3)),
            "~03RD1E",
            "!03",
            done,
        ),
        (Common::EnterSoftInit.to(A1), "~01I", "!01", done),
        (
            Common::OpenSoftInit {
                seconds: UpTo::new(16).unwrap(),
            }
            .to(A1),
            "~01T10",
            "!01",
            done,
        ),
    ]
}

fn analog_rows() -> Vec<(Command, &'static str, &'static str, Reply)> {
    let done = Reply::Accepted;
    let slew = SlewCode(ch(1));
    let volts = |steps| level(OutputForm::Engineering, steps);
    let signed = |steps| level(OutputForm::EngineeringSigned, steps);
    let to_channel = |n, level| {
        AnalogOut::Write {
            channel: Some(ch(n)),
            level,
        }
        .to(A1)
    };
    let write = |level| {
        AnalogOut::Write {
            channel: None,
            level,
        }
        .to(A1)
    };
    let hex16 = level(OutputForm::Hex16, 0xABCD);
    let range = UpTo::new(2).unwrap();
    vec![
        (
            AnalogIn::ReadMask.to(A1),
            "$016",
            "!015A",
            Reply::Byte(0x5A),
        ),
        (AnalogIn::WriteMask(0xA5).to(A1), "$015A5", "!01", done),
        (write(volts(5_000)), "#0105.000", ">", done),
        (write(hex16), "#01ABCD", ">", done),
        (write(level(OutputForm::Hex12, 0xABC)), "#01ABC", ">", done),
        (
            write(level(OutputForm::Percent, 5_000)),
            "#01+050.00",
            ">",
            done,
        ),
        (to_channel(0, signed(-5_000)), "#010-05.000", ">", done),
        (
            AnalogOut::ReadLast {
                channel: None,
                form: OutputForm::Engineering,
            }
            .to(A1),
            "$016",
            "!0110.000",
            Reply::Level(volts(10_000)),
        ),
        (
            AnalogOut::ReadLast {
                channel: Some(ch(0)),
                form: OutputForm::EngineeringSigned,
            }
            .to(A1),
            "$0160",
            "!01+10.000",
            Reply::Level(signed(10_000)),
        ),
        (
            AnalogOut::ReadPresent {
                channel: None,
                form: OutputForm::Hex16,
            }
            .to(A1),
            "$018",
            "!01ABCD",
            Reply::Level(hex16),
        ),
        (
            AnalogOut::StorePowerOn { channel: None }.to(A1),
            "$014",
            "!01",
            done,
        ),
        (
            AnalogOut::StoreSafe { channel: None }.to(A1),
            "~015",
            "!01",
            done,
        ),
        (
            AnalogOut::ReadSafe {
                channel: None,
                form: OutputForm::Engineering,
            }
            .to(A1),
            "~014",
            "!0100.000",
            Reply::Level(volts(0)),
        ),
        (
            AnalogOut::ReadPowerOn {
                channel: Some(ch(3)),
                form: OutputForm::EngineeringSigned,
            }
            .to(A1),
            "$0173",
            "!01-01.500",
            Reply::Level(signed(-1_500)),
        ),
        (
            AnalogOut::WriteChannelConfig {
                channel: ch(1),
                range,
                slew,
            }
            .to(A1),
            "$019121",
            "!01",
            done,
        ),
        (
            AnalogOut::ReadChannelConfig { channel: ch(0) }.to(A1),
            "$0190",
            "!0121",
            Reply::OutputChannel {
                range: TypeCode(0x32),
                slew,
            },
        ),
    ]
}

fn digital_rows() -> Vec<(Command, &'static str, &'static str, Reply)> {
    let done = Reply::Accepted;
    let third = GroupWrite::OneOfA {
        output: UpTo::new(2).unwrap(),
        on: false,
    };
    let sampled = Reply::Sampled {
        first_read: true,
        bits: Bits {
            first: 0,
            second: 0x0F,
        },
    };
    let latched = Digital::ReadLatched { high: true }.to(A1);
    vec![
        (
            Digital::ReadAll.to(Address(3)),
            "$036",
            "!BEDE00",
            bits(0xBE, 0xDE),
        ),
        (Digital::ReadPort.to(A1), "@01", ">0F00", bits(0x0F, 0)),
        (word(Width::One, 0xF).to(A1), "@01F", ">", done),
        (word(Width::Two, 0x7F).to(Address(4)), "@047F", ">", done),
        (word(Width::Four, 0x1234).to(A1), "@011234", ">", done),
        (
            Digital::WriteGroup(GroupWrite::GroupA(0xFF)).to(A1),
            "#0100FF",
            ">",
            done,
        ),
        (
            Digital::WriteGroup(GroupWrite::GroupB(0x80)).to(A1),
            "#010B80",
            ">",
            done,
        ),
        (Digital::WriteGroup(third).to(A1), "#011200", ">", done),
        (
            Digital::ReadEvents { channel: ch(2) }.to(Address(3)),
            "#032",
            "!0300103",
            Reply::Events(103),
        ),
        (
            Digital::ClearEvents { channel: ch(0) }.to(A1),
            "$01C0",
            "!01",
            done,
        ),
        (latched, "$01L1", "!012300", bits(1, 0x23)),
        (latched, "$01L1", "!01FFFF00", bits(0xFF, 0xFF)),
        (Digital::ClearLatched.to(A1), "$01C", "!01", done),
        (Digital::ReadSampled.to(A1), "$014", "!1000F00", sampled),
        (
            Digital::ReadStored(Stored::PowerOn).to(A1),
            "~014P",
            "!01AA00",
            bits(0xAA, 0),
        ),
        (Digital::Store(Stored::Safe).to(A1), "~015S", "!01", done),
    ]
}

fn counter_rows() -> Vec<(Command, &'static str, &'static str, Reply)> {
    let done = Reply::Accepted;
    let five = |value| Reply::Decimal(value);
    vec![
        (
            Counter::Read(n(0)).to(A1),
            "#010",
            ">0000001E",
            Reply::Count(30),
        ),
        (
            Counter::Read(n(1)).to(A1),
            "#011",
            ">FFFFFFFF",
            Reply::Count(u32::MAX),
        ),
        (Counter::Reset(n(1)).to(A1), "$0161", "!01", done),
        (
            Counter::ReadOverflow(n(0)).to(A1),
            "$0170",
            "!011",
            Reply::Flag(true),
        ),
        (
            Counter::ReadRunning(n(1)).to(A1),
            "$0151",
            "!010",
            Reply::Flag(false),
        ),
        (Counter::Run(n(1), true).to(A1), "$01511", "!01", done),
        (
            Counter::ReadPreset(n(0)).to(A1),
            "@01G0",
            "!010000FFFF",
            Reply::Count(0xFFFF),
        ),
        (
            Counter::WritePreset(n(0), 0xFFFF).to(A1),
            "@01P00000FFFF",
            "!01",
            done,
        ),
        (
            Counter::ReadMaximum(n(1)).to(A1),
            "$0131",
            "!01FFFFFFFF",
            Reply::Count(u32::MAX),
        ),
        (
            Counter::WriteMaximum(n(1), u32::MAX).to(A1),
            "$0131FFFFFFFF",
            "!01",
            done,
        ),
        (
            Counter::ReadGate.to(A1),
            "$01A",
            "!011",
            Reply::Gate(GateMode::High),
        ),
        (
            Counter::WriteGate(GateMode::None).to(Address(3)),
            "$03A2",
            "!03",
            done,
        ),
        (
            Counter::ReadInputs.to(Address(3)),
            "$03B",
            "!032",
            Reply::Inputs(InputMode::Isolated1),
        ),
        (
            Counter::WriteInputs(InputMode::BothIsolated).to(A1),
            "$01B1",
            "!01",
            done,
        ),
        (
            Counter::ReadFilter.to(A1),
            "$014",
            "!010",
            Reply::Flag(false),
        ),
        (Counter::WriteFilter(true).to(A1), "$0141", "!01", done),
        (
            Counter::ReadFilterWidth(Edge::Low).to(Address(5)),
            "$050L",
            "!0500084",
            five(84),
        ),
        (
            Counter::WriteFilterWidth(Edge::Low, 84).to(Address(5)),
            "$050L00084",
            "!05",
            done,
        ),
        (
            Counter::ReadThreshold(Edge::Low).to(Address(2)),
            "$021L",
            "!0210",
            five(10),
        ),
        (
            Counter::WriteThreshold(Edge::Low, UpTo::new(8).unwrap()).to(A1),
            "$011L08",
            "!01",
            done,
        ),
        (
            Counter::ReadAlarm.to(A1),
            "@01DI",
            "!0110300",
            Reply::Alarm(AlarmState {
                state: 1,
                outputs: 3,
            }),
        ),
        (
            Counter::WriteOutputs(UpTo::new(1).unwrap()).to(Address(2)),
            "@02DO01",
            "!02",
            done,
        ),
        (Counter::ReadDisplay.to(Address(3)), "$038", "!032", five(2)),
    ]
}

/// Commands whose readings are looked at below; here for the damage tests.
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
fn every_command_goes_out_and_comes_back_as_the_table_says() {
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
fn the_checksum_is_the_sum_of_all_characters_from_the_lead() {
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
fn a_reply_cut_off_anywhere_is_no_reply() {
    for (command, reply) in all_frames() {
        for with_checksum in [false, true] {
            let whole = sealed(reply, with_checksum);
            // The CR alone may be missing where the length or the checksum proves the rest.
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
fn with_a_checksum_no_flipped_bit_passes_for_a_value() {
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
fn a_refusal_counts_only_from_the_module_that_was_asked() {
    let read = AnalogIn::ReadOne {
        channel: ch(9),
        form: VOLTS,
    }
    .to(Address(2));
    assert_eq!(read.decode(b"?02\r", false), Err(ReplyError::Refused));
    let stranger = ReplyError::WrongAddress {
        found: Address(3),
        asked: Address(2),
    };
    assert_eq!(read.decode(b"?03\r", false), Err(stranger));
    assert_eq!(
        read.decode(b"?\r", false),
        Err(ReplyError::WrongLength { found: 1 })
    );
}

#[test]
fn output_commands_know_the_bare_refusal_and_the_tripped_watchdog() {
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
fn a_neighbours_answer_of_another_kind_is_refused_by_lead_length_or_address() {
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
            asked: A1
        })
    );
    assert_eq!(
        Digital::ReadAll.to(A1).decode(b"!010A0B\r", false),
        Err(ReplyError::BadField {
            at: 5,
            expected: "filler 00"
        })
    );
}

#[test]
fn readings_are_numbers_in_the_terms_of_their_notation() {
    for (form, text, value, volts) in [
        (VOLTS, ">+02.513", Value::Engineering(2.513), Some(2.513)),
        (VOLTS, ">-10.000", Value::Engineering(-10.0), Some(-10.0)),
        (PERCENT, ">+050.00", Value::Percent(50.0), Some(5.0)),
        (HEX, ">4000", Value::Hex(0x4000), Some(5.0)),
        (HEX, ">C000", Value::Hex(-0x4000), Some(-5.0)),
        (VOLTS, ">       ", Value::Blank, None),
        (HEX, ">    ", Value::Blank, None),
    ] {
        assert_eq!(read_one(form, text), Ok(value), "{text}");
        assert_eq!(value.in_units(form.range), volts, "{text}");
    }
}

#[test]
fn a_reading_at_the_rail_is_no_number() {
    for (form, text, value) in [
        (VOLTS, ">+9999.9", Value::OverRange),
        (VOLTS, ">9999.9", Value::OverRange),
        (VOLTS, ">-9999.9", Value::UnderRange),
        (PERCENT, ">+999.99", Value::OverRange),
        (PERCENT, ">-999.99", Value::UnderRange),
        (HEX, ">7FFF", Value::OverRange),
        (HEX, ">8000", Value::UnderRange),
    ] {
        assert_eq!(read_one(form, text), Ok(value), "{text}");
        assert_eq!(value.in_units(form.range), None, "{text}");
    }
}

#[test]
fn a_reading_beyond_what_the_range_can_say_is_refused() {
    for (form, text) in [
        (VOLTS, ">+99.000"),
        (VOLTS, ">+2.5.13"),
        (VOLTS, ">+025131"),
        (VOLTS, "> 02.513"),
        (PERCENT, ">+500.00"),
        (PERCENT, ">+50.000"),
        (HEX, ">4c53"),
        (HEX, ">4C 3"),
    ] {
        assert!(read_one(form, text).is_err(), "{text}");
    }
}

#[test]
fn all_channels_come_in_order_and_disabled_ones_stay_blank() {
    let (command, reply) = READINGS[1];
    let Ok(Reply::Readings(all)) = command.decode(&sealed(reply, true), true) else {
        panic!("{reply}")
    };
    assert_eq!(all.get(0).unwrap().value, Value::Engineering(5.123));
    assert_eq!(all.get(1).unwrap().value, Value::Blank);
    assert_eq!(all.get(7).unwrap().text(), "+08.234");
    assert_eq!(all.iter().count(), 8);
    let Ok(Reply::Readings(three)) = READINGS[5].0.decode(&sealed(READINGS[5].1, true), true)
    else {
        panic!()
    };
    assert_eq!(
        three.get(2).unwrap().value.in_units(TypeCode(0x20)),
        Some(99.99)
    );
    assert_eq!(three.get(3), None);
}

#[test]
fn broadcasts_are_sent_and_never_answered() {
    let mut out = Vec::new();
    Command::HostOk.encode(true, &mut out);
    Command::SampleAll.encode(true, &mut out);
    assert_eq!(out, b"~**D2\r#**77\r");
    assert!(!Command::HostOk.answered() && Command::HostOk.longest_reply() == 0);
    assert_eq!(
        Command::HostOk.decode(b"!01\r", false),
        Err(ReplyError::NotAsked)
    );
}

#[test]
fn only_what_changes_nothing_may_be_repeated() {
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

#[test]
fn a_level_that_the_output_cannot_reach_is_refused_before_it_is_sent() {
    let volts = TypeCode(0x32);
    assert_eq!(
        Level::nearest(OutputForm::Hex16, volts, 10.0)
            .unwrap()
            .steps(),
        0xFFFF
    );
    assert_eq!(
        Level::nearest(OutputForm::Hex12, volts, 5.0)
            .unwrap()
            .steps(),
        0x800
    );
    assert_eq!(
        Level::nearest(OutputForm::Engineering, volts, 5.0004)
            .unwrap()
            .steps(),
        5000
    );
    assert_eq!(
        Level::nearest(OutputForm::Percent, TypeCode(0x31), 4.0)
            .unwrap()
            .steps(),
        0
    );
    let outside = LevelError::OutOfRange {
        value: 10.1,
        low: 0.0,
        high: 10.0,
    };
    assert_eq!(Level::nearest(OutputForm::Hex16, volts, 10.1), Err(outside));
    assert!(Level::nearest(OutputForm::Hex16, volts, f64::NAN).is_err());
    assert!(Level::nearest(OutputForm::Hex16, TypeCode(0x40), 1.0).is_err());
    for volts_wanted in [0.0, 0.3, 7.777, 10.0] {
        let level = Level::nearest(OutputForm::Hex16, volts, volts_wanted).unwrap();
        assert!(
            (level.in_units(volts).unwrap() - volts_wanted).abs() <= 10.0 / 65535.0 / 2.0 + 1e-12
        );
    }
}

#[test]
fn the_configuration_word_tells_baud_filter_and_slew() {
    let config = config(0x32, 0x0A, 0x54);
    assert_eq!(config.baud.rate(), Some(115_200));
    assert_eq!(BaudCode::of(9_600), Some(BaudCode(6)));
    assert!(config.format.checksum());
    assert_eq!(config.format.slew().volt_per_second(), Some(1.0));
    assert_eq!(FormatByte(0x2E).slew().volt_per_second(), Some(64.0));
    assert!(FormatByte(0x22).fast() && FormatByte(0x22).data_format() == Some(DataFormat::Hex));
    assert_eq!(SlewCode::IMMEDIATE.volt_per_second(), None);
}

proptest! {
    #[test]
    fn no_bytes_make_a_command_panic(frame in proptest::collection::vec(any::<u8>(), 0..80), sum: bool) {
        for (command, _) in all_frames() {
            let _ = command.decode(&frame, sum);
        }
    }

    #[test]
    fn a_value_taken_has_the_very_characters_of_the_protocol(frame in "[!>?][0-9A-F +.-]{0,12}\r") {
        for (command, _, reply, _) in table() {
            if command.decode(frame.as_bytes(), false).is_ok() {
                prop_assert_eq!(frame.as_bytes()[0], reply.as_bytes()[0]);
                prop_assert!(frame.len() <= command.longest_reply());
            }
        }
    }
}
