//! The closed set of requests, and the decoding of their replies.

use super::request::Request;
use super::shape::Shape;
use super::{
    Address, AnalogIn, AnalogOut, Common, Counter, Digital, Reply, ReplyError, frame, shape,
};

/// A request on a line. Shortest way to build one: `Common::ReadConfig.to(Address(1))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// `~**` to all modules: the host is alive. Restarts the host watchdog of every module; has no reply.
    HostOk,
    /// `#**` to all modules: sample the inputs now, for [`Digital::ReadSampled`]. Has no reply.
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

/// Effect of a command on the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Changes nothing; may be repeated.
    Read,
    /// Reading clears something (such as a flag), so a repeat gives another answer.
    ReadOnce,
    /// Drives outputs. A module with a tripped host watchdog ignores it.
    Output,
    /// Changes a state that a power cycle loses.
    Act,
    /// Writes, or may write, the module's EEPROM, which endures a limited number of writes.
    Store,
}

macro_rules! family {
    ($($name:ident),*) => {$(
        impl $name {
            /// Addresses the command to one module.
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
    /// The CR may be missing, except where only the CR proves that the reply is complete: replies of variable
    /// length on a line without checksum. Returns a [`ReplyError`] for everything unexpected; its variants
    /// `Refused` and `Ignored` are answers of the module.
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

    /// Whether repeating the command after a lost reply is harmless and gives the same information.
    pub fn repeatable(&self) -> bool {
        self.effect() == Effect::Read
    }

    /// Whether the module writes, or may write, its EEPROM. Such a command must not be sent cyclically or during a lot.
    pub fn writes_eeprom(&self) -> bool {
        self.effect() == Effect::Store
    }

    /// Length of the longest reply from lead to CR, characters; a checksum adds two. Zero for broadcasts.
    pub fn longest_reply(&self) -> usize {
        /// `?AA` and CR: any command may be refused.
        const REFUSAL: usize = 4;
        self.table()
            .map_or(0, |(_, shape)| REFUSAL.max(shape.longest() + 1))
    }

    /// Whether the command has a reply; false for broadcasts.
    pub fn has_reply(&self) -> bool {
        self.address().is_some()
    }

    /// Address of the module; `None` for broadcasts.
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

    /// Whether the module may be busy converting, so that its reply gets the longer timeout.
    pub fn is_analog_input(&self) -> bool {
        matches!(self, Self::AnalogIn(..))
    }

    /// Effect of the command on the module. Broadcasts count as [`Effect::Act`]: they restart watchdogs and take
    /// samples.
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
