//! The counter and frequency module 7080 (7080B, 7080D): two gated 32-bit counters.
//!
//! Each counter runs from its preset to its maximum, then wraps to the preset and sets its overflow flag. Gating is
//! exact as in hardware: a counter holds the pulses of its input over the whole open time of its gate, at whatever
//! instant the host reads it. Gate mode 0 counts while the gate input is low, 1 while it is high, 2 always. In
//! frequency mode (type 51) a reading is the frequency in hertz with the resolution of the gate time: 10 Hz (0.1 s) or
//! 1 Hz (1.0 s, FF bit 2).
//!
//! `#AAN` with an invalid channel gets no answer. Settings that survive a power loss count as EEPROM writes.
//! Every request updates the alarms ([`super::alarm`]). LED commands keep their values and have no effect.

use std::ops::RangeInclusive;

use super::alarm::{Alarm, CommandEffect};
use super::base::{Commissioning, ModuleBase};
use super::pulse::{Channel, channels};
use super::{Built, Family, Terminals, setting};
use crate::config::ConfigError;
use crate::dcon::{self, Answer, Request};
use crate::table::Table;
use crate::terminal::ModuleSpec;

/// Bit of FF that selects the long frequency gate.
const ONE_SECOND_GATE: u8 = 0x04;

/// Range for the least pulse width of the digital filter, microseconds.
const FILTER_US: RangeInclusive<u32> = 2..=65_535;

/// Range for the thresholds of the TTL inputs, tenths of a volt.
const THRESHOLD: RangeInclusive<u32> = 0..=50;

struct Counter {
    channels: [Channel; 2],
    gate_mode: u8,
    input_mode: u8,
    filter_on: bool,
    /// Least width of a high level and of a low level, microseconds.
    filter_us: [u32; 2],
    /// High and low threshold of the TTL inputs, tenths of a volt.
    threshold: [u32; 2],
    outputs: u8,
    alarm: Alarm,
    led: u8,
    has_led: bool,
}

/// Numbers of the models.
pub(super) const MODELS: [&str; 3] = ["7080", "7080B", "7080D"];

/// Builds a counter module from its table.
pub(super) fn build(
    spec: &ModuleSpec,
    model: &str,
    line: Commissioning,
) -> Result<Built, ConfigError> {
    let keys = &spec.settings;
    let key = setting::either(keys, "type", "range")?;
    let type_code = setting::code(keys, key, 0xFF)?.unwrap_or(0x50);
    if !matches!(type_code, 0x50 | 0x51) {
        return Err(keys.wrong(key, "\"50\" or \"51\""));
    }
    let pair = |key, default: [u32; 2], range| {
        let list = setting::counts(keys, key, 2, range)?;
        Ok::<_, ConfigError>([0, 1].map(|n| list.get(n).copied().unwrap_or(default[n])))
    };
    let digit = |key, most, default| {
        let form = format!("a whole number from 0 to {most}");
        let digit = keys.fit(key, &form, |it| it.whole().filter(|digit| *digit <= most))?;
        Ok::<u8, ConfigError>(digit.unwrap_or(default))
    };
    let has_led = model == "7080D";
    let family = Counter {
        channels: channels(keys)?,
        gate_mode: gate_mode(keys)?,
        input_mode: digit("input_mode", 3, 1)?,
        filter_on: keys.get_or("filter", false)?,
        filter_us: pair("filter_us", [2, 2], FILTER_US)?,
        threshold: pair("threshold", [24, 8], THRESHOLD)?,
        outputs: setting::bits(keys, "outputs", 0b11)?.unwrap_or(0) as u8,
        alarm: Alarm::new(has_led),
        led: if has_led { digit("led", 2, 0)? } else { 0 },
        has_led,
    };
    Ok((ModuleBase::new(spec, line, type_code, 0)?, Box::new(family)))
}

/// Reads the gate mode: a word or its number.
fn gate_mode(keys: &Table) -> Result<u8, ConfigError> {
    const WORDS: [&str; 3] = ["low", "high", "none"];
    let form = "low, high, none, 0, 1 or 2";
    let mode = keys.fit("gate", form, |entry| {
        let word = WORDS.iter().position(|word| Some(*word) == entry.text());
        word.or_else(|| entry.whole()).filter(|mode| *mode <= 2)
    })?;
    Ok(mode.unwrap_or(1) as u8)
}

/// Answers `$AA9(data)`, five digits with a decimal point after one of them: refuses any other number of digits or
/// place of the point; data with other characters is an unknown command.
fn show(base: &ModuleBase, data: &[u8]) -> Answer {
    let digits = data.iter().filter(|byte| byte.is_ascii_digit()).count();
    let points = data.iter().filter(|byte| **byte == b'.').count();
    if digits + points != data.len() || data.is_empty() {
        Answer::Unknown
    } else if (digits, points) == (5, 1) && data[0] != b'.' {
        dcon::done(base.address)
    } else {
        dcon::refused(base.address)
    }
}

impl Counter {
    /// Returns the time during which the gate has let pulses through so far, microseconds.
    fn gate_us(&self, channel: usize, at: &mut Terminals<'_>) -> f64 {
        let now_us = at.now_us as f64;
        match self.gate_mode {
            0 => now_us - at.plant.gate_open_us(at.module, channel as u8),
            1 => at.plant.gate_open_us(at.module, channel as u8),
            _ => now_us,
        }
    }

    /// Brings both counters up to the present instant; returns the clock frequency of each, hertz.
    fn update(&mut self, at: &mut Terminals<'_>) -> [f64; 2] {
        [0, 1].map(|n| {
            let gate_us = self.gate_us(n, at);
            let channel = &mut self.channels[n];
            if channel.running {
                channel.counted_us += gate_us - channel.seen_us;
            }
            channel.seen_us = gate_us;
            channel.hz(at)
        })
    }

    fn set_gate_mode(&mut self, mode: u8, at: &mut Terminals<'_>) {
        self.update(at);
        self.gate_mode = mode;
        for n in 0..2 {
            self.channels[n].seen_us = self.gate_us(n, at);
        }
    }

    fn reading(&mut self, base: &ModuleBase, n: usize, at: &mut Terminals<'_>) -> Answer {
        let hz = self.update(at)[n];
        let value = match (base.type_code, base.format & ONE_SECOND_GATE) {
            (0x50, _) => self.channels[n].value(hz),
            (_, 0) => (hz / 10.0).floor() as u64 * 10,
            (_, _) => hz.floor() as u64,
        };
        let mut text = String::from(">");
        dcon::push_hex(&mut text, value, 8);
        Answer::Reply(text)
    }

    fn channel_command(
        &mut self,
        base: &mut ModuleBase,
        command: u8,
        n: usize,
        rest: &[u8],
        at: &mut Terminals<'_>,
    ) -> Answer {
        let hz = self.update(at)[n];
        let channel = &mut self.channels[n];
        match (command, rest) {
            (b'6', []) => channel.reset(hz),
            (b'7', []) => {
                return dcon::done_hex(base.address, u64::from(channel.overflow(hz)), 1);
            }
            (b'5', []) => {
                return dcon::done_hex(base.address, u64::from(channel.running), 1);
            }
            (b'5', [run @ (b'0' | b'1')]) => channel.running = *run == b'1',
            (b'3', []) => return dcon::done_hex(base.address, u64::from(channel.maximum), 8),
            (b'3', digits) => match dcon::hex(digits) {
                Some(maximum) if digits.len() == 8 => {
                    channel.maximum = maximum;
                    base.eeprom_writes += 1;
                }
                _ => return Answer::Unknown,
            },
            (_, _) => return Answer::Unknown,
        }
        dcon::done(base.address)
    }

    /// Carries out `$AA0H`, `$AA0L`, `$AA1H`, `$AA1L`: decimal settings of the inputs.
    fn level_command(&mut self, base: &mut ModuleBase, kind: u8, level: u8, rest: &[u8]) -> Answer {
        let place = usize::from(level == b'L');
        let (values, width) = match kind {
            b'0' => (&mut self.filter_us, 5),
            _ => (&mut self.threshold, 2),
        };
        if rest.is_empty() {
            return dcon::done_data(base.address, &format!("{:0width$}", values[place]));
        }
        let limits = if kind == b'0' { FILTER_US } else { THRESHOLD };
        match dcon::decimal(rest) {
            Some(value) if rest.len() == width && limits.contains(&value) => {
                values[place] = value;
                base.eeprom_writes += 1;
                dcon::done(base.address)
            }
            Some(_) if rest.len() == width => dcon::refused(base.address),
            _ => Answer::Unknown,
        }
    }

    /// Carries out `$AA4`, `$AAA`, `$AAB`, `$AA8`: one-digit modes.
    fn mode_command(
        &mut self,
        base: &mut ModuleBase,
        mode: u8,
        rest: &[u8],
        at: &mut Terminals<'_>,
    ) -> Answer {
        let (present, most) = match mode {
            b'4' => (u8::from(self.filter_on), 1),
            b'A' => (self.gate_mode, 2),
            b'B' => (self.input_mode, 3),
            _ => (self.led, 2),
        };
        let [digit] = rest else {
            return if rest.is_empty() {
                dcon::done_hex(base.address, u64::from(present), 1)
            } else {
                Answer::Unknown
            };
        };
        match dcon::hex_digit(*digit) {
            Some(value) if value <= most => {
                match mode {
                    b'4' => self.filter_on = value == 1,
                    b'A' => self.set_gate_mode(value, at),
                    b'B' => self.input_mode = value,
                    _ => self.led = value,
                }
                base.eeprom_writes += 1;
                dcon::done(base.address)
            }
            Some(_) => dcon::refused(base.address),
            None => Answer::Unknown,
        }
    }

    fn at_command(&mut self, base: &mut ModuleBase, body: &[u8], at: &mut Terminals<'_>) -> Answer {
        match body {
            [b'G', n @ (b'0' | b'1')] => {
                let preset = self.channels[usize::from(n - b'0')].preset;
                dcon::done_hex(base.address, u64::from(preset), 8)
            }
            [b'P', n @ (b'0' | b'1'), digits @ ..] if digits.len() == 8 => {
                let Some(preset) = dcon::hex(digits) else {
                    return Answer::Unknown;
                };
                self.update(at);
                self.channels[usize::from(n - b'0')].preset = preset;
                base.eeprom_writes += 1;
                dcon::done(base.address)
            }
            b"DI" => {
                let outputs = u64::from(self.carried(at));
                let state = u64::from(self.alarm.state());
                dcon::done_hex(base.address, state << 16 | outputs << 8, 5)
            }
            [b'D', b'O', b'0', data @ b'0'..=b'3'] => self.write(base, data - b'0'),
            _ => self.alarm_command(base, body),
        }
    }

    fn write(&mut self, base: &ModuleBase, outputs: u8) -> Answer {
        if base.watchdog.tripped() {
            return dcon::ignored();
        }
        if self.alarm.owns_outputs() {
            return dcon::refused(base.address);
        }
        self.outputs = outputs;
        dcon::done(base.address)
    }

    fn alarm_command(&mut self, base: &mut ModuleBase, body: &[u8]) -> Answer {
        match self.alarm.command(body) {
            CommandEffect::Stored => {
                base.eeprom_writes += 1;
                dcon::done(base.address)
            }
            CommandEffect::Done => dcon::done(base.address),
            CommandEffect::Limit(limit) => dcon::done_hex(base.address, u64::from(limit), 8),
            CommandEffect::Refused => dcon::refused(base.address),
            CommandEffect::Unknown => Answer::Unknown,
        }
    }

    /// Returns the outputs: the word of the alarms where they control, otherwise the word of the host.
    fn carried(&mut self, at: &mut Terminals<'_>) -> u8 {
        let hz = self.update(at);
        let values = [0, 1].map(|n| self.channels[n].value(hz[n]));
        self.alarm.outputs(self.outputs, values)
    }
}

impl Family for Counter {
    fn fits(&self, type_code: u8, format: u8) -> bool {
        matches!(type_code, 0x50 | 0x51) && format & !(0x40 | ONE_SECOND_GATE) == 0
    }

    fn answer(
        &mut self,
        base: &mut ModuleBase,
        request: &Request<'_>,
        at: &mut Terminals<'_>,
    ) -> Answer {
        // Update the latches for events before this request.
        self.carried(at);
        match (request.lead, request.body) {
            (b'#', [n @ (b'0' | b'1')]) => self.reading(base, usize::from(n - b'0'), at),
            (
                b'$',
                [
                    command @ (b'3' | b'5' | b'6' | b'7'),
                    n @ (b'0' | b'1'),
                    rest @ ..,
                ],
            ) => self.channel_command(base, *command, usize::from(n - b'0'), rest, at),
            // Other modules report their reset status here; `$AA5N` is the state of a counter.
            (b'$', [b'5']) => Answer::Silence,
            (b'$', [kind @ (b'0' | b'1'), level @ (b'H' | b'L'), rest @ ..]) => {
                self.level_command(base, *kind, *level, rest)
            }
            (b'$', [mode @ (b'4' | b'A' | b'B'), rest @ ..]) => {
                self.mode_command(base, *mode, rest, at)
            }
            (b'$', [mode @ b'8', rest @ ..]) if self.has_led => {
                self.mode_command(base, *mode, rest, at)
            }
            (b'$', [b'9', data @ ..]) if self.has_led => show(base, data),
            (b'~', b"A") => dcon::done_hex(base.address, u64::from(self.alarm.mode()), 1),
            (b'~', [b'A', mode @ (b'0' | b'1')]) => {
                self.alarm.set_mode(*mode == b'1');
                base.eeprom_writes += 1;
                dcon::done(base.address)
            }
            (b'@', body) => self.at_command(base, body, at),
            (_, _) => Answer::Unknown,
        }
    }

    fn configured(&mut self, _plate: &ModuleBase, _at: &mut Terminals<'_>) {}

    fn next_us(&self) -> u64 {
        u64::MAX
    }

    fn run(&mut self, _plate: &ModuleBase, _at: &mut Terminals<'_>) {}

    fn sample(&mut self, _at: &mut Terminals<'_>) {}

    fn make_safe(&mut self, _plate: &ModuleBase, _at: &mut Terminals<'_>) {
        self.outputs = 0;
    }

    /// Restarts the counts at the preset, as a power loss does; the battery of a 7080B is not simulated.
    fn restart(&mut self, _plate: &ModuleBase) {
        self.outputs = 0;
        for channel in &mut self.channels {
            channel.power_cycle();
        }
    }

    fn energise(&mut self, _plate: &ModuleBase, at: &mut Terminals<'_>) {
        for n in 0..2 {
            self.channels[n].seen_us = self.gate_us(n, at);
        }
    }
}
