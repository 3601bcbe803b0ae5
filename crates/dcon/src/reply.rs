//! What a module said, typed by what was asked.

use super::{
    Address, AlarmState, Bits, Channel, Config, GateMode, InputMode, Level, Reading, Readings,
    SlewCode, TypeCode,
};
use std::fmt;

/// The meaning of a good reply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reply {
    /// A broadcast is on its way; nobody confirms it.
    Sent,
    /// `!AA` or `>`: done.
    Accepted,
    /// `!AATTCCFF`.
    Config {
        /// As stored: not the address asked when the module is in INIT* mode.
        address: Address,
        /// As stored.
        config: Config,
    },
    /// Firmware or name.
    Text(Text),
    /// Yes or no, as the command says.
    Flag(bool),
    /// A mask or status.
    Byte(u8),
    /// A setting in decimals.
    Decimal(u32),
    /// `!AAEVV`.
    Watchdog {
        /// None from firmware that leaves it out.
        enabled: Option<bool>,
        /// Silence that trips it, tenths of a second.
        timeout_tenths: u8,
    },
    /// Inputs and outputs.
    Bits(Bits),
    /// What a synchronised sample took.
    Sampled {
        /// True the first time it is read.
        first_read: bool,
        /// The sample.
        bits: Bits,
    },
    /// Events on a digital input, modulo 65536.
    Events(u16),
    /// A 32-bit count, preset or maximum.
    Count(u32),
    /// Hz.
    Frequency(u32),
    /// Gate of the counters.
    Gate(GateMode),
    /// Inputs of the counters.
    Inputs(InputMode),
    /// Alarm and outputs of a counter.
    Alarm(AlarmState),
    /// One analog input.
    Reading(Reading),
    /// All analog inputs.
    Readings(Readings),
    /// One analog output.
    Level(Level),
    /// Range and slew of a 7022 channel.
    OutputChannel {
        /// Range.
        range: TypeCode,
        /// Slew rate.
        slew: SlewCode,
    },
    /// Range of an input channel.
    ChannelRange {
        /// Which input.
        channel: Channel,
        /// Range.
        range: TypeCode,
    },
}

/// A short text of a module, without allocation.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Text {
    bytes: [u8; Text::LONGEST],
    length: u8,
}

impl Text {
    /// Names have up to six characters, versions are shorter; the rest is grace.
    pub const LONGEST: usize = 16;

    /// None when empty or too long.
    pub(super) fn new(text: &[u8]) -> Option<Self> {
        let mut bytes = [0; Self::LONGEST];
        bytes.get_mut(..text.len())?.copy_from_slice(text);
        (!text.is_empty()).then_some(Self {
            bytes,
            length: text.len() as u8,
        })
    }

    /// As sent.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..usize::from(self.length)]).unwrap_or_default()
    }
}

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}
