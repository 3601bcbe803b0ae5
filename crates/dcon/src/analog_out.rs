//! Analog outputs: 7021 and 7021P (one channel, not named in the request), 7022 (two) and 7024 (four).

use super::command::Nature::{self, Output, Read, Store};
use super::request::Request;
use super::shape::Shape;
use super::{Address, Channel, Level, OutputForm, SlewCode, TypeCode, UpTo};

/// Commands of analog output modules. `channel` is none for the one-channel 7021 and 7021P.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnalogOut {
    /// `#AA[N](data)`: go there, at the configured slew rate. Out of range is refused, and goes to the nearest limit.
    Write {
        /// Which output.
        channel: Option<Channel>,
        /// Where to.
        level: Level,
    },
    /// `$AA6[N]`: the value last commanded; the power-on value if none was.
    ReadLast {
        /// Which output.
        channel: Option<Channel>,
        /// How it is printed.
        form: OutputForm,
    },
    /// `$AA8[N]`: where the output is now, in the middle of a ramp too.
    ReadPresent {
        /// Which output.
        channel: Option<Channel>,
        /// How it is printed.
        form: OutputForm,
    },
    /// `$AA4[N]`: the present output becomes the power-on value.
    StorePowerOn {
        /// Which output.
        channel: Option<Channel>,
    },
    /// `$AA7[N]`.
    ReadPowerOn {
        /// Which output.
        channel: Option<Channel>,
        /// How it is printed.
        form: OutputForm,
    },
    /// `~AA5[N]`: the present output becomes the safe value.
    StoreSafe {
        /// Which output.
        channel: Option<Channel>,
    },
    /// `~AA4[N]`.
    ReadSafe {
        /// Which output.
        channel: Option<Channel>,
        /// How it is printed.
        form: OutputForm,
    },
    /// `$AA9N` of the 7022.
    ReadChannelConfig {
        /// Which output.
        channel: Channel,
    },
    /// `$AA9NTS` of the 7022.
    WriteChannelConfig {
        /// Which output.
        channel: Channel,
        /// Last digit of the type code `3T`.
        range: UpTo<2>,
        /// Slew rate.
        slew: SlewCode,
    },
}

impl AnalogOut {
    pub(super) fn encode(self, to: Address, request: &mut Request<'_>) {
        match self {
            Self::Write { channel, level } => {
                request.to(b'#', to).digit(channel);
                level.encode(request);
                request
            }
            Self::ReadLast { channel, .. } => request.to(b'$', to).text(b"6").digit(channel),
            Self::ReadPresent { channel, .. } => request.to(b'$', to).text(b"8").digit(channel),
            Self::StorePowerOn { channel } => request.to(b'$', to).text(b"4").digit(channel),
            Self::ReadPowerOn { channel, .. } => request.to(b'$', to).text(b"7").digit(channel),
            Self::StoreSafe { channel } => request.to(b'~', to).text(b"5").digit(channel),
            Self::ReadSafe { channel, .. } => request.to(b'~', to).text(b"4").digit(channel),
            Self::ReadChannelConfig { channel } => request.to(b'$', to).text(b"9").digit(channel),
            Self::WriteChannelConfig {
                channel,
                range,
                slew,
            } => request
                .to(b'$', to)
                .text(b"9")
                .digit(channel)
                .digit(range)
                .digit(slew.0),
        };
    }

    pub(super) fn table(&self) -> (Nature, Shape) {
        match *self {
            Self::Write { .. } => (Output, Shape::Output),
            Self::ReadLast { form, .. }
            | Self::ReadPresent { form, .. }
            | Self::ReadPowerOn { form, .. }
            | Self::ReadSafe { form, .. } => (Read, Shape::Level(form)),
            Self::StorePowerOn { .. } | Self::StoreSafe { .. } => (Store, Shape::Accepted),
            Self::ReadChannelConfig { .. } => (Read, Shape::OutputChannel),
            Self::WriteChannelConfig { .. } => (Store, Shape::Accepted),
        }
    }
}

/// The range of a 7022 channel from its one digit.
pub(super) fn output_range(digit: u8) -> TypeCode {
    TypeCode(0x30 | digit)
}
