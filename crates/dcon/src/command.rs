//! The closed set of requests, and the reply each of them may have.

use super::request::Request;
use super::shape::Shape;
use super::{
    Address, AnalogIn, AnalogOut, Common, Counter, Digital, Reply, ReplyError, frame, shape,
};

/// A request that can be put on a line. Made most shortly as `Common::ReadConfig.to(Address(1))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// `~**` to all: the host is alive; restarts the host watchdog of every module. Not answered.
    HostOk,
    /// `#**` to all: sample the inputs now, for [`Digital::ReadSampled`]. Not answered.
    SampleAll,
    /// What every module understands.
    Common(Address, Common),
    /// To an analog input module.
    AnalogIn(Address, AnalogIn),
    /// To an analog output module.
    AnalogOut(Address, AnalogOut),
    /// To a digital module.
    Digital(Address, Digital),
    /// To a counter.
    Counter(Address, Counter),
}

/// What a command does to the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nature {
    /// Changes nothing: may be asked again.
    Read,
    /// Reading consumes something (a flag that falls): a repeat would give another answer.
    ReadOnce,
    /// Drives outputs. A module whose host watchdog has tripped ignores it.
    Output,
    /// Changes a state that is lost with the supply.
    Act,
    /// Writes, or may write, to the module's EEPROM: a limited number of times in its life.
    Store,
}

macro_rules! family {
    ($($name:ident),*) => {$(
        impl $name {
            /// This, sent to `address`.
            pub const fn to(self, address: Address) -> Command {
                Command::$name(address, self)
            }
        }
    )*};
}
family!(Common, AnalogIn, AnalogOut, Digital, Counter);

impl Command {
    /// Appends the request to `out`, checksum (if the line has one) and CR included. At most 21 characters.
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

    /// The meaning of `frame` as the reply to this very command.
    ///
    /// The CR may be left off, except where only the CR tells that nothing is missing: replies of open length on
    /// a line without checksum. Everything unexpected is an error; `Refused` and `Ignored` are what the module said.
    pub fn decode(&self, frame: &[u8], checksum: bool) -> Result<Reply, ReplyError> {
        let (Some(address), Some((nature, shape))) = (self.address(), self.table()) else {
            return Err(ReplyError::NotAsked);
        };
        let (text, ended) = frame::open(frame, checksum)?;
        if !ended && shape.is_open() {
            return Err(ReplyError::NotEnded);
        }
        shape::declined(text, address, nature)?;
        shape.decode(text, address)
    }

    /// True when a repeat after a lost reply is harmless and gives the same information.
    pub fn repeatable(&self) -> bool {
        self.nature() == Nature::Read
    }

    /// True when the module writes, or may write, its EEPROM. Never to be sent cyclically or during a lot.
    pub fn writes_eeprom(&self) -> bool {
        self.nature() == Nature::Store
    }

    /// Characters of the longest reply from lead to CR. A checksum adds two. Zero for broadcasts.
    pub fn longest_reply(&self) -> usize {
        /// `?AA` and CR: any command may be refused.
        const REFUSAL: usize = 4;
        self.table()
            .map_or(0, |(_, shape)| REFUSAL.max(shape.longest() + 1))
    }

    /// False for broadcasts.
    pub fn answered(&self) -> bool {
        self.address().is_some()
    }

    /// The module asked; none for broadcasts.
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

    /// True where the module may be busy converting: its reply is given the longer allowance.
    pub fn is_analog_input(&self) -> bool {
        matches!(self, Self::AnalogIn(..))
    }

    /// What the command does to the module. Broadcasts act: they reset watchdogs and take samples.
    pub fn nature(&self) -> Nature {
        self.table().map_or(Nature::Act, |(nature, _)| nature)
    }

    fn table(&self) -> Option<(Nature, Shape)> {
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
