//! Tests: bytes of each command on the wire, and meaning of its reply.

use super::module_rows::{counter_rows, digital_rows};
use super::{A1, ch, config, level};
use crate::*;

/// Returns the table: command, request without checksum, reply without checksum, meaning.
pub(super) fn table() -> Vec<(Command, &'static str, &'static str, Reply)> {
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
    let text = |text: &str| Reply::Text(Text::new(text.as_bytes()).unwrap());
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
            Common::WriteProtocol { modbus: true }.to(A1),
            "$01P1",
            "!01",
            done,
        ),
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
