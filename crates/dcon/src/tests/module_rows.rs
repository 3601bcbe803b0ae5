//! Rows of the table for digital modules and counters.

use super::{A1, ch, n, word};
use crate::*;

fn bits(first: u8, second: u8) -> Reply {
    Reply::Bits(Bits { first, second })
}

pub(super) fn digital_rows() -> Vec<(Command, &'static str, &'static str, Reply)> {
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

fn shown(digits: u32, places: u8) -> DisplayNumber {
    DisplayNumber::new(digits, UpTo::new(places).unwrap()).unwrap()
}

pub(super) fn counter_rows() -> Vec<(Command, &'static str, &'static str, Reply)> {
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
        (
            Counter::ReadFrequency(n(1)).to(Address(2)),
            "#021",
            ">0000001E",
            Reply::Frequency(30),
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
            Counter::ReadAlarm(AlarmMode::HighHigh).to(A1),
            "@01DI",
            "!0110300",
            Reply::Alarm(AlarmState {
                alarms: Alarms::HighHigh(Some(AlarmKind::Momentary)),
                outputs: 3,
            }),
        ),
        (
            Counter::ReadAlarm(AlarmMode::PerCounter).to(A1),
            "@01DI",
            "!0130000",
            Reply::Alarm(AlarmState {
                alarms: Alarms::PerCounter([true, true]),
                outputs: 0,
            }),
        ),
        (
            Counter::ReadAlarmMode.to(A1),
            "~01A",
            "!011",
            Reply::AlarmMode(AlarmMode::HighHigh),
        ),
        (
            Counter::WriteAlarmMode(AlarmMode::PerCounter).to(A1),
            "~01A0",
            "!01",
            done,
        ),
        (
            Counter::WriteOutputs(UpTo::new(1).unwrap()).to(Address(2)),
            "@02DO01",
            "!02",
            done,
        ),
        (
            Counter::ReadLimit(n(0)).to(A1),
            "@01RP",
            "!01FFFFFFFF",
            Reply::Count(u32::MAX),
        ),
        (
            Counter::ReadLimit(n(1)).to(A1),
            "@01RA",
            "!0100000010",
            Reply::Count(16),
        ),
        (
            Counter::WriteLimit(n(0), 16).to(A1),
            "@01PA00000010",
            "!01",
            done,
        ),
        (
            Counter::WriteLimit(n(1), 16).to(A1),
            "@01SA00000010",
            "!01",
            done,
        ),
        (Counter::ReadDisplay.to(Address(3)), "$038", "!032", five(2)),
        (
            Counter::WriteDisplay(ch(2)).to(Address(3)),
            "$0382",
            "!03",
            done,
        ),
        (
            Counter::WriteDisplayed(shown(12_345, 3)).to(Address(3)),
            "$03912.345",
            "!03",
            done,
        ),
        (
            Counter::WriteDisplayed(shown(99_999, 0)).to(A1),
            "$01999999.",
            "!01",
            done,
        ),
        (
            Counter::WriteDisplayed(shown(0, 4)).to(Address(2)),
            "$0290.0000",
            "!02",
            done,
        ),
    ]
}
