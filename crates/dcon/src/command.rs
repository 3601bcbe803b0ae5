//! All requests of the protocol as one closed enum, and the decoding of their replies.

use super::request::Request;
use super::shape::Shape;
use super::{
    Address, AnalogIn, AnalogOut, Common, Counter, Digital, Reply, ReplyError, frame, shape,
};

/// A request on a line. The shortest way to build one: `Common::ReadConfig.to(Address(1))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// `~**` to all modules: the host is alive. Restarts the host watchdog of every module; no module replies.
    HostOk,
    /// `#**` to all modules: sample the inputs now, for [`Digital::ReadSampled`]. No module replies.
    SampleAll,
    /// A command of every module type.
    Common(Address, Common),
    /// A command of an analog input module.
    AnalogIn(Address, AnalogIn),
    /// A command of an analog output module.
    AnalogOut(Address, AnalogOut),
    /// A command of a digital module.
    Digital(Address, Digital),
    /// A command of a counter module.
    Counter(Address, Counter),
}

/// What a command does to the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Changes nothing; may be repeated.
    Read,
    /// Clears what it reads (such as a flag), so that a repetition gives another answer.
    ReadOnce,
    /// Drives outputs. A module whose host watchdog has tripped ignores it.
    Output,
    /// Changes a state that is lost at power-off.
    Act,
    /// Writes, or may write, the module's EEPROM, which endures a limited number of writes.
    Store,
}

macro_rules! family {
    ($($name:ident),*) => {$(
        impl $name {
            /// Makes a request of this command to one module.
            pub const fn to(self, address: Address) -> Command {
                Command::$name(address, self)
            }
        }
    )*};
}
family!(Common, AnalogIn, AnalogOut, Digital, Counter);

impl Command {
    /// Appends the request to `out`, with checksum (if the line has one) and CR; at most 21 characters.
    pub fn encode(&self, checksum: bool, out: &mut Vec<u8>) {
        let mut request = Request::new(out);
        match *self {
            Self::HostOk => {
                request.text(b"~**");
            }
            Self::SampleAll => {
                request.text(b"#**");
            }
            Self::Common(to, ask) => ask.encode(to, &mut request),
            Self::AnalogIn(to, ask) => ask.encode(to, &mut request),
            Self::AnalogOut(to, ask) => ask.encode(to, &mut request),
            Self::Digital(to, ask) => ask.encode(to, &mut request),
            Self::Counter(to, ask) => ask.encode(to, &mut request),
        }
        request.end(checksum);
    }

    /// Decodes `frame` as the reply to this command.
    ///
    /// The CR may be missing, unless it alone proves that the reply is complete: for a reply of variable length on a
    /// line without checksum. Returns a [`ReplyError`] for everything unexpected; two of its variants, `Refused` and
    /// `Ignored`, are genuine answers of the module.
    pub fn decode(&self, frame: &[u8], checksum: bool) -> Result<Reply, ReplyError> {
        let (Some(address), Some((effect, shape))) = (self.address(), self.table()) else {
            return Err(ReplyError::Broadcast);
        };
        let (text, ended) = frame::open(frame, checksum)?;
        if !ended && shape.is_open() {
            return Err(ReplyError::NotEnded);
        }
        shape::check_refusal(text, address, effect)?;
        shape.decode(text, address)
    }

    /// Returns true when the host may repeat the command after a lost reply, without harm and with the same result.
    pub fn repeatable(&self) -> bool {
        self.effect() == Effect::Read
    }

    /// Returns true when the module writes, or may write, its EEPROM. A host must not send such a command cyclically or
    /// during a lot.
    pub fn writes_eeprom(&self) -> bool {
        self.effect() == Effect::Store
    }

    /// Returns the greatest length of a reply from its first character to its CR, without a checksum, which adds two
    /// characters. Zero for broadcasts.
    pub fn longest_reply(&self) -> usize {
        /// Length of `?AA` and CR: any command may be refused.
        const REFUSAL: usize = 4;
        self.table()
            .map_or(0, |(_, shape)| REFUSAL.max(shape.longest() + 1))
    }

    /// Returns true when the command has a reply, that is, when it is not a broadcast.
    pub fn has_reply(&self) -> bool {
        self.address().is_some()
    }

    /// Returns the address of the module; `None` for broadcasts.
    pub fn address(&self) -> Option<Address> {
        match *self {
            Self::HostOk | Self::SampleAll => None,
            Self::Common(to, _)
            | Self::AnalogIn(to, _)
            | Self::AnalogOut(to, _)
            | Self::Digital(to, _)
            | Self::Counter(to, _) => Some(to),
        }
    }

    /// Returns true when a conversion may keep the module busy, so that its reply needs the longer time-out.
    pub fn is_analog_input(&self) -> bool {
        matches!(self, Self::AnalogIn(..))
    }

    /// Returns what the command does to the module. Broadcasts count as [`Effect::Act`], because they restart watchdogs
    /// and take samples.
    pub fn effect(&self) -> Effect {
        self.table().map_or(Effect::Act, |(effect, _)| effect)
    }

    fn table(&self) -> Option<(Effect, Shape)> {
        match self {
            Self::HostOk | Self::SampleAll => None,
            Self::Common(_, ask) => Some(ask.table()),
            Self::AnalogIn(_, ask) => Some(ask.table()),
            Self::AnalogOut(_, ask) => Some(ask.table()),
            Self::Digital(_, ask) => Some(ask.table()),
            Self::Counter(_, ask) => Some(ask.table()),
        }
    }
}
