//! Meaning of replies, decoded by the command that asked.

use super::{
    Address, AlarmMode, AlarmState, Bits, Channel, Config, GateMode, InputMode, Level, Reading,
    Readings, SlewCode, TypeCode,
};
use std::fmt;

/// Meaning of a valid reply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reply {
    /// The line has sent a broadcast; no module confirms that it arrived.
    Sent,
    /// `!AA` or `>`: the module did as commanded.
    Accepted,
    /// `!AATTCCFF`: the configuration.
    Config {
        /// Stored address; differs from the address of the request when the module is in INIT* mode.
        address: Address,
        /// Stored configuration.
        config: Config,
    },
    /// Firmware version or module name.
    Text(Text),
    /// Yes or no; the command says to which question.
    Flag(bool),
    /// A mask or status.
    Byte(u8),
    /// A setting in decimal digits.
    Decimal(u32),
    /// `!AAEVV`: host watchdog settings.
    Watchdog {
        /// True when the watchdog is on; `None` when the firmware does not report it.
        enabled: Option<bool>,
        /// Time without a message from the host after which the watchdog trips, tenths of a second.
        timeout_tenths: u8,
    },
    /// States of inputs and outputs.
    Bits(Bits),
    /// States of all inputs at the instant of the last [`super::Command::SampleAll`].
    Sampled {
        /// True when the sample is read for the first time.
        first_read: bool,
        /// States at that instant.
        bits: Bits,
    },
    /// Number of events on a digital input, modulo 65536.
    Events(u16),
    /// A 32-bit count, preset or maximum.
    Count(u32),
    /// Frequency, Hz.
    Frequency(u32),
    /// Gate mode of the counters.
    Gate(GateMode),
    /// Input mode of the counters.
    Inputs(InputMode),
    /// Alarm state and outputs of a counter module.
    Alarm(AlarmState),
    /// Alarm mode of a counter module.
    AlarmMode(AlarmMode),
    /// Reading of one analog input.
    Reading(Reading),
    /// Readings of all analog inputs.
    Readings(Readings),
    /// Level of one analog output.
    Level(Level),
    /// Range and slew rate of a 7022 channel.
    OutputChannel {
        /// Range of the output.
        range: TypeCode,
        /// Slew rate of the output.
        slew: SlewCode,
    },
    /// Range of an input channel.
    ChannelRange {
        /// Number of the input.
        channel: Channel,
        /// Range of the input.
        range: TypeCode,
    },
}

/// A short text from a module, stored without allocation.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Text {
    bytes: [u8; Text::LONGEST],
    length: u8,
}

impl Text {
    /// Greatest number of characters, with a reserve: names have up to six, versions fewer.
    pub const LONGEST: usize = 16;

    /// Creates a text; returns `None` when it is empty or too long.
    pub(super) fn new(text: &[u8]) -> Option<Self> {
        let mut bytes = [0; Self::LONGEST];
        bytes.get_mut(..text.len())?.copy_from_slice(text);
        (!text.is_empty()).then_some(Self {
            bytes,
            length: text.len() as u8,
        })
    }

    /// Returns the text as sent.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..usize::from(self.length)]).unwrap_or_default()
    }
}

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}
