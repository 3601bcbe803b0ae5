//! Forms of replies: lead, lengths, fields. The tables of the families refer to these forms.

use super::analog_out::output_range;
use super::command::Effect;
use super::fields::Fields;
use super::reading::width;
use super::{
    Address, AlarmKind, AlarmMode, AlarmState, Alarms, BaudCode, Bits, Channel, Config, FormatByte,
    GateMode, InputForm, InputMode, Level, OutputForm, Reading, Readings, Reply, ReplyError,
    SlewCode, Text, TypeCode, UpTo,
};

/// Form of a valid reply. Below, AA is the address in the request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// `!AA`
    Accepted,
    /// `!NN`, the new address
    AcceptedAs(Address),
    /// `>`
    Output,
    /// `!AATTCCFF`
    Config,
    /// `!AA(text)`
    Text,
    /// `!AA0` or `!AA1`
    Flag,
    /// `!AAhh`
    Byte,
    /// `!AA` and decimal digits
    Decimal { digits: u8, max: u16 },
    /// `!AAEVV`, or `!AAVV` from some firmware
    Watchdog,
    /// `!ffss00`, no address
    Bits,
    /// `>ffss`
    PortBits,
    /// `!Sffss00`, no address
    Sampled,
    /// `!ffss00`, or `!AAffss00` from some firmware
    Latched,
    /// `!AAVV00` or `!AAVVVV`
    StoredBits,
    /// `!AAddddd`
    Events,
    /// `>hhhhhhhh`
    Count,
    /// `>hhhhhhhh`, Hz
    Frequency,
    /// `!AAhhhhhhhh`
    Setting32,
    /// `!AAG`
    Gate,
    /// `!AAS`
    Inputs,
    /// `!AAS0D00`
    Alarm(AlarmMode),
    /// `!AA0` or `!AA1`
    AlarmMode,
    /// `>` and one field
    Reading(InputForm),
    /// `>` and one field per channel
    Readings(InputForm),
    /// `!AA(data)`
    Level(OutputForm),
    /// `!AATS`
    OutputChannel,
    /// `!AACiRrr`
    ChannelRange(Channel),
}

/// Fails when `text` is a refusal: `?AA`, or of an output command `?` or `!` alone; [`Shape::decode`] checks the lead.
pub(super) fn check_refusal(text: &[u8], to: Address, effect: Effect) -> Result<(), ReplyError> {
    let output = effect == Effect::Output;
    let mut fields = Fields::new(text);
    match (fields.lead(), text.len()) {
        (Some(b'!'), 1) if output => Err(ReplyError::Ignored),
        (Some(b'?'), 1) if output => Err(ReplyError::Refused),
        (Some(b'?'), _) => {
            fields.start(b'?', 3..=3)?;
            fields.address_is(to)?;
            Err(ReplyError::Refused)
        }
        (Some(_) | None, _) => Ok(()),
    }
}

impl Shape {
    fn lead(self) -> u8 {
        match self {
            Self::Output
            | Self::PortBits
            | Self::Count
            | Self::Frequency
            | Self::Reading(_)
            | Self::Readings(_) => b'>',
            Self::Accepted
            | Self::AcceptedAs(_)
            | Self::Config
            | Self::Text
            | Self::Flag
            | Self::Byte
            | Self::Decimal { .. }
            | Self::Watchdog
            | Self::Bits
            | Self::Sampled
            | Self::Latched
            | Self::StoredBits
            | Self::Events
            | Self::Setting32
            | Self::Gate
            | Self::Inputs
            | Self::Alarm(_)
            | Self::AlarmMode
            | Self::Level(_)
            | Self::OutputChannel
            | Self::ChannelRange(_) => b'!',
        }
    }

    /// Returns the number of characters of the longest valid reply, without checksum and CR.
    pub(super) fn longest(self) -> usize {
        match self {
            Self::Output => 1,
            Self::Accepted | Self::AcceptedAs(_) => 3,
            Self::Flag | Self::Gate | Self::Inputs | Self::AlarmMode => 4,
            Self::Byte | Self::OutputChannel | Self::PortBits => 5,
            Self::Watchdog => 6,
            Self::Bits | Self::StoredBits => 7,
            Self::Sampled | Self::Events | Self::Alarm(_) | Self::ChannelRange(_) => 8,
            Self::Config | Self::Latched | Self::Count | Self::Frequency => 9,
            Self::Setting32 => 11,
            Self::Text => 3 + Text::LONGEST,
            Self::Decimal { digits, .. } => 3 + usize::from(digits),
            Self::Reading(form) => 1 + width(form.format),
            Self::Readings(form) => 1 + width(form.format) * usize::from(form.channels()),
            Self::Level(form) => 3 + form.width(),
        }
    }

    /// Returns the number of characters of the shortest valid reply, without checksum and CR.
    fn shortest(self) -> usize {
        match self {
            Self::Text => 4,
            Self::Watchdog => 5,
            Self::Latched => 7,
            // An over-range reading may lack its sign.
            Self::Reading(form) if width(form.format) == 7 => 7,
            fixed => fixed.longest(),
        }
    }

    /// Returns true for a form of variable length: a shorter reply may be complete too, so that only a CR or a checksum
    /// proves the end.
    pub(super) fn is_open(self) -> bool {
        self.shortest() < self.longest()
    }

    /// Returns true when the address of the request follows the lead.
    fn repeats_address(self) -> bool {
        let own = matches!(
            self,
            Self::AcceptedAs(_) | Self::Config | Self::Bits | Self::Sampled | Self::Latched
        );
        self.lead() == b'!' && !own
    }

    /// Decodes `text`, a reply without checksum and CR.
    pub(super) fn decode(self, text: &[u8], expected: Address) -> Result<Reply, ReplyError> {
        let mut fields = Fields::new(text);
        fields.start(self.lead(), self.shortest()..=self.longest())?;
        if self.repeats_address() {
            fields.address_is(expected)?;
        }
        let fields = &mut fields;
        match self {
            Self::Accepted | Self::Output => Ok(Reply::Accepted),
            Self::AcceptedAs(new) => fields.address_is(new).map(|()| Reply::Accepted),
            Self::Config => config(fields, expected),
            Self::Bits | Self::PortBits | Self::Sampled | Self::Latched => {
                self.bits(fields, expected)
            }
            Self::Count | Self::Setting32 => fields.hex(8).map(Reply::Count),
            Self::Frequency => fields.hex(8).map(Reply::Frequency),
            Self::Reading(form) => {
                let width = fields.length() - 1;
                Reading::decode(form, width, fields).map(Reply::Reading)
            }
            Self::Readings(form) => Readings::decode(form, fields).map(Reply::Readings),
            Self::Flag => fields.flag().map(Reply::Flag),
            Self::Byte => fields.byte().map(Reply::Byte),
            Self::Decimal { digits, max } => fields
                .decimal(usize::from(digits), u32::from(max))
                .map(Reply::Decimal),
            Self::Watchdog => watchdog(fields),
            Self::Text => text_of(fields),
            Self::StoredBits => stored_bits(fields),
            Self::Events => Ok(Reply::Events(fields.decimal(5, 65_535)? as u16)),
            Self::Gate => code(fields, GateMode::from_code, "0 1 2").map(Reply::Gate),
            Self::Inputs => code(fields, InputMode::from_code, "0 1 2 3").map(Reply::Inputs),
            Self::Alarm(mode) => alarm(fields, mode),
            Self::AlarmMode => fields.flag().map(|both| {
                Reply::AlarmMode(if both {
                    AlarmMode::HighHigh
                } else {
                    AlarmMode::PerCounter
                })
            }),
            Self::Level(form) => Level::decode(form, fields).map(Reply::Level),
            Self::OutputChannel => output_channel(fields),
            Self::ChannelRange(channel) => channel_range(fields, channel),
        }
    }

    /// Decodes replies of digital modules that carry no address, and latches, which carry one in some firmware.
    fn bits(self, fields: &mut Fields<'_>, expected: Address) -> Result<Reply, ReplyError> {
        if self == Self::Latched && fields.length() > self.shortest() {
            fields.address_is(expected)?;
        }
        let first_read = if self == Self::Sampled {
            Some(fields.flag()?)
        } else {
            None
        };
        let bits = two_bytes(fields)?;
        if self != Self::PortBits {
            fields.filler("00")?;
        }
        fields.end()?;
        Ok(match first_read {
            Some(first_read) => Reply::Sampled { first_read, bits },
            None => Reply::Bits(bits),
        })
    }
}

fn two_bytes(fields: &mut Fields<'_>) -> Result<Bits, ReplyError> {
    Ok(Bits {
        first: fields.byte()?,
        second: fields.byte()?,
    })
}

/// Decodes a stored pattern. Modules with eight outputs send the pattern in the first byte and append 00.
fn stored_bits(fields: &mut Fields<'_>) -> Result<Reply, ReplyError> {
    two_bytes(fields).map(Reply::Bits)
}

fn config(fields: &mut Fields<'_>, expected: Address) -> Result<Reply, ReplyError> {
    let found = fields.address()?;
    // A module in INIT* mode answers at address 00 and reports its stored address.
    if found != expected && expected != Address(0) {
        return Err(ReplyError::WrongAddress { found, expected });
    }
    let type_code = TypeCode(fields.byte()?);
    let at = fields.at();
    let baud = BaudCode(fields.byte()?);
    if baud.rate().is_none() {
        return Err(ReplyError::OutOfRange { at });
    }
    let config = Config {
        type_code,
        baud,
        format: FormatByte(fields.byte()?),
    };
    Ok(Reply::Config {
        address: found,
        config,
    })
}

fn watchdog(fields: &mut Fields<'_>) -> Result<Reply, ReplyError> {
    let with_flag = fields.length() == Shape::Watchdog.longest();
    let enabled = if with_flag {
        Some(fields.flag()?)
    } else {
        None
    };
    Ok(Reply::Watchdog {
        enabled,
        timeout_tenths: fields.byte()?,
    })
}

fn text_of(fields: &mut Fields<'_>) -> Result<Reply, ReplyError> {
    Text::new(fields.rest())
        .map(Reply::Text)
        .ok_or(fields.wrong_length())
}

fn alarm(fields: &mut Fields<'_>, mode: AlarmMode) -> Result<Reply, ReplyError> {
    let at = fields.at();
    let state = fields.hex(1)?;
    let outputs = fields.byte()?;
    fields.filler("00")?;
    let alarms = match (mode, state) {
        (AlarmMode::PerCounter, 0..=3) => Alarms::PerCounter([state & 1 != 0, state & 2 != 0]),
        (AlarmMode::HighHigh, 0) => Alarms::HighHigh(None),
        (AlarmMode::HighHigh, 1) => Alarms::HighHigh(Some(AlarmKind::Momentary)),
        (AlarmMode::HighHigh, 2) => Alarms::HighHigh(Some(AlarmKind::Latched)),
        (AlarmMode::PerCounter | AlarmMode::HighHigh, _) => {
            return Err(ReplyError::OutOfRange { at });
        }
    };
    if outputs > 3 {
        return Err(ReplyError::OutOfRange { at });
    }
    Ok(Reply::Alarm(AlarmState { alarms, outputs }))
}

fn output_channel(fields: &mut Fields<'_>) -> Result<Reply, ReplyError> {
    let at = fields.at();
    let (range, slew) = (fields.hex(1)? as u8, fields.hex(1)? as u8);
    match UpTo::new(slew) {
        Some(slew) if range <= 2 => Ok(Reply::OutputChannel {
            range: output_range(range),
            slew: SlewCode(slew),
        }),
        Some(_) | None => Err(ReplyError::OutOfRange { at }),
    }
}

fn channel_range(fields: &mut Fields<'_>, channel: Channel) -> Result<Reply, ReplyError> {
    fields.filler("C")?;
    let at = fields.at();
    if fields.hex(1)? != u32::from(channel.get()) {
        return Err(ReplyError::OutOfRange { at });
    }
    fields.filler("R")?;
    Ok(Reply::ChannelRange {
        channel,
        range: TypeCode(fields.byte()?),
    })
}

fn code<T>(
    fields: &mut Fields<'_>,
    known: fn(u32) -> Option<T>,
    expected: &'static str,
) -> Result<T, ReplyError> {
    let at = fields.at();
    known(fields.hex(1)?).ok_or(ReplyError::BadField { at, expected })
}
