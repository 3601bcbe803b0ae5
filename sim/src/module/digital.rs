//! Digital inputs and outputs: 7041 to 7067.
//!
//! | request | reply |
//! |---|---|
//! | `@AA`, `$AA6` | `>` or `!` (then 00 at the end), first and second byte |
//! | `@AA(data)` | set all outputs; 1, 2 or 4 digits by model; `?` for a wrong width |
//! | `#AABBDD` | set a group (00, 0A, 0B) or one channel (1c, Ac, Bc) |
//! | `#AAN`, `$AACN` | read the event counter of an input, 5 decimal digits; clear it |
//! | `$AALS`, `$AAC` | read the inputs latched high (S = 1) or low (0); clear both |
//! | `$AA4` | inputs at the last `#**`; `?AA` when there was none |
//! | `~AA5P`, `~AA5S`, `~AA4P`, `~AA4S` | store and read power-on and safe outputs |
//!
//! The first byte holds the outputs and the second the inputs; on modules with more than eight inputs or outputs, the
//! first is the high byte and the second the low byte. The 7052 has only eight inputs: they are its first byte, and the
//! second is 00. Latches record every change that a request finds and every counted pulse; an input that has not
//! changed since the last `$AAC` sets no latch.

use super::base::{Commissioning, ModuleBase};
use super::shape::{Shape, ones};
use super::{Built, Family, Terminals, setting};
use crate::config::ConfigError;
use crate::dcon::{self, Answer, Request};
use crate::table::{Entry, Table};
use crate::terminal::ModuleSpec;

struct Digital {
    shape: Shape,
    /// True when the answer to a refused output command contains the module's address.
    names_refusals: bool,
    outputs: u16,
    power_on: u16,
    safe: u16,
    /// Inputs at the last update.
    levels: u16,
    latched_high: u16,
    latched_low: u16,
    counters: Vec<EventCounter>,
    sampled: Option<Sample>,
}

#[derive(Debug, Clone, Copy, Default)]
struct EventCounter {
    /// Count at the instant when the terminal had seen `from_edges` edges.
    start: u64,
    from_edges: u64,
    /// Number of edges at the last update; a difference sets the latches.
    seen_edges: u64,
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    data: u16,
    unread: bool,
}

/// Builds a digital module from its table.
pub(super) fn build(
    spec: &ModuleSpec,
    shape: Shape,
    line: Commissioning,
) -> Result<Built, ConfigError> {
    let keys = &spec.settings;
    let key = setting::either(keys, "type", "range")?;
    let type_code = setting::code(keys, key, 0xFF)?.unwrap_or(0x40);
    if type_code != 0x40 {
        return Err(keys.wrong(key, "\"40\""));
    }
    let mut base = ModuleBase::new(spec, line, type_code, 0)?;
    let names_refusals = setting::word(keys, "refusal", &["?", "?AA"])? == Some(1);
    let [power_on, safe, outputs] = output_words(keys, shape)?;
    let mut family = Digital {
        shape,
        names_refusals,
        outputs: 0,
        power_on: power_on.unwrap_or(0),
        safe: safe.unwrap_or(0),
        levels: 0,
        latched_high: 0,
        latched_low: 0,
        counters: Vec::new(),
        sampled: None,
    };
    family.restart(&base);
    family.outputs = outputs.unwrap_or(family.outputs);
    if shape.inputs > 0 {
        base.inputs = family.read_inputs(keys)?;
        if keys.get_or("rising", false)? {
            base.format |= 0x80;
        }
    }
    Ok((base, Box::new(family)))
}

/// Reads the power-on, safe and present outputs.
fn output_words(keys: &Table, shape: Shape) -> Result<[Option<u16>; 3], ConfigError> {
    if shape.outputs == 0 {
        return Ok([None; 3]);
    }
    let safe = setting::either(keys, "safe", "safe_outputs")?;
    let bits = |key| setting::bits(keys, key, shape.all_outputs());
    Ok([bits("power_on")?, bits(safe)?, bits("outputs")?])
}

impl Digital {
    /// Reads the keys of counters and latches, and returns the signals at the inputs. `latches` is a mask (latched
    /// high), or a table with `high` and `low`.
    fn read_inputs(&mut self, keys: &Table) -> Result<Vec<f64>, ConfigError> {
        let inputs = self.shape.inputs;
        let is_level = |level: f64| level == 0.0 || level == 1.0 || level.is_nan();
        let signals = setting::values(keys, "inputs", inputs.into(), "levels 0 or 1", is_level)?;
        let counts = setting::counts(keys, "counts", inputs.into(), 0..=65_535)?;
        let counter = |channel: u8| EventCounter {
            start: counts
                .get(usize::from(channel))
                .map_or(0, |it| (*it).into()),
            ..EventCounter::default()
        };
        self.counters = (0..inputs).map(counter).collect();
        let bits = |keys: &Table, key| setting::bits(keys, key, ones(inputs));
        match keys.find("latches").map(Entry::table) {
            Some(Ok(own)) => {
                self.latched_high = bits(own, "high")?.unwrap_or(0);
                self.latched_low = bits(own, "low")?.unwrap_or(0);
                own.finish()?;
            }
            Some(Err(_)) | None => self.latched_high = bits(keys, "latches")?.unwrap_or(0),
        }
        Ok(signals)
    }

    /// Returns the present inputs and updates the latches.
    fn inputs(&mut self, at: &mut Terminals<'_>) -> u16 {
        if self.shape.inputs == 0 {
            return 0;
        }
        let levels = at.plant.digital_in(at.module) & ones(self.shape.inputs);
        self.latched_high |= levels & !self.levels;
        self.latched_low |= !levels & self.levels;
        self.levels = levels;
        levels
    }

    /// Sets the latches for pulses that began and ended between two requests.
    fn latch_edges(&mut self, at: &mut Terminals<'_>) {
        for (channel, counter) in self.counters.iter_mut().enumerate() {
            let edges = at.plant.edges(at.module, channel as u8);
            if edges != counter.seen_edges {
                counter.seen_edges = edges;
                self.latched_high |= 1 << channel;
                self.latched_low |= 1 << channel;
            }
        }
    }

    fn words(&mut self, at: &mut Terminals<'_>) -> u16 {
        let inputs = self.inputs(at);
        self.shape.first_and_second(inputs, self.outputs)
    }

    fn drive(&mut self, outputs: u16, at: &mut Terminals<'_>) {
        self.outputs = outputs;
        if self.shape.outputs > 0 {
            at.plant.digital_out(at.module, outputs);
        }
    }

    /// Refuses an output command; by the manuals, digital modules answer without the address, the others with it.
    fn refused_output(&self, base: &ModuleBase) -> Answer {
        if self.names_refusals {
            dcon::refused(base.address)
        } else {
            dcon::refused_output()
        }
    }

    fn write_all(&mut self, base: &ModuleBase, data: &[u8], at: &mut Terminals<'_>) -> Answer {
        let Some(value) = dcon::hex(data) else {
            return Answer::Unknown;
        };
        let too_much = value & !u32::from(self.shape.all_outputs()) != 0;
        if self.shape.outputs == 0 || data.len() != self.shape.output_digits() || too_much {
            return self.refused_output(base);
        }
        if base.watchdog.tripped() {
            return dcon::ignored();
        }
        self.drive(value as u16, at);
        dcon::accepted()
    }

    fn write_group(&mut self, base: &ModuleBase, body: [u8; 4], at: &mut Terminals<'_>) -> Answer {
        let [group, channel, high, low] = body;
        let (Some(channel), Some(data)) = (dcon::hex_digit(channel), dcon::hex_byte(&[high, low]))
        else {
            return Answer::Unknown;
        };
        let Some(outputs) = self.grouped(group, channel, data) else {
            return self.refused_output(base);
        };
        if base.watchdog.tripped() {
            return dcon::ignored();
        }
        self.drive(outputs, at);
        dcon::accepted()
    }

    /// Returns the outputs after a group or single-channel command; `None` when the group or channel does not exist.
    fn grouped(&self, group: u8, channel: u8, data: u8) -> Option<u16> {
        let all = self.shape.all_outputs();
        let (mask, bits): (u16, u16) = match (group, channel) {
            (b'0', 0x0 | 0xA) => (0x00FF, u16::from(data)),
            (b'0', 0xB) if self.shape.outputs > 8 => (0xFF00, u16::from(data) << 8),
            (b'1' | b'A', 0..=7) if data <= 1 => (1 << channel, u16::from(data) << channel),
            (b'B', 0..=7) if data <= 1 && self.shape.outputs > 8 => {
                (0x100 << channel, u16::from(data) << (8 + channel))
            }
            (_, _) => return None,
        };
        let single = mask.count_ones() == 1;
        let reachable = bits & !all == 0 && (!single || mask & all != 0) && all != 0;
        reachable.then_some((self.outputs & !mask | bits) & all)
    }

    fn count(&mut self, base: &ModuleBase, digit: u8, at: &mut Terminals<'_>) -> Answer {
        let Some(channel) = dcon::hex_digit(digit) else {
            return Answer::Unknown;
        };
        let Some(counter) = self.counters.get(usize::from(channel)) else {
            return dcon::refused(base.address);
        };
        let edges = at.plant.edges(at.module, channel);
        let count = (counter.start + edges - counter.from_edges) % 65_536;
        dcon::done_data(base.address, &format!("{count:05}"))
    }

    fn clear_count(&mut self, base: &ModuleBase, digit: u8, at: &mut Terminals<'_>) -> Answer {
        let Some(channel) = dcon::hex_digit(digit) else {
            return Answer::Unknown;
        };
        let Some(counter) = self.counters.get_mut(usize::from(channel)) else {
            return dcon::refused(base.address);
        };
        counter.start = 0;
        counter.from_edges = at.plant.edges(at.module, channel);
        dcon::done(base.address)
    }

    fn latched(&mut self, high: bool, at: &mut Terminals<'_>) -> Answer {
        self.inputs(at);
        self.latch_edges(at);
        let latched = if high {
            self.latched_high
        } else {
            self.latched_low
        };
        data_reply(self.shape.first_and_second(latched, 0))
    }

    fn clear_latches(&mut self, base: &ModuleBase, at: &mut Terminals<'_>) -> Answer {
        self.inputs(at);
        self.latch_edges(at);
        self.latched_high = 0;
        self.latched_low = 0;
        dcon::done(base.address)
    }

    fn sampled(&mut self, base: &ModuleBase) -> Answer {
        let Some(sample) = &mut self.sampled else {
            return dcon::refused(base.address);
        };
        let unread = std::mem::take(&mut sample.unread);
        let mut text = String::from(if unread { "!1" } else { "!0" });
        dcon::push_hex(&mut text, u64::from(sample.data) << 8, 6);
        Answer::Reply(text)
    }

    fn store(&mut self, base: &mut ModuleBase, which: u8) -> Answer {
        match which {
            b'P' => self.power_on = self.outputs,
            _ => self.safe = self.outputs,
        }
        base.eeprom_writes += 1;
        dcon::done(base.address)
    }

    fn stored(&self, base: &ModuleBase, which: u8) -> Answer {
        let value = u64::from(if which == b'P' {
            self.power_on
        } else {
            self.safe
        });
        let wide = self.shape.outputs > 8;
        dcon::done_hex(base.address, if wide { value } else { value << 8 }, 4)
    }

    fn input_command(&mut self, base: &ModuleBase, body: &[u8], at: &mut Terminals<'_>) -> Answer {
        match body {
            [b'C', digit] => self.clear_count(base, *digit, at),
            [b'C'] => self.clear_latches(base, at),
            [b'L', level @ (b'0' | b'1')] => self.latched(*level == b'1', at),
            _ => Answer::Unknown,
        }
    }
}

/// Builds `!(first)(second)00`, a data reply without address.
fn data_reply(words: u16) -> Answer {
    let mut text = String::from("!");
    dcon::push_hex(&mut text, u64::from(words) << 8, 6);
    Answer::Reply(text)
}

impl Family for Digital {
    fn fits(&self, type_code: u8, _format: u8) -> bool {
        type_code == 0x40
    }

    fn answer(
        &mut self,
        base: &mut ModuleBase,
        request: &Request<'_>,
        at: &mut Terminals<'_>,
    ) -> Answer {
        let has_inputs = self.shape.inputs > 0;
        match (request.lead, request.body) {
            (b'@', []) => {
                let mut text = String::from(">");
                dcon::push_hex(&mut text, u64::from(self.words(at)), 4);
                Answer::Reply(text)
            }
            (b'@', data) => self.write_all(base, data, at),
            (b'#', [a, b, c, d]) => self.write_group(base, [*a, *b, *c, *d], at),
            (b'#', [digit]) if has_inputs => self.count(base, *digit, at),
            (b'$', b"6") => {
                let words = self.words(at);
                data_reply(words)
            }
            (b'$', b"4") => self.sampled(base),
            (b'$', body) if has_inputs => self.input_command(base, body, at),
            (b'~', [b'5', which @ (b'P' | b'S')]) => self.store(base, *which),
            (b'~', [b'4', which @ (b'P' | b'S')]) => self.stored(base, *which),
            (_, _) => Answer::Unknown,
        }
    }

    fn configured(&mut self, _plate: &ModuleBase, _at: &mut Terminals<'_>) {}

    fn next_us(&self) -> u64 {
        u64::MAX
    }

    fn run(&mut self, _plate: &ModuleBase, _at: &mut Terminals<'_>) {}

    fn sample(&mut self, at: &mut Terminals<'_>) {
        let data = self.words(at);
        self.sampled = Some(Sample { data, unread: true });
    }

    fn make_safe(&mut self, _plate: &ModuleBase, at: &mut Terminals<'_>) {
        self.drive(self.safe, at);
    }

    fn restart(&mut self, base: &ModuleBase) {
        self.outputs = if base.watchdog.tripped() {
            self.safe
        } else {
            self.power_on
        };
        self.sampled = None;
    }

    fn energise(&mut self, _plate: &ModuleBase, at: &mut Terminals<'_>) {
        if self.shape.inputs > 0 {
            self.levels = at.plant.digital_in(at.module) & ones(self.shape.inputs);
        }
        self.drive(self.outputs, at);
    }
}
