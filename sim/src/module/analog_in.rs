//! Analog inputs: 7017 and 7018 families, and the RTD module 7033.
//!
//! | request | reply |
//! |---|---|
//! | `#AA` | `>` and a field per channel; a disabled channel is blank |
//! | `#AAN` | `>` and one field; `?AA` when channel N does not exist |
//! | `$AAA` | `>` and 4 hexadecimal digits per channel, whatever the data format |
//! | `$AA5VV`, `$AA6` | write the enable mask to the EEPROM; read it |
//! | `$AA3` | `>` and the temperature of the cold junction (7018), always room temperature |
//! | `$AA7CiRrr`, `$AA8Ci` | newer modules: write the range of one channel to the EEPROM; read it as `CiRrr` |
//! | `$AAB` | newer modules: `!AANN`, the enabled channels that are outside their range, bit n = channel n |
//!
//! A new type code in the configuration word applies to every channel.
//!
//! A reading is the last finished conversion of its channel (see [`super::converter`]). An RTD input has no errors and
//! 24 bits; any other has the module's own gain error, offset and noise, and 16 bits, or 12 in fast mode. Factory
//! calibration (`$AA0`, `$AA1`, `~AAEV`) is not simulated, since a rig never sends it.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::base::{Commissioning, ModuleBase};
use super::converter::Converter;
use super::range::{self, Format, Range};
use super::tolerances::Tolerances;
use super::{Built, Family, Terminals, setting};
use crate::config::ConfigError;
use crate::dcon::{self, Answer, Request};
use crate::table::Table;
use crate::terminal::ModuleSpec;

/// Bit of FF that selects the fast mode.
const FAST: u8 = 0x20;

/// Bit of FF that selects the 50 Hz mains filter.
const MAINS_50_HZ: u8 = 0x80;

/// Temperature of the cold junction, degrees Celsius.
const COLD_JUNCTION_C: f64 = 25.0;

/// Conversions per second of the RTD module, all channels together.
const RTD_PER_S: f64 = 15.0;

struct AnalogIn {
    kind: Kind,
    converter: Converter,
    /// Last reading of each channel, fraction of full scale.
    readings: [f64; 8],
    /// Type code of the last configuration word; a change of it applies to every channel.
    type_code: u8,
    /// Present type code of each channel.
    ranges: [u8; 8],
    tolerances: Tolerances,
    rng: ChaCha8Rng,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Voltage {
        may_be_fast: bool,
    },
    /// 7018: also reads thermocouples, has no fast mode.
    Thermocouple,
    Rtd,
}

impl Kind {
    fn channels(self) -> u8 {
        match self {
            Self::Voltage { .. } | Self::Thermocouple => 8,
            Self::Rtd => 3,
        }
    }

    fn range(self, type_code: u8) -> Option<Range> {
        match self {
            Self::Voltage { .. } | Self::Thermocouple => range::voltage_range(type_code),
            Self::Rtd => range::rtd_range(type_code),
        }
    }

    fn bits(self, format: u8) -> i32 {
        match self {
            Self::Rtd => 24,
            Self::Voltage { .. } if format & FAST != 0 => 12,
            Self::Voltage { .. } | Self::Thermocouple => 16,
        }
    }
}

/// Numbers of the models.
pub(super) const MODELS: [&str; 8] = [
    "7017", "7017F", "7017R", "7017RC", "7018", "7018P", "7018R", "7033",
];

/// Builds an analog input from its table.
pub(super) fn build(
    spec: &ModuleSpec,
    model: &str,
    line: Commissioning,
    tolerances: &Tolerances,
    rng: ChaCha8Rng,
) -> Result<Built, ConfigError> {
    let keys = &spec.settings;
    let (kind, default_type) = match model {
        "7033" => (Kind::Rtd, 0x20),
        "7018" | "7018P" | "7018R" => (Kind::Thermocouple, 0x05),
        "7017" => (Kind::Voltage { may_be_fast: false }, 0x08),
        _ => (Kind::Voltage { may_be_fast: true }, 0x08),
    };
    let type_code = type_code(keys, kind, default_type)?;
    let mut base = ModuleBase::new(spec, line, type_code, format_bits(keys, kind)?)?;
    let all = (1u16 << kind.channels()) - 1;
    let mask = setting::bits(keys, setting::either(keys, "mask", "enabled")?, all)?.unwrap_or(all);
    let form = "numbers, or nan for an open terminal";
    base.inputs = setting::values(keys, "inputs", kind.channels().into(), form, |value| {
        !value.is_infinite()
    })?;
    let per_s = pace(kind, tolerances, base.format);
    let family = AnalogIn {
        kind,
        converter: Converter::new(kind.channels(), mask as u8, per_s),
        readings: [0.0; 8],
        type_code,
        ranges: [type_code; 8],
        tolerances: tolerances.clone(),
        rng,
    };
    Ok((base, Box::new(family)))
}

fn type_code(keys: &Table, kind: Kind, default: u8) -> Result<u8, ConfigError> {
    let key = setting::either(keys, "type", "range")?;
    let code = setting::code(keys, key, 0xFF)?.unwrap_or(default);
    match kind.range(code) {
        Some(_) => Ok(code),
        None => Err(keys.wrong(key, "a type code of this model")),
    }
}

fn format_bits(keys: &Table, kind: Kind) -> Result<u8, ConfigError> {
    let format = setting::word(keys, "format", &Format::NAMES)?.unwrap_or(0);
    let fast = keys.get_or("fast", false)?;
    if fast && kind != (Kind::Voltage { may_be_fast: true }) {
        return Err(keys.wrong("fast", "false: this model has no fast mode"));
    }
    Ok(format | if fast { FAST } else { 0 })
}

fn pace(kind: Kind, tolerances: &Tolerances, format: u8) -> f64 {
    match kind {
        Kind::Rtd => RTD_PER_S,
        Kind::Voltage { .. } if format & FAST != 0 => tolerances.fast_per_s,
        Kind::Voltage { .. } | Kind::Thermocouple => tolerances.normal_per_s,
    }
}

impl AnalogIn {
    fn convert(&mut self, base: &ModuleBase, channel: u8, terminal: f64) {
        let Some(range) = self.range(channel) else {
            return;
        };
        let reading = if terminal.is_nan() {
            self.open_input(channel)
        } else {
            self.digitise(range, base.format, terminal)
        };
        self.readings[usize::from(channel)] = reading;
    }

    fn range(&self, channel: u8) -> Option<Range> {
        self.kind.range(self.ranges[usize::from(channel)])
    }

    /// Returns the reading of an open input: over range at a temperature input, zero at a voltage input.
    fn open_input(&self, channel: u8) -> f64 {
        let is_thermocouple = range::is_thermocouple(self.ranges[usize::from(channel)]);
        if self.kind == Kind::Rtd || is_thermocouple {
            f64::INFINITY
        } else {
            0.0
        }
    }

    fn digitise(&mut self, range: Range, format: u8, terminal: f64) -> f64 {
        let steps = 2f64.powi(self.kind.bits(format) - 1);
        if self.kind == Kind::Rtd {
            return (range.fraction(terminal) * steps).round() / steps;
        }
        let ideal = terminal * (1.0 + self.tolerances.ai_gain)
            + self.tolerances.ai_offset * range.full_scale / range.per_terminal;
        let noise: f64 = match self.tolerances.ai_noise_lsb {
            0.0 => 0.0,
            sd => self.rng.sample::<f64, _>(StandardNormal) * sd,
        };
        let noisy = ideal + noise / steps * range.full_scale / range.per_terminal;
        (range.fraction(noisy) * steps).round() / steps
    }

    fn field(&self, channel: u8, format: Format, text: &mut String) {
        if self.converter.mask() & (1 << channel) == 0 {
            text.push_str(if format == Format::Hex {
                "    "
            } else {
                "       "
            });
        } else if let Some(range) = self.range(channel) {
            range.format_value(self.readings[usize::from(channel)], format, text);
        }
    }

    fn fields(&self, format: Format) -> Answer {
        let mut text = String::with_capacity(dcon::LONGEST);
        text.push('>');
        for channel in 0..self.kind.channels() {
            self.field(channel, format, &mut text);
        }
        Answer::Reply(text)
    }

    fn one_field(&self, base: &ModuleBase, digit: u8, format: Format) -> Answer {
        match dcon::hex_digit(digit) {
            Some(channel) if channel < self.kind.channels() => {
                let mut text = String::with_capacity(dcon::LONGEST);
                text.push('>');
                self.field(channel, format, &mut text);
                Answer::Reply(text)
            }
            Some(_) => dcon::refused(base.address),
            None => Answer::Unknown,
        }
    }

    fn enable(&mut self, base: &mut ModuleBase, mask: u8, at: &mut Terminals<'_>) -> Answer {
        let all = (1u16 << self.kind.channels()).wrapping_sub(1);
        if u16::from(mask) & !all != 0 {
            return dcon::refused(base.address);
        }
        self.converter.enable(mask, at);
        base.eeprom_writes += 1;
        dcon::done(base.address)
    }

    /// Carries out commands that only newer modules know.
    fn newer(&mut self, base: &mut ModuleBase, body: &[u8]) -> Answer {
        let known = |digit: u8| dcon::hex_digit(digit).filter(|n| *n < self.kind.channels());
        match *body {
            [b'B'] => {
                let beyond = |n: &u8| {
                    self.converter.mask() & 1 << n != 0
                        && self.readings[usize::from(*n)].is_infinite()
                };
                let channels = (0..self.kind.channels()).filter(beyond);
                let word = channels.fold(0, |word, n| word | 1u64 << n);
                dcon::done_hex(base.address, word, 2)
            }
            [b'8', b'C', digit] => match known(digit) {
                Some(n) => {
                    let range = self.ranges[usize::from(n)];
                    dcon::done_data(base.address, &format!("C{n}R{range:02X}"))
                }
                None => dcon::refused(base.address),
            },
            [b'7', b'C', digit, b'R', high, low] => match dcon::hex_byte(&[high, low]) {
                Some(range) => match known(digit) {
                    Some(n) if self.kind.range(range).is_some() => {
                        self.ranges[usize::from(n)] = range;
                        base.eeprom_writes += 1;
                        dcon::done(base.address)
                    }
                    Some(_) | None => dcon::refused(base.address),
                },
                None => Answer::Unknown,
            },
            _ => Answer::Unknown,
        }
    }
}

impl Family for AnalogIn {
    fn fits(&self, type_code: u8, format: u8) -> bool {
        let may_be_fast = self.kind == (Kind::Voltage { may_be_fast: true });
        let known = MAINS_50_HZ | 0x40 | 0b11 | if may_be_fast { FAST } else { 0 };
        self.kind.range(type_code).is_some() && Format::of(format).is_some() && format & !known == 0
    }

    fn answer(
        &mut self,
        base: &mut ModuleBase,
        request: &Request<'_>,
        at: &mut Terminals<'_>,
    ) -> Answer {
        let format = Format::of(base.format).unwrap_or(Format::Engineering);
        match (request.lead, request.body) {
            (b'#', []) => self.fields(format),
            (b'#', [digit]) => self.one_field(base, *digit, format),
            (b'$', b"A") => self.fields(Format::Hex),
            (b'$', b"3") if self.kind == Kind::Thermocouple => {
                Answer::Reply(format!(">{COLD_JUNCTION_C:+07.1}"))
            }
            (b'$', b"6") => dcon::done_hex(base.address, u64::from(self.converter.mask()), 2),
            (b'$', [b'5', high, low]) => match dcon::hex_byte(&[*high, *low]) {
                Some(mask) => self.enable(base, mask, at),
                None => Answer::Unknown,
            },
            (b'$', body) if base.is_newer() => self.newer(base, body),
            (_, _) => Answer::Unknown,
        }
    }

    fn configured(&mut self, base: &ModuleBase, _at: &mut Terminals<'_>) {
        if base.type_code != self.type_code {
            self.type_code = base.type_code;
            self.ranges = [base.type_code; 8];
        }
        self.converter
            .set_pace(pace(self.kind, &self.tolerances, base.format));
    }

    fn next_us(&self) -> u64 {
        self.converter.next_us()
    }

    fn run(&mut self, base: &ModuleBase, at: &mut Terminals<'_>) {
        if let Some((channel, mean)) = self.converter.run(at) {
            self.convert(base, channel, mean);
        }
    }

    fn sample(&mut self, _at: &mut Terminals<'_>) {}

    fn make_safe(&mut self, _plate: &ModuleBase, _at: &mut Terminals<'_>) {}

    fn restart(&mut self, _plate: &ModuleBase) {}

    /// Fills every channel with a reading, as in a module that has long been powered.
    fn energise(&mut self, base: &ModuleBase, at: &mut Terminals<'_>) {
        for channel in 0..self.kind.channels() {
            let terminal = at.plant.analog_in(at.module, channel);
            self.convert(base, channel, terminal);
        }
        self.converter.start(at);
    }
}
