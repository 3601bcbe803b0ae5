//! The two 32-bit counters of a 7080, each with its own gate input.

use super::command::Effect::{self, Act, Output, Read, Store};
use super::request::Request;
use super::shape::Shape;
use super::{Address, Channel, UpTo};
use std::fmt;

/// Gate level at which the counters count; both counters share the setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GateMode {
    /// Counts while the gate is low.
    Low,
    /// Counts while the gate is high.
    High,
    /// Counts always.
    None,
}

/// Input circuits of the two counters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputMode {
    /// Both counters TTL, not isolated.
    BothTtl,
    /// Both counters through opto-couplers.
    BothIsolated,
    /// Counter 0 TTL, counter 1 isolated.
    Isolated1,
    /// Counter 0 isolated, counter 1 TTL.
    Isolated0,
}

/// Signal level, high or low, to which a pulse width or a TTL threshold applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// `H`: the high level.
    High,
    /// `L`: the low level.
    Low,
}

impl Edge {
    fn letter(self) -> &'static [u8] {
        match self {
            Self::High => b"H",
            Self::Low => b"L",
        }
    }
}

/// Behaviour of the alarm in mode 1, which has two limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlarmKind {
    /// `L`: the alarm stays until it is cleared.
    Latched,
    /// `M`: the alarm ends with its cause.
    Momentary,
}

/// Alarm mode: what the alarms of a 7080 watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlarmMode {
    /// Mode 0: one limit for each counter.
    PerCounter,
    /// Mode 1: two limits, high and high-high, for counter 0.
    HighHigh,
}

/// Alarms that are on, from field S of the reply to `@AADI`; the alarm mode decides what S means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alarms {
    /// Mode 0: true for each counter whose alarm is on, counter 0 first.
    PerCounter([bool; 2]),
    /// Mode 1: how the alarm of counter 0 behaves; `None` when it is off.
    HighHigh(Option<AlarmKind>),
}

/// Reply to `@AADI`: alarms of the counters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AlarmState {
    /// Alarms that are on.
    pub alarms: Alarms,
    /// States of the two open-collector outputs, bit n = output n.
    pub outputs: u8,
}

/// Commands of the 7080. A reply with a count carries no address: only its first character, length and hex digits can
/// be checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counter {
    /// `#AAN` of a module with type code 50: reads the count.
    Read(UpTo<1>),
    /// `#AAN` of a module with type code 51: reads the frequency, Hz, which the module updates once per gate time (0.1
    /// or 1 s).
    ReadFrequency(UpTo<1>),
    /// `$AA6N`: sets the count to the preset and clears the overflow.
    Reset(UpTo<1>),
    /// `$AA7N`: reads whether the counter has passed its maximum.
    ReadOverflow(UpTo<1>),
    /// `$AA5N`: reads whether the counter is running.
    ReadRunning(UpTo<1>),
    /// `$AA5NS`: starts (true) or stops (false) a counter.
    Run(UpTo<1>, bool),
    /// `@AAGN`: reads the preset of a counter.
    ReadPreset(UpTo<1>),
    /// `@AAPN(data)`: sets the preset of a counter.
    WritePreset(UpTo<1>, u32),
    /// `$AA3N`: reads the maximum of a counter.
    ReadMaximum(UpTo<1>),
    /// `$AA3N(data)`: sets the maximum of a counter.
    WriteMaximum(UpTo<1>, u32),
    /// `$AAA`: reads the gate mode.
    ReadGate,
    /// `$AAAG`: sets the gate mode.
    WriteGate(GateMode),
    /// `$AAB`: reads the input mode.
    ReadInputs,
    /// `$AABS`: sets the input mode.
    WriteInputs(InputMode),
    /// `$AA4`: reads whether the digital filter is on.
    ReadFilter,
    /// `$AA4S`: switches the digital filter on (true) or off.
    WriteFilter(bool),
    /// `$AA0H`, `$AA0L`: reads the least pulse width that passes the filter, microseconds.
    ReadFilterWidth(Edge),
    /// `$AA0H(data)`, `$AA0L(data)`: sets the least pulse width, 2 to 65535 microseconds.
    WriteFilterWidth(Edge, u16),
    /// `$AA1H`, `$AA1L`: reads the TTL threshold, tenths of a volt.
    ReadThreshold(Edge),
    /// `$AA1H(data)`, `$AA1L(data)`: sets the TTL threshold, tenths of a volt; the high one must stay above the low
    /// one.
    WriteThreshold(Edge, UpTo<50>),
    /// `@AADI` of a module in this alarm mode: reads which alarms and outputs are on.
    ReadAlarm(AlarmMode),
    /// `~AAA`: reads the alarm mode. No manual has this command, but a library of the vendor sends it.
    ReadAlarmMode,
    /// `~AAAS`: sets the alarm mode.
    WriteAlarmMode(AlarmMode),
    /// `@AAEAT`, mode 1: enables the alarm.
    EnableAlarm(AlarmKind),
    /// `@AADA`, mode 1: disables the alarm.
    DisableAlarm,
    /// `@AACA`, mode 1: clears a latched alarm.
    ClearAlarm,
    /// `@AAEAN`, mode 0: enables the alarm of one counter.
    EnableAlarmOf(UpTo<1>),
    /// `@AADAN`, mode 0: disables the alarm of one counter.
    DisableAlarmOf(UpTo<1>),
    /// `@AARP`, `@AARA`: reads alarm limit 0 or 1: in mode 0 the limit of counter 0 or 1, in mode 1 the high or the
    /// high-high limit of counter 0.
    ReadLimit(UpTo<1>),
    /// `@AAPA(data)`, `@AASA(data)`: sets an alarm limit, numbered as in [`Counter::ReadLimit`].
    WriteLimit(UpTo<1>, u32),
    /// `@AADO0D`: sets the two outputs; refused while an alarm controls them.
    WriteOutputs(UpTo<3>),
    /// `$AA8` of the 7080D: reads the source of the displayed number.
    ReadDisplay,
    /// `$AA8V` of the 7080D: selects the source of the displayed number: 0 or 1 a counter, 2 the number that the host
    /// sets.
    WriteDisplay(Channel),
    /// `$AA9(data)` of the 7080D: sets the number for the display.
    WriteDisplayed(DisplayNumber),
}

/// Number on the display of a 7080D: five digits and a point after one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DisplayNumber {
    digits: u32,
    places: UpTo<4>,
}

impl DisplayNumber {
    /// Creates the number `digits` / 10^`places`; returns `None` for more than five digits.
    pub const fn new(digits: u32, places: UpTo<4>) -> Option<Self> {
        if digits <= 99_999 {
            Some(Self { digits, places })
        } else {
            None
        }
    }

    /// Parses five digits and a point after one of them: `0.0000` to `99999.`.
    pub(super) fn parse(text: &[u8]) -> Option<Self> {
        let point = text.iter().position(|byte| *byte == b'.')?;
        let digits = [&text[..point], &text[point + 1..]].concat();
        let is_number = digits.len() == 5 && digits.iter().all(u8::is_ascii_digit);
        let number = std::str::from_utf8(&digits).ok().filter(|_| is_number);
        Self::new(number?.parse().ok()?, UpTo::new((5 - point) as u8)?)
    }
}

impl fmt::Display for DisplayNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = 10u32.pow(u32::from(self.places.get()));
        let (whole, part) = (self.digits / unit, self.digits % unit);
        let places = usize::from(self.places.get());
        match places {
            0 => write!(f, "{whole:05}."),
            _ => write!(f, "{whole:0width$}.{part:0places$}", width = 5 - places),
        }
    }
}

impl Counter {
    pub(super) fn encode(self, to: Address, request: &mut Request<'_>) {
        match self {
            Self::Read(n) | Self::ReadFrequency(n) => request.to(b'#', to).digit(n),
            Self::Reset(n) => request.to(b'$', to).text(b"6").digit(n),
            Self::ReadOverflow(n) => request.to(b'$', to).text(b"7").digit(n),
            Self::ReadRunning(n) => request.to(b'$', to).text(b"5").digit(n),
            Self::Run(n, run) => request.to(b'$', to).text(b"5").digit(n).flag(run),
            Self::ReadPreset(n) => request.to(b'@', to).text(b"G").digit(n),
            Self::WritePreset(n, value) => request.to(b'@', to).text(b"P").digit(n).hex(value, 8),
            Self::ReadMaximum(n) => request.to(b'$', to).text(b"3").digit(n),
            Self::WriteMaximum(n, value) => request.to(b'$', to).text(b"3").digit(n).hex(value, 8),
            Self::ReadGate => request.to(b'$', to).text(b"A"),
            Self::WriteGate(mode) => request.to(b'$', to).text(b"A").hex(mode.code(), 1),
            Self::ReadInputs => request.to(b'$', to).text(b"B"),
            Self::WriteInputs(mode) => request.to(b'$', to).text(b"B").hex(mode.code(), 1),
            Self::ReadFilter => request.to(b'$', to).text(b"4"),
            Self::WriteFilter(on) => request.to(b'$', to).text(b"4").flag(on),
            Self::ReadFilterWidth(side) => request.to(b'$', to).text(b"0").text(side.letter()),
            Self::WriteFilterWidth(side, width_us) => request
                .to(b'$', to)
                .text(b"0")
                .text(side.letter())
                .decimal(u32::from(width_us), 5),
            Self::ReadThreshold(side) => request.to(b'$', to).text(b"1").text(side.letter()),
            Self::WriteThreshold(side, tenths) => request
                .to(b'$', to)
                .text(b"1")
                .text(side.letter())
                .decimal(u32::from(tenths.get()), 2),
            Self::ReadAlarm(_) => request.to(b'@', to).text(b"DI"),
            Self::ReadAlarmMode => request.to(b'~', to).text(b"A"),
            Self::WriteAlarmMode(mode) => request
                .to(b'~', to)
                .text(b"A")
                .flag(mode == AlarmMode::HighHigh),
            Self::EnableAlarm(AlarmKind::Latched) => request.to(b'@', to).text(b"EAL"),
            Self::EnableAlarm(AlarmKind::Momentary) => request.to(b'@', to).text(b"EAM"),
            Self::DisableAlarm => request.to(b'@', to).text(b"DA"),
            Self::ClearAlarm => request.to(b'@', to).text(b"CA"),
            Self::EnableAlarmOf(n) => request.to(b'@', to).text(b"EA").digit(n),
            Self::DisableAlarmOf(n) => request.to(b'@', to).text(b"DA").digit(n),
            Self::ReadLimit(n) => request
                .to(b'@', to)
                .text([b"RP", b"RA"][usize::from(n.get())]),
            Self::WriteLimit(n, value) => request
                .to(b'@', to)
                .text([b"PA", b"SA"][usize::from(n.get())])
                .hex(value, 8),
            Self::WriteOutputs(outputs) => request.to(b'@', to).text(b"DO0").digit(outputs),
            Self::ReadDisplay => request.to(b'$', to).text(b"8"),
            Self::WriteDisplay(what) => request.to(b'$', to).text(b"8").digit(what),
            Self::WriteDisplayed(number) => request
                .to(b'$', to)
                .text(b"9")
                .text(number.to_string().as_bytes()),
        };
    }

    pub(super) fn table(&self) -> (Effect, Shape) {
        match *self {
            Self::Read(_) => (Read, Shape::Count),
            Self::ReadFrequency(_) => (Read, Shape::Frequency),
            Self::ReadOverflow(_) | Self::ReadRunning(_) | Self::ReadFilter => (Read, Shape::Flag),
            Self::ReadPreset(_) | Self::ReadMaximum(_) | Self::ReadLimit(_) => {
                (Read, Shape::Setting32)
            }
            Self::ReadGate => (Read, Shape::Gate),
            Self::ReadInputs => (Read, Shape::Inputs),
            Self::ReadFilterWidth(_) => (
                Read,
                Shape::Decimal {
                    digits: 5,
                    max: 65_535,
                },
            ),
            Self::ReadThreshold(_) => (Read, Shape::Decimal { digits: 2, max: 50 }),
            Self::ReadAlarm(mode) => (Read, Shape::Alarm(mode)),
            Self::ReadAlarmMode => (Read, Shape::AlarmMode),
            Self::ReadDisplay => (Read, Shape::Decimal { digits: 1, max: 2 }),
            Self::Reset(_) | Self::Run(..) | Self::ClearAlarm | Self::WriteDisplayed(_) => {
                (Act, Shape::Accepted)
            }
            Self::WriteOutputs(_) => (Output, Shape::Accepted),
            Self::WritePreset(..)
            | Self::WriteMaximum(..)
            | Self::WriteGate(_)
            | Self::WriteInputs(_)
            | Self::WriteFilter(_)
            | Self::WriteFilterWidth(..)
            | Self::WriteThreshold(..)
            | Self::WriteAlarmMode(_)
            | Self::EnableAlarm(_)
            | Self::DisableAlarm
            | Self::EnableAlarmOf(_)
            | Self::DisableAlarmOf(_)
            | Self::WriteLimit(..)
            | Self::WriteDisplay(_) => (Store, Shape::Accepted),
        }
    }
}

impl GateMode {
    fn code(self) -> u32 {
        match self {
            Self::Low => 0,
            Self::High => 1,
            Self::None => 2,
        }
    }

    pub(super) fn from_code(code: u32) -> Option<Self> {
        [Self::Low, Self::High, Self::None]
            .into_iter()
            .find(|mode| mode.code() == code)
    }
}

impl InputMode {
    fn code(self) -> u32 {
        match self {
            Self::BothTtl => 0,
            Self::BothIsolated => 1,
            Self::Isolated1 => 2,
            Self::Isolated0 => 3,
        }
    }

    pub(super) fn from_code(code: u32) -> Option<Self> {
        [
            Self::BothTtl,
            Self::BothIsolated,
            Self::Isolated1,
            Self::Isolated0,
        ]
        .into_iter()
        .find(|mode| mode.code() == code)
    }
}
