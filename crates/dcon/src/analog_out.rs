//! Analog outputs: 7021 and 7021P (one channel, not named in the request), 7022 (two) and 7024 (four).

use super::command::Effect::{self, Output, Read, Store};
use super::request::Request;
use super::shape::Shape;
use super::{Address, Channel, Level, OutputForm, SlewCode, TypeCode, UpTo};

/// Commands of analog output modules. `channel` is `None` for the one-channel 7021 and 7021P.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnalogOut {
    /// `#AA(data)`, `#AAN(data)`: drives the output to a level at the configured slew rate. The module answers a level
    /// out of range with a refusal, but still drives the output to the nearest limit.
    Write {
        /// Number of the output.
        channel: Option<Channel>,
        /// Level to reach.
        level: Level,
    },
    /// `$AA6[N]`: reads the last commanded level, or the power-on level if there was no command.
    ReadLast {
        /// Number of the output.
        channel: Option<Channel>,
        /// Notation of the module.
        form: OutputForm,
    },
    /// `$AA8[N]`: reads the present level, also during a ramp.
    ReadPresent {
        /// Number of the output.
        channel: Option<Channel>,
        /// Notation of the module.
        form: OutputForm,
    },
    /// `$AA4[N]`: stores the present level as power-on level.
    StorePowerOn {
        /// Number of the output.
        channel: Option<Channel>,
    },
    /// `$AA7[N]`: reads the power-on level.
    ReadPowerOn {
        /// Number of the output.
        channel: Option<Channel>,
        /// Notation of the module.
        form: OutputForm,
    },
    /// `~AA5[N]`: stores the present level as safe level.
    StoreSafe {
        /// Number of the output.
        channel: Option<Channel>,
    },
    /// `~AA4[N]`: reads the safe level.
    ReadSafe {
        /// Number of the output.
        channel: Option<Channel>,
        /// Notation of the module.
        form: OutputForm,
    },
    /// `$AA9N` of the 7022: reads range and slew rate of a channel.
    ReadChannelConfig {
        /// Number of the output.
        channel: Channel,
    },
    /// `$AA9NTS` of the 7022: sets range and slew rate of a channel.
    WriteChannelConfig {
        /// Number of the output.
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

    pub(super) fn table(&self) -> (Effect, Shape) {
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

/// Returns the type code of a 7022 channel from its last digit.
pub(super) fn output_range(digit: u8) -> TypeCode {
    TypeCode(0x30 | digit)
}
