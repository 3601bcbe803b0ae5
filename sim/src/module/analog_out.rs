//! Analog outputs: 7021, 7021P (one channel), 7022 (two), 7024 (four).
//!
//! | request | reply |
//! |---|---|
//! | `#AA(data)`, `#AAN(data)` | `>`; out of range: `?AA`, and the nearest limit as value; after a watchdog trip `!` |
//! | `$AA6[N]` | last commanded value |
//! | `$AA8[N]` | present value: measured at the terminals (7021), computed from the ramp (others) |
//! | `$AA4[N]`, `$AA7[N]` | store the commanded value as power-on value; read that value |
//! | `~AA5[N]`, `~AA4[N]` | the same for the safe value |
//! | `$AA9N`, `$AA9NTS` | type and slew of one channel (7022) |
//!
//! The terminals carry the quantised value with the module's own gain error and offset. Data with valid
//! characters but the wrong width get `?AA`; other text gets no answer. The manuals do not document a signed
//! value of six characters (`+5.000`) at a 7021: it gets `?AA` unless the table has `signed = true`.

use super::base::{Commissioning, ModuleBase};
use super::output::{Data, Model, Span, format_value, model, read, span};
use super::ramp::{Ramp, nominal_rate};
use super::range::Format;
use super::tolerances::Tolerances;
use super::{Built, Family, Terminals, setting};
use crate::config::ConfigError;
use crate::dcon::{self, Answer, Request};
use crate::table::Table;
use crate::terminal::ModuleSpec;

struct AnalogOut {
    model: Model,
    channels: Vec<Channel>,
    tolerances: Tolerances,
}

#[derive(Debug, Clone)]
struct Channel {
    ramp: Ramp,
    power_on: f64,
    safe: f64,
    /// Type nibble and slew code of each 7022 channel.
    own: (u8, u8),
}

/// Numbers of the models.
pub(super) const MODELS: [&str; 4] = ["7021", "7021P", "7022", "7024"];

/// Builds an analog output from its table.
pub(super) fn build(
    spec: &ModuleSpec,
    number: &str,
    line: Commissioning,
    tolerances: &Tolerances,
) -> Result<Built, ConfigError> {
    let keys = &spec.settings;
    let model = Model {
        takes_sign: keys.get_or("signed", false)?,
        ..model(number)
    };
    let key = setting::either(keys, "type", "range")?;
    let type_code = setting::code(keys, key, 0xFF)?.unwrap_or(0x32);
    let span = match (model.own_slew, type_code) {
        // Type code 3F in the configuration word: each channel has its own type, initially 32.
        (true, 0x3F) => span(model, 0x32),
        (_, code) => span(model, code),
    };
    let span = span.ok_or_else(|| keys.wrong(key, "a type code of this model"))?;
    let slew = setting::code(keys, "slew", 0xF)?.unwrap_or(0);
    let format = setting::word(keys, "format", &Format::NAMES)?.unwrap_or(0);
    let word_type = if model.own_slew { 0x3F } else { type_code };
    let base = ModuleBase::new(spec, line, word_type, format | slew << 2)?;
    let channels = channels(keys, model, span, (type_code, slew))?;
    let family = AnalogOut {
        model,
        channels,
        tolerances: tolerances.clone(),
    };
    Ok((base, Box::new(family)))
}

fn channels(
    keys: &Table,
    model: Model,
    span: Span,
    (type_code, slew): (u8, u8),
) -> Result<Vec<Channel>, ConfigError> {
    let most = usize::from(model.channels);
    let form = format!("numbers from {} to {}", span.low, span.high);
    let fits = |value| (span.low..=span.high).contains(&value);
    let values = |key| setting::values(keys, key, most, &form, fits);
    let (safe, power_on, outputs) = (values("safe")?, values("power_on")?, values("outputs")?);
    let nth = |list: &[f64], n: usize| list.get(n).copied();
    let own_type = if type_code == 0x3F {
        2
    } else {
        type_code & 0xF
    };
    let channel = |n: usize| {
        let power_on = nth(&power_on, n).unwrap_or(0.0);
        Channel {
            ramp: Ramp::at(nth(&outputs, n).unwrap_or(power_on)),
            power_on,
            safe: nth(&safe, n).unwrap_or(0.0),
            own: (own_type, slew),
        }
    };
    Ok((0..most).map(channel).collect())
}

impl AnalogOut {
    fn span(&self, base: &ModuleBase, channel: usize) -> Span {
        let type_code = if self.model.own_slew {
            0x30 | self.channels[channel].own.0
        } else {
            base.type_code
        };
        span(self.model, type_code).unwrap_or(Span {
            low: 0.0,
            high: 10.0,
            is_current: false,
        })
    }

    fn slew(&self, base: &ModuleBase, channel: usize) -> u8 {
        if self.model.own_slew {
            self.channels[channel].own.1
        } else {
            base.format >> 2 & 0xF
        }
    }

    fn format(&self, base: &ModuleBase) -> Format {
        match Format::of(base.format) {
            Some(format) if !self.model.signed => format,
            _ => Format::Engineering,
        }
    }

    /// Returns the value at the terminals: quantised, with the module's own errors.
    fn carried(&self, span: Span, value: f64) -> f64 {
        let width = span.high - span.low;
        let steps = 2f64.powi(self.model.bits) - 1.0;
        let quantised = span.low + ((value - span.low) / width * steps).round() / steps * width;
        self.with_errors(quantised)
    }

    fn with_errors(&self, value: f64) -> f64 {
        value * (1.0 + self.tolerances.ao_gain) + self.tolerances.ao_offset_v
    }

    /// Drives the terminals of a channel.
    fn drive(&self, base: &ModuleBase, channel: usize, at: &mut Terminals<'_>) {
        let present = self.channels[channel].ramp.present();
        let value = self.carried(self.span(base, channel), present);
        at.plant.analog_out(at.module, channel as u8, value);
    }

    fn drive_all(&self, base: &ModuleBase, at: &mut Terminals<'_>) {
        for channel in 0..self.channels.len() {
            self.drive(base, channel, at);
        }
    }

    fn output(
        &mut self,
        base: &ModuleBase,
        channel: usize,
        data: &[u8],
        at: &mut Terminals<'_>,
    ) -> Answer {
        if base.watchdog.tripped() {
            return dcon::ignored();
        }
        let span = self.span(base, channel);
        let value = match read(self.model, self.format(base), span, data) {
            Data::Value(value) => value,
            Data::WrongWidth => return dcon::refused(base.address),
            Data::Nonsense => return Answer::Unknown,
        };
        let legal = value.clamp(span.low, span.high);
        match self.slew(base, channel) {
            0 => {
                self.channels[channel].ramp.jump(legal);
                self.drive(base, channel, at);
            }
            _ => {
                let refresh_us = self.tolerances.ao_refresh_us;
                self.channels[channel].ramp.go(legal, at.now_us, refresh_us);
            }
        }
        if legal == value {
            dcon::accepted()
        } else {
            dcon::refused(base.address)
        }
    }

    fn shown(&self, base: &ModuleBase, channel: usize, value: f64) -> Answer {
        let span = self.span(base, channel);
        let text = format_value(self.model, self.format(base), span, value);
        dcon::done_data(base.address, &text)
    }

    fn present(&self, channel: usize) -> f64 {
        let value = self.channels[channel].ramp.present();
        if self.model.true_readback {
            // The read-back converter has a finer resolution than the output converter.
            self.with_errors(value)
        } else {
            value
        }
    }

    fn command(
        &mut self,
        base: &mut ModuleBase,
        lead: u8,
        digit: u8,
        channel: usize,
        rest: &[u8],
    ) -> Answer {
        let store = |base: &mut ModuleBase| {
            base.eeprom_writes += 1;
            dcon::done(base.address)
        };
        let target = self.channels[channel].ramp.target();
        match (lead, digit, rest) {
            (b'$', b'6', []) => self.shown(base, channel, target),
            (b'$', b'8', []) => self.shown(base, channel, self.present(channel)),
            (b'$', b'7', []) => self.shown(base, channel, self.channels[channel].power_on),
            (b'~', b'4', []) => self.shown(base, channel, self.channels[channel].safe),
            (b'$', b'4', []) => {
                self.channels[channel].power_on = target;
                store(base)
            }
            (b'~', b'5', []) => {
                self.channels[channel].safe = target;
                store(base)
            }
            (b'$', b'9', rest) if self.model.own_slew => self.own_slew(base, channel, rest),
            (_, _, _) => Answer::Unknown,
        }
    }

    fn own_slew(&mut self, base: &mut ModuleBase, channel: usize, rest: &[u8]) -> Answer {
        match rest {
            [] => {
                let (kind, slew) = self.channels[channel].own;
                dcon::done_hex(base.address, u64::from(kind << 4 | slew), 2)
            }
            [kind @ b'0'..=b'2', slew] => match dcon::hex_digit(*slew) {
                Some(slew) => {
                    self.channels[channel].own = (kind - b'0', slew);
                    base.eeprom_writes += 1;
                    dcon::done(base.address)
                }
                None => Answer::Unknown,
            },
            _ => Answer::Unknown,
        }
    }
}

impl Family for AnalogOut {
    fn fits(&self, type_code: u8, format: u8) -> bool {
        let type_fits = if self.model.own_slew {
            type_code == 0x3F
        } else {
            span(self.model, type_code).is_some()
        };
        type_fits && Format::of(format).is_some() && format & 0x80 == 0
    }

    fn answer(
        &mut self,
        base: &mut ModuleBase,
        request: &Request<'_>,
        at: &mut Terminals<'_>,
    ) -> Answer {
        let channel_of = |digit: u8| dcon::hex_digit(digit).map(usize::from);
        match (request.lead, request.body) {
            (b'#', [digit, data @ ..]) if self.model.numbered => match channel_of(*digit) {
                Some(channel) if channel < self.channels.len() => {
                    self.output(base, channel, data, at)
                }
                Some(_) => dcon::refused(base.address),
                None => Answer::Unknown,
            },
            (b'#', data) if !self.model.numbered => self.output(base, 0, data, at),
            (lead @ (b'$' | b'~'), [command @ b'4'..=b'9', digit, rest @ ..])
                if self.model.numbered =>
            {
                match channel_of(*digit) {
                    Some(channel) if channel < self.channels.len() => {
                        self.command(base, lead, *command, channel, rest)
                    }
                    Some(_) => dcon::refused(base.address),
                    None => Answer::Unknown,
                }
            }
            (lead @ (b'$' | b'~'), [command @ b'4'..=b'9', rest @ ..]) if !self.model.numbered => {
                self.command(base, lead, *command, 0, rest)
            }
            (_, _) => Answer::Unknown,
        }
    }

    fn configured(&mut self, base: &ModuleBase, _at: &mut Terminals<'_>) {
        for channel in 0..self.channels.len() {
            let span = self.span(base, channel);
            let target = self.channels[channel]
                .ramp
                .target()
                .clamp(span.low, span.high);
            if target != self.channels[channel].ramp.target() {
                self.channels[channel].ramp.jump(target);
            }
        }
    }

    fn next_us(&self) -> u64 {
        self.channels
            .iter()
            .fold(u64::MAX, |next, channel| next.min(channel.ramp.next_us()))
    }

    fn run(&mut self, base: &ModuleBase, at: &mut Terminals<'_>) {
        let refresh_us = self.tolerances.ao_refresh_us;
        for channel in 0..self.channels.len() {
            if self.channels[channel].ramp.next_us() > at.now_us {
                continue;
            }
            let is_current = self.span(base, channel).is_current;
            let rate = nominal_rate(self.slew(base, channel), is_current).unwrap_or(f64::INFINITY);
            let step = rate * (1.0 + self.tolerances.ao_slope) * refresh_us as f64 * 1e-6;
            self.channels[channel].ramp.step(step, refresh_us);
            self.drive(base, channel, at);
        }
    }

    fn sample(&mut self, _at: &mut Terminals<'_>) {}

    fn make_safe(&mut self, base: &ModuleBase, at: &mut Terminals<'_>) {
        for channel in &mut self.channels {
            channel.ramp.jump(channel.safe);
        }
        self.drive_all(base, at);
    }

    fn restart(&mut self, base: &ModuleBase) {
        let tripped = base.watchdog.tripped();
        for channel in &mut self.channels {
            let value = if tripped {
                channel.safe
            } else {
                channel.power_on
            };
            channel.ramp.jump(value);
        }
    }

    fn energise(&mut self, base: &ModuleBase, at: &mut Terminals<'_>) {
        self.drive_all(base, at);
    }
}
