//! Prints commands and replies in words, for traces and the bus tools. The words follow the types; the tables of the
//! protocol are in the files of the families.

use super::{Command, Reply, Value};
use std::fmt;

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::HostOk => f.write_str("all: host ok"),
            Self::SampleAll => f.write_str("all: sample inputs"),
            Self::Common(to, ask) => write!(f, "{to}: {ask:?}"),
            Self::AnalogIn(to, ask) => write!(f, "{to}: {ask:?}"),
            Self::AnalogOut(to, ask) => write!(f, "{to}: {ask:?}"),
            Self::Digital(to, ask) => write!(f, "{to}: {ask:?}"),
            Self::Counter(to, ask) => write!(f, "{to}: {ask:?}"),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Engineering(value) => write!(f, "{value}"),
            Self::Percent(value) => write!(f, "{value} %"),
            Self::Hex(steps) => write!(f, "{steps}/32768"),
            Self::HexUnipolar(steps) => write!(f, "{steps}/65535"),
            Self::OverRange => f.write_str("over range"),
            Self::UnderRange => f.write_str("under range"),
            Self::Blank => f.write_str("disabled"),
        }
    }
}

impl fmt::Display for Reply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sent => f.write_str("sent to all"),
            Self::Accepted => f.write_str("accepted"),
            Self::Text(text) => f.write_str(text.as_str()),
            Self::Flag(flag) => f.write_str(if *flag { "yes" } else { "no" }),
            Self::Byte(byte) => write!(f, "{byte:02X} ({byte:08b})"),
            Self::Decimal(value) => value.fmt(f),
            Self::Count(count) => write!(f, "count {count}"),
            Self::Frequency(hertz) => write!(f, "{hertz} Hz"),
            Self::Events(count) => write!(f, "{count} events"),
            Self::Bits(bits) => write!(f, "first {:08b} second {:08b}", bits.first, bits.second),
            Self::Reading(reading) => reading.value.fmt(f),
            Self::Readings(all) => {
                for (channel, reading) in all.iter().enumerate() {
                    write!(
                        f,
                        "{}{channel}: {}",
                        if channel == 0 { "" } else { ", " },
                        reading.value
                    )?;
                }
                Ok(())
            }
            Self::Level(level) => write!(f, "{} steps of {:?}", level.steps(), level.form()),
            Self::Config { address, config } => write!(
                f,
                "address {address}, type {:02X}, {}, format {:02X}{}",
                config.type_code.0,
                config
                    .baud
                    .rate()
                    .map_or_else(|| "unknown baud".to_owned(), |baud| format!("{baud} baud")),
                config.format.0,
                if config.format.checksum() {
                    " with checksum"
                } else {
                    ""
                },
            ),
            Self::Watchdog { .. }
            | Self::Sampled { .. }
            | Self::Gate(_)
            | Self::Inputs(_)
            | Self::Alarm(_)
            | Self::OutputChannel { .. }
            | Self::ChannelRange { .. } => write!(f, "{self:?}"),
        }
    }
}
