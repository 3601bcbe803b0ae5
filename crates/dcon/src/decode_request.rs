//! Parses a request, as it is on the wire from first to last character, back into commands.
//!
//! The same characters mean different things to different modules (`$016` reads a channel mask, a level or sixteen
//! bits), so that one request may fit several commands; a list per family gives the candidates. A request does not
//! state a range, so numbers stay in their notation.

use super::frame::{hex_digit, hex_number};
use super::{
    Address, AlarmKind, AlarmMode, AnalogIn, AnalogOut, BaudCode, Channel, Command, Common, Config,
    Counter, DataFormat, Digital, DisplayNumber, Edge, FormatByte, GateMode, GroupWrite, InputForm,
    InputMode, Level, ModuleName, OutputForm, OutputWord, SlewCode, Stored, TypeCode, UpTo, Width,
};

/// A type code that no module has; readings decoded with it are not checked against a range.
const UNKNOWN: TypeCode = TypeCode(0xFF);

/// Numbers of inputs that analog modules have; the decoder tries each, because a request does not name its model.
const INPUTS: [u8; 4] = [8, 6, 3, 1];

const NOTATIONS: [DataFormat; 3] = [
    DataFormat::Engineering,
    DataFormat::Percent,
    DataFormat::Hex,
];

const OUTPUT_FORMS: [OutputForm; 5] = [
    OutputForm::Engineering,
    OutputForm::EngineeringSigned,
    OutputForm::Percent,
    OutputForm::Hex12,
    OutputForm::Hex16,
];

/// Returns every command that encodes to `request`, which has neither checksum nor CR.
pub fn decode_request(request: &[u8]) -> Vec<Command> {
    let canonical = canonical(request);
    let request = canonical.as_deref().unwrap_or(request);
    let addressed = match request {
        b"~**" => return vec![Command::HostOk],
        b"#**" => return vec![Command::SampleAll],
        [_, high, low, rest @ ..] => byte(&[*high, *low]).map(|to| (Address(to), rest)),
        _ => None,
    };
    let Some((to, rest)) = addressed else {
        return Vec::new();
    };
    let mut found = Vec::new();
    found.extend(common(rest).into_iter().map(|ask| ask.to(to)));
    found.extend(analog_in(rest).into_iter().map(|ask| ask.to(to)));
    found.extend(analog_out(rest).into_iter().map(|ask| ask.to(to)));
    found.extend(digital(rest).into_iter().map(|ask| ask.to(to)));
    found.extend(counter(rest).into_iter().map(|ask| ask.to(to)));
    // Encoding each candidate again checks the first character and everything that the lists accept too freely.
    let mut encoded = Vec::with_capacity(24);
    found.retain(|command| {
        encoded.clear();
        command.encode(false, &mut encoded);
        encoded.strip_suffix(b"\r") == Some(request)
    });
    found
}

/// Rewrites `#AABBDD` in the spelling that [`Command::encode`] uses: BB = 0A (group A) as 00, Ac (output c of group A)
/// as 1c.
fn canonical(request: &[u8]) -> Option<Vec<u8>> {
    let (place, digit) = match request {
        [b'#', _, _, b'0', b'A', _, _] => (4, b'0'),
        [b'#', _, _, b'A', b'0'..=b'7', _, _] => (3, b'1'),
        _ => return None,
    };
    let mut canonical = request.to_vec();
    canonical[place] = digit;
    Some(canonical)
}

fn byte(text: &[u8]) -> Option<u8> {
    let value = hex_number(text).filter(|_| text.len() == 2);
    value.map(|value| value as u8)
}

fn digit<const MAX: u8>(byte: u8) -> Option<UpTo<MAX>> {
    UpTo::new(hex_digit(byte)?)
}

fn decimal(text: &[u8]) -> Option<u32> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

fn common(rest: &[u8]) -> Vec<Common> {
    let fixed = [
        Common::ReadConfig,
        Common::ReadResetStatus,
        Common::ReadFirmware,
        Common::ReadName,
        Common::ReadInitPin,
        Common::ReadProtocol,
        Common::WriteProtocol { modbus: false },
        Common::WriteProtocol { modbus: true },
        Common::ReadWatchdogStatus,
        Common::ClearWatchdogStatus,
        Common::ReadWatchdog,
        Common::ReadResponseDelay,
        Common::EnterSoftInit,
    ];
    let with_data = match rest {
        [b'3', flag, time @ ..] => byte(time).map(|timeout_tenths| Common::WriteWatchdog {
            enabled: *flag == b'1',
            timeout_tenths,
        }),
        [b'R', b'D', delay @ ..] => byte(delay)
            .and_then(UpTo::new)
            .map(|delay_ms| Common::WriteResponseDelay { delay_ms }),
        [b'T', time @ ..] => byte(time)
            .and_then(UpTo::new)
            .map(|seconds| Common::OpenSoftInit { seconds }),
        [b'O', name @ ..] => std::str::from_utf8(name)
            .ok()
            .and_then(ModuleName::new)
            .map(Common::WriteName),
        _ => None,
    };
    let config = hex_number(rest).filter(|_| rest.len() == 8).map(|word| {
        let [address, type_code, baud, format] = word.to_be_bytes();
        Common::WriteConfig {
            address: Address(address),
            config: Config {
                type_code: TypeCode(type_code),
                baud: BaudCode(baud),
                format: FormatByte(format),
            },
        }
    });
    fixed.into_iter().chain(with_data).chain(config).collect()
}

fn analog_in(rest: &[u8]) -> Vec<AnalogIn> {
    let mut found = vec![
        AnalogIn::ReadMask,
        AnalogIn::ReadColdJunction,
        AnalogIn::ReadDiagnosis,
    ];
    for inputs in INPUTS {
        let form = |format| InputForm::new(inputs, format, UNKNOWN);
        found.extend(
            NOTATIONS
                .into_iter()
                .filter_map(form)
                .map(AnalogIn::ReadAll),
        );
        found.extend(form(DataFormat::Hex).map(AnalogIn::ReadAllHex));
    }
    match rest {
        [n] => {
            if let Some(channel) = digit(*n) {
                let one = |form| AnalogIn::ReadOne { channel, form };
                found.extend(NOTATIONS.map(|format| one(InputForm::eight(format, UNKNOWN))));
            }
        }
        [b'5', mask @ ..] => found.extend(byte(mask).map(AnalogIn::WriteMask)),
        [b'8', b'C', n] => {
            found.extend(digit(*n).map(|channel| AnalogIn::ReadChannelRange { channel }));
        }
        [b'7', b'C', n, b'R', range @ ..] => {
            let range = byte(range).map(TypeCode);
            let both = digit(*n).zip(range);
            found.extend(
                both.map(|(channel, range)| AnalogIn::WriteChannelRange { channel, range }),
            );
        }
        _ => {}
    }
    found
}

fn analog_out(rest: &[u8]) -> Vec<AnalogOut> {
    let mut found = Vec::new();
    let channel: Option<Channel> = rest.get(1).and_then(|n| digit(*n));
    let channel = channel.filter(|_| rest.len() == 2);
    for form in OUTPUT_FORMS {
        found.push(AnalogOut::ReadLast { channel, form });
        found.push(AnalogOut::ReadPresent { channel, form });
        found.push(AnalogOut::ReadPowerOn { channel, form });
        found.push(AnalogOut::ReadSafe { channel, form });
        if let Some(level) = Level::read(form, rest) {
            let channel = None;
            found.push(AnalogOut::Write { channel, level });
        }
        if let [n, data @ ..] = rest
            && let (Some(channel), Some(level)) = (digit(*n), Level::read(form, data))
        {
            let channel = Some(channel);
            found.push(AnalogOut::Write { channel, level });
        }
    }
    found.push(AnalogOut::StorePowerOn { channel });
    found.push(AnalogOut::StoreSafe { channel });
    found.extend(channel.map(|channel| AnalogOut::ReadChannelConfig { channel }));
    if let [b'9', n, range, slew] = rest
        && let (Some(channel), Some(range), Some(slew)) = (digit(*n), digit(*range), digit(*slew))
    {
        let slew = SlewCode(slew);
        found.push(AnalogOut::WriteChannelConfig {
            channel,
            range,
            slew,
        });
    }
    found
}

fn digital(rest: &[u8]) -> Vec<Digital> {
    let mut found = vec![
        Digital::ReadAll,
        Digital::ReadPort,
        Digital::ReadLatched { high: true },
        Digital::ReadLatched { high: false },
        Digital::ClearLatched,
        Digital::ReadSampled,
        Digital::ReadStored(Stored::PowerOn),
        Digital::ReadStored(Stored::Safe),
        Digital::Store(Stored::PowerOn),
        Digital::Store(Stored::Safe),
    ];
    let width = match rest.len() {
        1 => Some(Width::One),
        2 => Some(Width::Two),
        4 => Some(Width::Four),
        _ => None,
    };
    let bits = hex_number(rest).and_then(|bits| u16::try_from(bits).ok());
    let word = width
        .zip(bits)
        .and_then(|(width, bits)| OutputWord::new(width, bits));
    found.extend(word.map(Digital::Write));
    match rest {
        [n] => found.extend(digit(*n).map(|channel| Digital::ReadEvents { channel })),
        [b'C', n] => found.extend(digit(*n).map(|channel| Digital::ClearEvents { channel })),
        [group @ (b'0' | b'1' | b'B'), n, data @ ..] if data.len() == 2 => {
            found.extend(
                byte(data)
                    .and_then(|data| group_write(*group, *n, data))
                    .map(Digital::WriteGroup),
            );
        }
        _ => {}
    }
    found
}

fn group_write(group: u8, n: u8, data: u8) -> Option<GroupWrite> {
    let on = data == 1;
    match (group, n) {
        (b'0', b'0') => Some(GroupWrite::GroupA(data)),
        (b'0', b'B') => Some(GroupWrite::GroupB(data)),
        (b'1', _) => digit(n).map(|output| GroupWrite::OneOfA { output, on }),
        (b'B', _) => digit(n).map(|output| GroupWrite::OneOfB { output, on }),
        _ => None,
    }
}

fn counter(rest: &[u8]) -> Vec<Counter> {
    let mut found = vec![
        Counter::ReadGate,
        Counter::ReadInputs,
        Counter::ReadFilter,
        Counter::ReadAlarm(AlarmMode::PerCounter),
        Counter::ReadAlarm(AlarmMode::HighHigh),
        Counter::ReadAlarmMode,
        Counter::WriteAlarmMode(AlarmMode::PerCounter),
        Counter::WriteAlarmMode(AlarmMode::HighHigh),
        Counter::WriteFilter(true),
        Counter::WriteFilter(false),
        Counter::DisableAlarm,
        Counter::ClearAlarm,
        Counter::ReadDisplay,
        Counter::EnableAlarm(AlarmKind::Latched),
        Counter::EnableAlarm(AlarmKind::Momentary),
    ];
    let shown = rest.get(1..).and_then(DisplayNumber::parse);
    found.extend(shown.map(Counter::WriteDisplayed));
    for side in [Edge::High, Edge::Low] {
        found.extend([Counter::ReadFilterWidth(side), Counter::ReadThreshold(side)]);
        let data = decimal(rest.get(2..).unwrap_or_default());
        let width = data.and_then(|data| u16::try_from(data).ok());
        found.extend(width.map(|width| Counter::WriteFilterWidth(side, width)));
        let tenths = data.and_then(|data| UpTo::new(u8::try_from(data).ok()?));
        found.extend(tenths.map(|tenths| Counter::WriteThreshold(side, tenths)));
    }
    for n in (0..=1).filter_map(UpTo::new) {
        found.extend(of_one(n, rest));
    }
    let last = rest.last().copied();
    found.extend(last.and_then(digit).map(Counter::WriteOutputs));
    found.extend(last.and_then(digit).map(Counter::WriteDisplay));
    let mode = last.and_then(hex_digit).map(u32::from);
    found.extend(mode.and_then(GateMode::from_code).map(Counter::WriteGate));
    found.extend(
        mode.and_then(InputMode::from_code)
            .map(Counter::WriteInputs),
    );
    found
}

fn of_one(n: UpTo<1>, rest: &[u8]) -> Vec<Counter> {
    let mut found = vec![
        Counter::Read(n),
        Counter::ReadFrequency(n),
        Counter::Reset(n),
        Counter::ReadOverflow(n),
        Counter::ReadRunning(n),
        Counter::Run(n, true),
        Counter::Run(n, false),
        Counter::ReadPreset(n),
        Counter::ReadMaximum(n),
        Counter::EnableAlarmOf(n),
        Counter::DisableAlarmOf(n),
        Counter::ReadLimit(n),
    ];
    if let Some(value) = rest
        .get(2..)
        .filter(|data| data.len() == 8)
        .and_then(hex_number)
    {
        found.extend([
            Counter::WritePreset(n, value),
            Counter::WriteMaximum(n, value),
            Counter::WriteLimit(n, value),
        ]);
    }
    found
}
