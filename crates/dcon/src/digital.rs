//! Digital inputs and outputs, latches, and the slow event counters on the inputs.

use super::command::Effect::{self, Act, Output, Read, ReadOnce, Store};
use super::request::Request;
use super::shape::Shape;
use super::{Address, Channel, OutputWord, UpTo};

/// One of the two output patterns that a module stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// Pattern applied at power-on.
    PowerOn,
    /// Pattern applied when the host watchdog trips.
    Safe,
}

impl Stored {
    fn letter(self) -> &'static [u8] {
        match self {
            Self::PowerOn => b"P",
            Self::Safe => b"S",
        }
    }
}

/// Data of `#AABBDD`, which sets some of the outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GroupWrite {
    /// BB = 00: outputs 0..7, bit n = output n.
    GroupA(u8),
    /// BB = 0B: outputs 8..15 of a module with 16 outputs, bit n = output 8 + n.
    GroupB(u8),
    /// BB = 1c: output c of group A (outputs 0..7).
    OneOfA {
        /// Number of the output, 0 to 7.
        output: UpTo<7>,
        /// New state of the output.
        on: bool,
    },
    /// BB = Bc: output c of group B (outputs 8..15).
    OneOfB {
        /// Number of the output within the group, 0 to 7.
        output: UpTo<7>,
        /// New state of the output.
        on: bool,
    },
}

/// Commands of digital modules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digital {
    /// `$AA6`: reads inputs and outputs, outputs first.
    ReadAll,
    /// `@AA`: reads inputs and outputs like `$AA6`; the reply begins with `>` instead of `!`.
    ReadPort,
    /// `@AA(data)`: sets all outputs.
    Write(OutputWord),
    /// `#AABBDD`: sets some outputs.
    WriteGroup(GroupWrite),
    /// `#AAN`: reads the number of events on an input since it was last cleared, modulo 65536. Pulses of 5 ms and
    /// longer count.
    ReadEvents {
        /// Number of the input.
        channel: Channel,
    },
    /// `$AACN`: clears the event count of an input.
    ClearEvents {
        /// Number of the input.
        channel: Channel,
    },
    /// `$AALS`: reads which inputs have been high (or low) since the latches were last cleared.
    ReadLatched {
        /// True for latched high, false for latched low.
        high: bool,
    },
    /// `$AAC`: clears all latches.
    ClearLatched,
    /// `$AA4`: reads the sample that [`super::Command::SampleAll`] took. The module refuses when there is none.
    ReadSampled,
    /// `~AA4V`: reads a stored pattern.
    ReadStored(Stored),
    /// `~AA5V`: stores the present outputs as a pattern.
    Store(Stored),
}

impl Digital {
    pub(super) fn encode(self, to: Address, request: &mut Request<'_>) {
        match self {
            Self::ReadAll => request.to(b'$', to).text(b"6"),
            Self::ReadPort => request.to(b'@', to),
            Self::Write(outputs) => {
                outputs.encode(request.to(b'@', to));
                request
            }
            Self::WriteGroup(write) => {
                write.encode(request.to(b'#', to));
                request
            }
            Self::ReadEvents { channel } => request.to(b'#', to).digit(channel),
            Self::ClearEvents { channel } => request.to(b'$', to).text(b"C").digit(channel),
            Self::ReadLatched { high } => request.to(b'$', to).text(b"L").flag(high),
            Self::ClearLatched => request.to(b'$', to).text(b"C"),
            Self::ReadSampled => request.to(b'$', to).text(b"4"),
            Self::ReadStored(which) => request.to(b'~', to).text(b"4").text(which.letter()),
            Self::Store(which) => request.to(b'~', to).text(b"5").text(which.letter()),
        };
    }

    pub(super) fn table(&self) -> (Effect, Shape) {
        match *self {
            Self::ReadAll => (Read, Shape::Bits),
            Self::ReadPort => (Read, Shape::PortBits),
            Self::Write(_) | Self::WriteGroup(_) => (Output, Shape::Output),
            Self::ReadEvents { .. } => (Read, Shape::Events),
            Self::ClearEvents { .. } | Self::ClearLatched => (Act, Shape::Accepted),
            Self::ReadLatched { .. } => (Read, Shape::Latched),
            Self::ReadSampled => (ReadOnce, Shape::Sampled),
            Self::ReadStored(_) => (Read, Shape::StoredBits),
            Self::Store(_) => (Store, Shape::Accepted),
        }
    }
}

impl GroupWrite {
    fn encode(self, request: &mut Request<'_>) {
        match self {
            Self::GroupA(bits) => request.text(b"00").hex(u32::from(bits), 2),
            Self::GroupB(bits) => request.text(b"0B").hex(u32::from(bits), 2),
            Self::OneOfA { output, on } => request.text(b"1").digit(output).hex(u32::from(on), 2),
            Self::OneOfB { output, on } => request.text(b"B").digit(output).hex(u32::from(on), 2),
        };
    }
}
