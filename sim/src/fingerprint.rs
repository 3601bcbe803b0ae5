//! A line for fuzz tests: every value identifies its module and channel, and most values also their time.
//!
//! | address | model | value |
//! |---|---|---|
//! | 01, 02 | I-7017, hex | module 0 or 1 (2 bits), channel (3 bits), time in steps of 16 ms, up and down (11 bits) |
//! | 03 | I-7033, hex | the same with module 2 |
//! | 04, 05 | I-7080 | module (4 bits), channel (1 bit), time in steps of 64 us (27 bits) |
//! | 06, 07 | I-7051 | module (4 bits), time in steps of 512 us (12 bits) |
//! | 08, 09 | I-7043 | module (4 bits), a number that the host writes (12 bits); number 0 at power-on and when safe |
//! | 0A, 0B | I-7021P, hex | as I-7043 |
//!
//! The module number is the address; at analog inputs, the address less one. Time at an analog input rises and falls as
//! a triangle, so that the mean over a converter window equals the time within that window. The line also records its
//! output words, so that a test can check them.

use std::collections::{BTreeMap, VecDeque};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use crate::config::{ConfigError, LineSpec};
use crate::error::SimError;
use crate::fault::LineFaults;
use crate::module::Module;
use crate::module::base::Commissioning;
use crate::module::tolerances::{self, Tolerances};
use crate::rig::Rig;
use crate::shared::{SharedRig, split};
use crate::table::Table;
use crate::terminal::{ModuleSpec, Plant};
use crate::truth::WorldRecord;

/// Name of the line.
pub const LINE: &str = "storm";

/// Step of the time that words of digital inputs carry, microseconds.
pub const WORD_STEP_US: u64 = 512;

/// Step of the time that values of analog inputs carry, microseconds.
pub const ANALOG_STEP_US: u64 = 16_000;

/// Highest time code at an analog input, the top of the triangle. The lowest is 1: a host reads the codes at the ends
/// of the range as under range and over range.
const PEAK: u64 = 0x7FE;

/// Latency of a module, microseconds: mean and standard deviation.
const LATENCY_US: (f64, f64) = (2_000.0, 200.0);

/// Conversions per second of the voltage modules.
const PER_S: f64 = 60.0;

/// The simulated line and the history of its outputs.
#[derive(Clone)]
pub struct FingerprintLine {
    /// Rig that has this line only.
    pub rig: SharedRig,
    outputs: Outputs,
}

/// Number of changes that the history keeps per output; a transaction makes one or two.
const CHANGES: usize = 16;

/// Output words with the instant (microseconds) at which each appeared, oldest first.
type Changes = VecDeque<(u64, u16)>;

/// Output history of every module, by identifier.
#[derive(Clone, Default)]
struct Outputs(Arc<Mutex<BTreeMap<String, Changes>>>);

impl Outputs {
    fn put(&self, module: &str, word: u16, at_us: u64) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let changes = all.entry(module.to_owned()).or_default();
        if changes.back().is_none_or(|(_, last)| *last != word) {
            changes.push_back((at_us, word));
        }
        if changes.len() > CHANGES {
            changes.pop_front();
        }
    }
}

impl FingerprintLine {
    /// Builds the line with checksums, at `baud` bits per second, with faults of lines and modules.
    ///
    /// # Errors
    /// Fails when a fault is unknown or its value is unfit.
    pub fn build(seed: u64, baud: u32, faults: &[&str]) -> Result<Self, SimError> {
        let mut on_the_line = LineFaults::none(seed);
        for text in faults {
            let (name, value) = split(text);
            if !on_the_line.add(name, value)? {
                return Err(SimError::UnknownFault { name: name.into() });
            }
        }
        let commissioning = Commissioning {
            baud,
            checksum: true,
            host_watchdog_ms: 25_500.0,
        };
        let mut modules = Vec::new();
        for address in 0x01..=0x0B {
            let spec = spec(address)?;
            let tolerances = Tolerances {
                latency_sd_us: LATENCY_US.1,
                normal_per_s: PER_S,
                ..Tolerances::exact(LATENCY_US.0)
            };
            let rng = tolerances::stream(seed, &spec.id);
            modules.push(Module::new(&spec, commissioning, tolerances, rng)?);
        }
        let line = LineSpec {
            name: LINE.into(),
            baud,
            checksum: true,
        };
        let outputs = Outputs::default();
        let world = Fingerprints {
            now_us: 0,
            outputs: outputs.clone(),
        };
        let rig = Rig::new(Box::new(world), modules, vec![line], on_the_line);
        Ok(Self {
            rig: SharedRig::new(rig),
            outputs,
        })
    }

    /// Checks whether the outputs of a module carried `word` (bits, or 65535ths of 10 V) at any time from `from_us`
    /// to `to_us`, ends included.
    pub fn carried(&self, address: u8, word: u16, from_us: u64, to_us: u64) -> bool {
        let all = self
            .outputs
            .0
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let Some(changes) = all.get(&id(address)) else {
            return false;
        };
        let ends = changes.iter().skip(1).map(|(at_us, _)| *at_us);
        let spans = changes.iter().zip(ends.chain([u64::MAX]));
        let mut then =
            spans.filter(|((begin_us, _), end_us)| *begin_us <= to_us && *end_us >= from_us);
        then.any(|((_, carried), _)| *carried == word)
    }
}

/// Returns the output word with the mark of the module at `address` and the given number.
pub const fn marked(address: u8, number: u16) -> u16 {
    (address as u16) << 12 | number & 0xFFF
}

/// Returns the address and channel that an analog code identifies.
pub const fn origin_of_analog(code: u16) -> (u8, u8) {
    ((code >> 14) as u8 + 1, (code >> 11 & 7) as u8)
}

/// Returns the address and channel that a count identifies.
pub const fn origin_of_count(count: u32) -> (u8, u8) {
    ((count >> 28) as u8, (count >> 27 & 1) as u8)
}

/// Returns the address that a word identifies.
pub const fn origin_of_word(word: u16) -> u8 {
    (word >> 12) as u8
}

/// Returns the age of a digital input word at `now_us`, microseconds, modulo 2 s; its resolution is [`WORD_STEP_US`].
pub const fn age_of_word_us(word: u16, now_us: u64) -> u64 {
    ((now_us / WORD_STEP_US).wrapping_sub(word as u64) & 0xFFF) * WORD_STEP_US
}

/// Returns the time difference between an analog code and `at_us`, microseconds.
pub fn distance_of_analog_us(code: u16, at_us: u64) -> u64 {
    u64::from(code & 0x7FF).abs_diff(up_and_down(at_us)) * ANALOG_STEP_US
}

fn up_and_down(t_us: u64) -> u64 {
    let way = PEAK - 1;
    let step = t_us / ANALOG_STEP_US % (2 * way);
    1 + if step <= way { step } else { 2 * way - step }
}

fn id(address: u8) -> String {
    format!("{address:02X}")
}

fn spec(address: u8) -> Result<ModuleSpec, ConfigError> {
    let tag = u32::from(address) << 28;
    let marked = marked(address, 0);
    let volts = f64::from(marked) / 65_535.0 * 10.0;
    let (model, table) = match address {
        0x01 | 0x02 => ("I-7017", "format = \"hex\"".to_owned()),
        0x03 => ("I-7033", "format = \"hex\"".to_owned()),
        0x04 | 0x05 => (
            "I-7080",
            format!(
                "gate = \"none\"\ninputs = [15625, 15625]\npreset = [{tag}, {}]\nmaximum = [{}, {}]",
                tag | 1 << 27,
                tag | 0x07FF_FFFF,
                tag | 0x0FFF_FFFF,
            ),
        ),
        0x06 | 0x07 => ("I-7051", String::new()),
        0x08 | 0x09 => (
            "I-7043",
            format!("power_on = {marked}\nsafe = {marked}\nwatchdog = true"),
        ),
        _ => (
            "I-7021P",
            format!("format = \"hex\"\npower_on = {volts:?}\nsafe = {volts:?}\nwatchdog = true"),
        ),
    };
    Ok(ModuleSpec {
        id: id(address),
        line: LINE.into(),
        address,
        model: model.into(),
        settings: Table::parse(Path::new(LINE), &table)?,
    })
}

/// Signals at the terminals of the line; each identifies its module and channel.
struct Fingerprints {
    now_us: u64,
    outputs: Outputs,
}

fn address_of(module: &str) -> u8 {
    u8::from_str_radix(module, 16).unwrap_or(0)
}

impl Plant for Fingerprints {
    fn advance(&mut self, t_us: u64) {
        self.now_us = t_us;
    }

    fn analog_in(&mut self, module: &str, channel: u8) -> f64 {
        let address = address_of(module);
        let time = up_and_down(self.now_us) as u16;
        let code = u16::from(address - 1) << 14 | u16::from(channel) << 11 | time;
        let full_scale = if address == 3 { 100.0 } else { 10.0 };
        f64::from(code.cast_signed()) / 32_768.0 * full_scale
    }

    fn analog_out(&mut self, module: &str, _channel: u8, volts: f64) {
        let code = (volts / 10.0 * 65_535.0).round() as u16;
        self.outputs.put(module, code, self.now_us);
    }

    fn digital_in(&mut self, module: &str) -> u16 {
        marked(address_of(module), (self.now_us / WORD_STEP_US) as u16)
    }

    fn digital_out(&mut self, module: &str, bits: u16) {
        self.outputs.put(module, bits, self.now_us);
    }

    fn edges(&mut self, _module: &str, _channel: u8) -> u64 {
        0
    }

    fn gate_open_us(&mut self, _module: &str, _channel: u8) -> f64 {
        0.0
    }

    fn reference_clock_hz(&self) -> f64 {
        0.0
    }
}

impl WorldRecord for Fingerprints {}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn ask(line: &FingerprintLine, text: &str, at_us: u64) -> String {
        let text = crate::dcon::framed(text.into(), true);
        let reply = line
            .rig
            .exchange(0, &text[..text.len() - 1], at_us)
            .unwrap();
        String::from_utf8(reply.bytes[..reply.bytes.len() - 3].to_vec()).unwrap()
    }

    fn hex(reply: &str, at: usize) -> u32 {
        u32::from_str_radix(&reply[at..], 16).unwrap()
    }

    #[test]
    fn every_input_identifies_module_channel_and_time() {
        let line = FingerprintLine::build(1, 115_200, &[]).unwrap();
        for round in 1..50u64 {
            let now_us = round * 700_000;
            for (address, channels) in [(1, 8), (2, 8), (3, 3)] {
                for channel in 0..channels {
                    let code =
                        hex(&ask(&line, &format!("#{address:02X}{channel}"), now_us), 1) as u16;
                    assert_eq!(origin_of_analog(code), (address, channel));
                    // A result is at most eight windows of 1/60 s, or three of 1/15 s, old; the bound adds two steps of
                    // tolerance.
                    assert!(distance_of_analog_us(code, now_us) <= 250_000, "{code:04X}");
                }
            }
            for address in [6, 7] {
                let word = hex(&ask(&line, &format!("@{address:02X}"), now_us), 1) as u16;
                assert_eq!(
                    (origin_of_word(word), age_of_word_us(word, now_us)),
                    (address, 0)
                );
            }
            for (address, channel) in [(4, 0), (4, 1), (5, 0), (5, 1)] {
                let count = hex(&ask(&line, &format!("#{address:02X}{channel}"), now_us), 1);
                assert_eq!(origin_of_count(count), (address, channel));
            }
        }
    }

    #[test]
    fn outputs_carry_their_mark_until_the_host_writes() {
        let line = FingerprintLine::build(1, 115_200, &[]).unwrap();
        for address in 8..=0x0B {
            assert!(line.carried(address, marked(address, 0), 0, 0));
        }
        assert_eq!(ask(&line, "@098123", 2_000), ">");
        assert_eq!(ask(&line, "#0AA123", 3_000), ">");
        assert!(line.carried(9, 0x8123, 2_000, 9_000) && line.carried(0x0A, 0xA123, 3_000, 9_000));
    }

    #[test]
    fn the_output_history_covers_the_time_of_each_word() {
        let line = FingerprintLine::build(1, 115_200, &[]).unwrap();
        assert_eq!(ask(&line, "@098123", 2_000), ">");
        assert_eq!(ask(&line, "@098456", 5_000), ">");
        let carried = |from_us, to_us| line.carried(9, 0x8123, from_us, to_us);
        assert!(carried(2_000, 2_000) && carried(4_000, 9_000) && carried(1_000, 3_000));
        assert!(!carried(0, 1_999) && !carried(5_001, 9_000));
    }
}
