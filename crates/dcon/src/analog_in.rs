//! Analog inputs: 7017, 7017F, 7017R, 7018, 7019 (eight channels), 7015 (six), 7033 (three resistance thermometers),
//! 7011, 7012, 7013, 7014, 7016 (one channel; they take `#AA` but not `#AAN`).

use super::command::Effect::{self, Read, Store};
use super::request::Request;
use super::shape::Shape;
use super::{Address, Channel, DataFormat, TypeCode};
use std::fmt;

/// Notation, range and channel count of an input module; decoding its readings needs all three. A host should once
/// compare notation and range with the module's configuration word.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct InputForm {
    channels: u8,
    /// Notation, from the configuration word.
    pub format: DataFormat,
    /// Range, from the configuration word.
    pub range: TypeCode,
}

impl InputForm {
    /// Returns the form of a module with `channels` inputs; `None` outside 1 to 8, the most that these families have.
    pub const fn new(channels: u8, format: DataFormat, range: TypeCode) -> Option<Self> {
        if channels >= 1 && channels <= 8 {
            Some(Self {
                channels,
                format,
                range,
            })
        } else {
            None
        }
    }

    /// Returns the form of a 7017, 7017F, 7017R or 7018: eight inputs.
    pub const fn eight(format: DataFormat, range: TypeCode) -> Self {
        Self {
            channels: 8,
            format,
            range,
        }
    }

    /// Returns the form of a 7033: three inputs.
    pub const fn three(format: DataFormat, range: TypeCode) -> Self {
        Self {
            channels: 3,
            format,
            range,
        }
    }

    /// Returns the number of inputs, 1 to 8.
    pub const fn channels(self) -> u8 {
        self.channels
    }
}

impl fmt::Debug for InputForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.channels, self.format)
    }
}

/// Commands of analog input modules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnalogIn {
    /// `#AA`: reads all channels; a disabled channel reads blank.
    ReadAll(InputForm),
    /// `#AAN`: reads one channel.
    ReadOne {
        /// Number of the input.
        channel: Channel,
        /// Notation, range and channel count of the module.
        form: InputForm,
    },
    /// `$AAA`: reads all channels in hex, whatever the configured notation.
    ReadAllHex(InputForm),
    /// `$AA6`: reads the enabled channels, bit n = channel n.
    ReadMask,
    /// `$AA5VV`: enables channels, bit n = channel n. Only its length distinguishes it from `$AA5`, which reads the
    /// reset status.
    WriteMask(u8),
    /// `$AA3` of thermocouple modules: reads the temperature of the cold junction, degrees Celsius.
    ReadColdJunction,
    /// `$AAB`, newer modules: reads the channels with an open wire or over range, bit n = channel n.
    ReadDiagnosis,
    /// `$AA8Ci`, newer modules: reads the range of a channel.
    ReadChannelRange {
        /// Number of the input.
        channel: Channel,
    },
    /// `$AA7CiRrr`, newer modules: sets the range of a channel.
    WriteChannelRange {
        /// Number of the input.
        channel: Channel,
        /// New range of the channel.
        range: TypeCode,
    },
}

impl AnalogIn {
    pub(super) fn encode(self, to: Address, request: &mut Request<'_>) {
        match self {
            Self::ReadAll(_) => request.to(b'#', to),
            Self::ReadOne { channel, .. } => request.to(b'#', to).digit(channel),
            Self::ReadAllHex(_) => request.to(b'$', to).text(b"A"),
            Self::ReadMask => request.to(b'$', to).text(b"6"),
            Self::WriteMask(mask) => request.to(b'$', to).text(b"5").hex(u32::from(mask), 2),
            Self::ReadColdJunction => request.to(b'$', to).text(b"3"),
            Self::ReadDiagnosis => request.to(b'$', to).text(b"B"),
            Self::ReadChannelRange { channel } => request.to(b'$', to).text(b"8C").digit(channel),
            Self::WriteChannelRange { channel, range } => request
                .to(b'$', to)
                .text(b"7C")
                .digit(channel)
                .text(b"R")
                .hex(u32::from(range.0), 2),
        };
    }

    pub(super) fn table(&self) -> (Effect, Shape) {
        match *self {
            Self::ReadAll(form) => (Read, Shape::Readings(form)),
            Self::ReadOne { form, .. } => (Read, Shape::Reading(form)),
            Self::ReadAllHex(form) => (
                Read,
                Shape::Readings(InputForm {
                    format: DataFormat::Hex,
                    ..form
                }),
            ),
            Self::ReadMask | Self::ReadDiagnosis => (Read, Shape::Byte),
            Self::WriteMask(_) => (Store, Shape::Accepted),
            Self::ReadColdJunction => (
                Read,
                Shape::Reading(InputForm::eight(
                    DataFormat::Engineering,
                    TypeCode::COLD_JUNCTION,
                )),
            ),
            Self::ReadChannelRange { channel } => (Read, Shape::ChannelRange(channel)),
            Self::WriteChannelRange { .. } => (Store, Shape::Accepted),
        }
    }

    /// Returns the range of the inputs, for commands that return readings.
    pub(super) fn range(&self) -> Option<TypeCode> {
        let (_, shape) = self.table();
        let (Shape::Reading(form) | Shape::Readings(form)) = shape else {
            return None;
        };
        Some(form.range)
    }
}
