//! Descriptions of replies; the command decides what a byte or a number in its reply means.

use super::{Description, channels, decimal};
use crate::{
    Address, AlarmKind, AlarmMode, AlarmState, Alarms, AnalogIn, Bits, Command, Common, Config,
    Counter, GateMode, InputMode, Model, Reading, Readings, Reply, Value,
};
use std::fmt;

/// Bit of the watchdog status: the host watchdog has tripped.
const TRIPPED: u8 = 0x04;

impl Command {
    /// Describes a reply to this command. With `model`, the description of a digital module separates inputs from
    /// outputs.
    pub fn describe_reply(&self, reply: &Reply, model: Option<Model>) -> Description {
        let one = Description::new;
        match *reply {
            Reply::Sent => one("sent"),
            Reply::Accepted => one("accepted"),
            Reply::Config { address, config } => {
                config.describe("config", "config_checksum", address)
            }
            Reply::Text(text) => one("text").with("text", text.as_str()),
            Reply::Flag(true) => one("yes"),
            Reply::Flag(false) => one("no"),
            Reply::Byte(byte) => self.describe_byte(byte),
            Reply::Decimal(number) => self.describe_number(number),
            Reply::Watchdog {
                enabled,
                timeout_tenths,
            } => one(match enabled {
                Some(true) => "watchdog_on",
                Some(false) => "watchdog_off",
                None => "watchdog_timeout",
            })
            .with("timeout_s", decimal(timeout_tenths)),
            Reply::Bits(found) => bits(found, model),
            Reply::Sampled {
                first_read: true,
                bits: found,
            } => bits(found, model),
            Reply::Sampled {
                first_read: false,
                bits: found,
            } => bits_of("sampled_before", found),
            Reply::Events(count) => one("events").with("count", count),
            Reply::Count(count) => one("count").with("count", count),
            Reply::Frequency(hertz) => one("frequency").with("hertz", hertz),
            Reply::Gate(GateMode::Low) => one("gate_low"),
            Reply::Gate(GateMode::High) => one("gate_high"),
            Reply::Gate(GateMode::None) => one("gate_none"),
            Reply::Inputs(InputMode::BothTtl) => one("both_ttl"),
            Reply::Inputs(InputMode::BothIsolated) => one("both_isolated"),
            Reply::Inputs(InputMode::Isolated1) => one("isolated_1"),
            Reply::Inputs(InputMode::Isolated0) => one("isolated_0"),
            Reply::Alarm(state) => alarms(state),
            Reply::AlarmMode(AlarmMode::PerCounter) => one("alarm_mode_0"),
            Reply::AlarmMode(AlarmMode::HighHigh) => one("alarm_mode_1"),
            Reply::Reading(it) => reading(&it),
            Reply::Readings(all) => readings(&all),
            Reply::Level(level) => one("level").with("level", level),
            Reply::OutputChannel { range, slew } => match slew.in_units(range) {
                Some(slew) => one("output_range").with("slew", slew),
                None => one("output_range_immediate"),
            }
            .with("type", range),
            Reply::ChannelRange { range, .. } => one("input_range").with("type", range),
        }
    }

    fn describe_byte(&self, byte: u8) -> Description {
        match self {
            Self::Common(_, Common::ReadWatchdogStatus) => {
                let is_tripped = byte & TRIPPED != 0;
                Description::new(if is_tripped { "tripped" } else { "not_tripped" })
                    .with("status", format_args!("{byte:02X}"))
            }
            Self::AnalogIn(_, AnalogIn::ReadMask | AnalogIn::ReadDiagnosis) => {
                Description::new("channels").with("channels", channels(byte.into(), 0))
            }
            Self::Common(_, Common::ReadResponseDelay) => {
                Description::new("delay").with("delay_ms", byte)
            }
            Self::HostOk
            | Self::SampleAll
            | Self::Common(..)
            | Self::AnalogIn(..)
            | Self::AnalogOut(..)
            | Self::Digital(..)
            | Self::Counter(..) => {
                Description::new("byte").with("byte", format_args!("{byte:02X}"))
            }
        }
    }

    fn describe_number(&self, number: u32) -> Description {
        match self {
            Self::Counter(_, Counter::ReadThreshold(_)) => {
                Description::new("threshold").with("volts", decimal(number))
            }
            Self::Counter(_, Counter::ReadDisplay) => match number {
                0..=1 => Description::new("shows_counter").with("counter", number),
                2.. => Description::new("shows_number"),
            },
            Self::Counter(_, Counter::ReadFilterWidth(_)) => {
                Description::new("width").with("width_us", number)
            }
            Self::HostOk
            | Self::SampleAll
            | Self::Common(..)
            | Self::AnalogIn(..)
            | Self::AnalogOut(..)
            | Self::Digital(..)
            | Self::Counter(..) => Description::new("number").with("number", number),
        }
    }
}

impl Config {
    /// Describes a configuration with its address: with code `checked` if the configuration switches checksums on,
    /// otherwise with code `plain`.
    pub(super) fn describe(
        self,
        plain: &'static str,
        checked: &'static str,
        address: Address,
    ) -> Description {
        let baud = self.baud.rate().map(|rate| rate.to_string());
        let code = if self.format.checksum() {
            checked
        } else {
            plain
        };
        Description::new(code)
            .with("stored_address", address)
            .with("type", self.type_code)
            .with("baud", baud.unwrap_or(format!("{:02X}", self.baud.0)))
            .with("format", format_args!("{:02X}", self.format.0))
    }
}

fn bits(bits: Bits, model: Option<Model>) -> Description {
    let one = Description::new;
    let Some(model) = model else {
        return bits_of("bits", bits);
    };
    let (inputs, outputs) = model.split(bits);
    let (inputs, outputs) = (channels(inputs, 0), channels(outputs, 0));
    match (model.inputs, model.outputs) {
        (_, 0) => one("inputs").with("inputs", inputs),
        (0, _) => one("outputs").with("outputs", outputs),
        (1.., 1..) => one("inputs_and_outputs")
            .with("inputs", inputs)
            .with("outputs", outputs),
    }
}

fn bits_of(code: &'static str, bits: Bits) -> Description {
    Description::new(code)
        .with("first", format_args!("{:08b}", bits.first))
        .with("second", format_args!("{:08b}", bits.second))
}

fn alarms(AlarmState { alarms, outputs }: AlarmState) -> Description {
    let code = match alarms {
        Alarms::PerCounter([false, false]) | Alarms::HighHigh(None) => "alarms_off",
        Alarms::PerCounter([true, false]) => "alarm_of_counter_0",
        Alarms::PerCounter([false, true]) => "alarm_of_counter_1",
        Alarms::PerCounter([true, true]) => "alarms_of_both_counters",
        Alarms::HighHigh(Some(AlarmKind::Momentary)) => "alarm_momentary",
        Alarms::HighHigh(Some(AlarmKind::Latched)) => "alarm_latched",
    };
    Description::new(code).with("outputs", channels(outputs.into(), 0))
}

/// Returns the code of a reading that is a mark, such as over range; `None` for a number.
fn mark(value: Value) -> Option<&'static str> {
    match value {
        Value::OverRange => Some("over_range"),
        Value::UnderRange => Some("under_range"),
        Value::Blank => Some("disabled"),
        Value::Engineering(_) | Value::Percent(_) | Value::Hex(_) | Value::HexUnipolar(_) => None,
    }
}

fn reading(reading: &Reading) -> Description {
    match mark(reading.value) {
        Some(code) => Description::new(code),
        None => Description::new("reading").with("reading", reading),
    }
}

/// Describes all readings in one argument; uses another code when some of them are marks instead of numbers.
fn readings(all: &Readings) -> Description {
    let numbered = all.iter().enumerate();
    let list: Vec<String> = numbered.map(|(n, it)| format!("{n}={it}")).collect();
    let code = match all.iter().all(|it| mark(it.value).is_none()) {
        true => "readings",
        false => "readings_with_marks",
    };
    Description::new(code).with("readings", list.join(" "))
}

impl fmt::Display for Reading {
    /// Writes a number with the decimals that the module sent, or a mark: an arrow up for over range, down for under
    /// range, `-` for a disabled channel.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let places = self.text().split('.').nth(1).map_or(0, str::len);
        match self.value {
            Value::Engineering(value) => write!(f, "{value:.places$}"),
            Value::Percent(value) => write!(f, "{value:.places$}%"),
            Value::Hex(steps) => write!(f, "{steps}/32768"),
            Value::HexUnipolar(steps) => write!(f, "{steps}/65535"),
            Value::OverRange => f.write_str("↑"),
            Value::UnderRange => f.write_str("↓"),
            Value::Blank => f.write_str("-"),
        }
    }
}
