//! Determines whether a module already has the setting that a command would write. An EEPROM endures a limited number
//! of writes, so the host first reads the setting ([`Command::setting`]) and writes it only if it differs
//! ([`Command::is_in_effect`]).
//!
//! Two kinds of settings cannot be compared, so the host always writes them:
//!
//! - Stored outputs. A comparison needs the stored and the present pattern; which half of the present one belongs to
//!   outputs depends on the model, which the request does not name.
//! - The alarm mode of a 7080, and its alarms when a command switches them on. The meaning of the reply to `@AADI`
//!   depends on the mode, and no manual has the command that reads the mode. Only the digit for all alarms off is the
//!   same in both modes.

use super::{
    AlarmMode, Alarms, AnalogIn, AnalogOut, Command, Common, Config, Counter, FormatByte, Reply,
    TypeCode,
};

/// Bit of the watchdog status that says that the watchdog has tripped.
const TRIPPED: u8 = 0x04;
/// Low bits of FF in which some digital modules return a code of their model, whatever was written.
const MODEL_BITS: u8 = 0x07;

impl Command {
    /// Returns the command that reads the setting which this command writes; `None` when this command writes none, or
    /// when no reply shows the setting.
    pub fn setting(&self) -> Option<Self> {
        match *self {
            Self::HostOk | Self::SampleAll | Self::Digital(..) => None,
            Self::Common(to, ask) => common(ask).map(|read| read.to(to)),
            Self::AnalogIn(to, ask) => analog_in(ask).map(|read| read.to(to)),
            Self::AnalogOut(to, ask) => analog_out(ask).map(|read| read.to(to)),
            Self::Counter(to, ask) => counter(ask).map(|read| read.to(to)),
        }
    }

    /// Returns true when `found`, the reply to [`Command::setting`], shows that writing would change nothing.
    pub fn is_in_effect(&self, found: &Reply) -> bool {
        match (*self, *found) {
            (Self::Common(_, ask), found) => is_common_in_effect(ask, found),
            (Self::AnalogIn(_, AnalogIn::WriteMask(mask)), Reply::Byte(found)) => mask == found,
            (
                Self::AnalogIn(_, AnalogIn::WriteChannelRange { range, .. }),
                Reply::ChannelRange { range: found, .. },
            ) => range == found,
            (
                Self::AnalogOut(_, AnalogOut::WriteChannelConfig { range, slew, .. }),
                Reply::OutputChannel {
                    range: found,
                    slew: found_slew,
                },
            ) => found.0 & 0xF == range.get() && found_slew == slew,
            (Self::Counter(_, ask), found) => is_counter_in_effect(ask, found),
            (_, _) => false,
        }
    }
}

fn common(ask: Common) -> Option<Common> {
    match ask {
        Common::WriteConfig { .. } => Some(Common::ReadConfig),
        Common::WriteName(_) => Some(Common::ReadName),
        Common::ClearWatchdogStatus => Some(Common::ReadWatchdogStatus),
        Common::WriteWatchdog { .. } => Some(Common::ReadWatchdog),
        Common::WriteResponseDelay { .. } => Some(Common::ReadResponseDelay),
        Common::WriteProtocol { .. } => Some(Common::ReadProtocol),
        Common::ReadConfig
        | Common::ReadResetStatus
        | Common::ReadFirmware
        | Common::ReadName
        | Common::ReadInitPin
        | Common::ReadWatchdogStatus
        | Common::ReadWatchdog
        | Common::ReadResponseDelay
        | Common::ReadProtocol
        | Common::EnterSoftInit
        | Common::OpenSoftInit { .. } => None,
    }
}

fn is_common_in_effect(ask: Common, found: Reply) -> bool {
    match (ask, found) {
        (
            Common::WriteConfig { address, config },
            Reply::Config {
                address: found,
                config: set,
            },
        ) => address == found && settings_of(config) == settings_of(set),
        (Common::WriteName(name), Reply::Text(found)) => {
            name.as_bytes() == found.as_str().as_bytes()
        }
        (Common::ClearWatchdogStatus, Reply::Byte(status)) => status & TRIPPED == 0,
        (
            Common::WriteWatchdog {
                enabled,
                timeout_tenths,
            },
            Reply::Watchdog {
                enabled: found,
                timeout_tenths: found_tenths,
            },
        ) => found == Some(enabled) && found_tenths == timeout_tenths,
        (Common::WriteResponseDelay { delay_ms }, Reply::Byte(found)) => delay_ms.get() == found,
        (Common::WriteProtocol { modbus }, Reply::Flag(found)) => modbus == found,
        (_, _) => false,
    }
}

/// Returns the settings in a configuration word, without the code of the model that it may contain.
fn settings_of(config: Config) -> Config {
    let FormatByte(format) = config.format;
    let format = match config.type_code {
        TypeCode::DIGITAL => format & !MODEL_BITS,
        _ => format,
    };
    Config {
        format: FormatByte(format),
        ..config
    }
}

fn analog_in(ask: AnalogIn) -> Option<AnalogIn> {
    match ask {
        AnalogIn::WriteMask(_) => Some(AnalogIn::ReadMask),
        AnalogIn::WriteChannelRange { channel, .. } => Some(AnalogIn::ReadChannelRange { channel }),
        AnalogIn::ReadAll(_)
        | AnalogIn::ReadOne { .. }
        | AnalogIn::ReadAllHex(_)
        | AnalogIn::ReadMask
        | AnalogIn::ReadColdJunction
        | AnalogIn::ReadDiagnosis
        | AnalogIn::ReadChannelRange { .. } => None,
    }
}

fn analog_out(ask: AnalogOut) -> Option<AnalogOut> {
    match ask {
        AnalogOut::WriteChannelConfig { channel, .. } => {
            Some(AnalogOut::ReadChannelConfig { channel })
        }
        AnalogOut::Write { .. }
        | AnalogOut::ReadLast { .. }
        | AnalogOut::ReadPresent { .. }
        | AnalogOut::StorePowerOn { .. }
        | AnalogOut::ReadPowerOn { .. }
        | AnalogOut::StoreSafe { .. }
        | AnalogOut::ReadSafe { .. }
        | AnalogOut::ReadChannelConfig { .. } => None,
    }
}

fn counter(ask: Counter) -> Option<Counter> {
    match ask {
        Counter::WritePreset(n, _) => Some(Counter::ReadPreset(n)),
        Counter::WriteMaximum(n, _) => Some(Counter::ReadMaximum(n)),
        Counter::WriteGate(_) => Some(Counter::ReadGate),
        Counter::WriteInputs(_) => Some(Counter::ReadInputs),
        Counter::WriteFilter(_) => Some(Counter::ReadFilter),
        Counter::WriteFilterWidth(side, _) => Some(Counter::ReadFilterWidth(side)),
        Counter::WriteThreshold(side, _) => Some(Counter::ReadThreshold(side)),
        Counter::WriteLimit(n, _) => Some(Counter::ReadLimit(n)),
        Counter::WriteDisplay(_) => Some(Counter::ReadDisplay),
        // Reads as in mode 0, whose decoding accepts every digit that a module sends in either mode; 0 means off in
        // both.
        Counter::DisableAlarm | Counter::DisableAlarmOf(_) => {
            Some(Counter::ReadAlarm(AlarmMode::PerCounter))
        }
        Counter::Read(_)
        | Counter::ReadFrequency(_)
        | Counter::Reset(_)
        | Counter::ReadOverflow(_)
        | Counter::ReadRunning(_)
        | Counter::Run(..)
        | Counter::ReadPreset(_)
        | Counter::ReadMaximum(_)
        | Counter::ReadGate
        | Counter::ReadInputs
        | Counter::ReadFilter
        | Counter::ReadFilterWidth(_)
        | Counter::ReadThreshold(_)
        | Counter::ReadAlarm(_)
        | Counter::ReadAlarmMode
        | Counter::WriteAlarmMode(_)
        | Counter::EnableAlarm(_)
        | Counter::ClearAlarm
        | Counter::EnableAlarmOf(_)
        | Counter::ReadLimit(_)
        | Counter::WriteOutputs(_)
        | Counter::ReadDisplay
        | Counter::WriteDisplayed(_) => None,
    }
}

fn is_counter_in_effect(ask: Counter, found: Reply) -> bool {
    match (ask, found) {
        (
            Counter::WritePreset(_, value)
            | Counter::WriteMaximum(_, value)
            | Counter::WriteLimit(_, value),
            Reply::Count(found),
        ) => value == found,
        (Counter::WriteGate(mode), Reply::Gate(found)) => mode == found,
        (Counter::WriteInputs(mode), Reply::Inputs(found)) => mode == found,
        (Counter::WriteFilter(on), Reply::Flag(found)) => on == found,
        (Counter::WriteFilterWidth(_, width_us), Reply::Decimal(found)) => {
            u32::from(width_us) == found
        }
        (Counter::WriteThreshold(_, tenths), Reply::Decimal(found)) => {
            u32::from(tenths.get()) == found
        }
        (Counter::DisableAlarm | Counter::DisableAlarmOf(_), Reply::Alarm(found)) => {
            found.alarms == Alarms::PerCounter([false, false])
        }
        (Counter::WriteDisplay(what), Reply::Decimal(found)) => u32::from(what.get()) == found,
        (_, _) => false,
    }
}
