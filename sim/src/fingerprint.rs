//! A line for storms: every value on it says which module and channel it belongs to, and mostly when it was taken.
//!
//! | address | model | value |
//! |---|---|---|
//! | 01, 02 | I-7017, hex | module 0 or 1 (2 bits), channel (3 bits), time in steps of 16 ms, up and down (11 bits) |
//! | 03 | I-7033, hex | the same with module 2 |
//! | 04, 05 | I-7080 | module (4 bits), channel (1 bit), time in steps of 64 us (27 bits) |
//! | 06, 07 | I-7051 | module (4 bits), time in steps of 512 us (12 bits) |
//! | 08, 09 | I-7043 | module (4 bits), the rest is the host's; so at power-on and when safe |
//! | 0A, 0B | I-7021P, hex | the same |
//!
//! A module is its address from 0 here, but for the analog inputs. Time of analog inputs goes up and down, so that the
//! mean over a window of the converter is a time of that window. What the outputs carry is recorded for the judge.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use crate::config::LineSpec;
use crate::error::SimError;
use crate::fault::LineFaults;
use crate::module::Module;
use crate::module::habit::{self, Habit};
use crate::module::plate::Commissioning;
use crate::rig::{Record, Rig};
use crate::shared::{SharedRig, split};
use crate::terminal::{ModuleSpec, Plant};

/// Name of the line.
pub const LINE: &str = "storm";

/// Steps of time in words of digital inputs, microseconds.
pub const WORD_STEP_US: u64 = 512;

/// Steps of time at analog inputs, microseconds.
pub const ANALOG_STEP_US: u64 = 16_000;

/// Highest time at an analog input before it goes down again. The lowest is 1: a host takes the codes at both ends of
/// a range for over and under range.
const TURN: u64 = 0x7FE;

/// Latency of a module, microseconds, mean and standard deviation.
const LATENCY_US: (f64, f64) = (2_000.0, 200.0);

/// Conversions a second of the voltage modules.
const PER_S: f64 = 60.0;

/// The line and what its outputs carry.
#[derive(Clone)]
pub struct FingerprintLine {
    /// The line, the only one of this rig.
    pub rig: SharedRig,
    outputs: Outputs,
}

/// Changes that are kept of each output; a transaction makes one or two.
const CHANGES: usize = 16;

/// Since when (microseconds) an output carries what, the last change at the end.
type Changes = VecDeque<(u64, u16)>;

/// What the outputs of each module carry and carried.
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
    /// Builds it with checksums, at `baud`, with the faults of lines and modules that are asked for.
    ///
    /// # Errors
    /// A fault is unknown or its value unfit.
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
            let habit = Habit {
                latency_sd_us: LATENCY_US.1,
                normal_per_s: PER_S,
                ..Habit::exact(LATENCY_US.0)
            };
            let rng = habit::stream(seed, &spec.id);
            modules.push(Module::new(&spec, commissioning, habit, rng)?);
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

    /// Whether the outputs of a module carried `word` (bits, or 65535ths of 10 V) at any time between, both included.
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

/// The word of an output of `address` that bears the mark of its module.
pub const fn marked(address: u8, number: u16) -> u16 {
    (address as u16) << 12 | number & 0xFFF
}

/// Where a code of an analog input comes from: address and channel.
pub const fn origin_of_analog(code: u16) -> (u8, u8) {
    ((code >> 14) as u8 + 1, (code >> 11 & 7) as u8)
}

/// Where a count comes from: address and channel.
pub const fn origin_of_count(count: u32) -> (u8, u8) {
    ((count >> 28) as u8, (count >> 27 & 1) as u8)
}

/// Where a word comes from.
pub const fn origin_of_word(word: u16) -> u8 {
    (word >> 12) as u8
}

/// How long before `now_us` a word of digital inputs was taken, microseconds, modulo 2 s; to one step.
pub const fn age_of_word_us(word: u16, now_us: u64) -> u64 {
    ((now_us / WORD_STEP_US).wrapping_sub(word as u64) & 0xFFF) * WORD_STEP_US
}

/// How far the time at an analog input is from that of `at_us`, microseconds.
pub fn distance_of_analog_us(code: u16, at_us: u64) -> u64 {
    u64::from(code & 0x7FF).abs_diff(up_and_down(at_us)) * ANALOG_STEP_US
}

fn up_and_down(t_us: u64) -> u64 {
    let way = TURN - 1;
    let step = t_us / ANALOG_STEP_US % (2 * way);
    1 + if step <= way { step } else { 2 * way - step }
}

fn id(address: u8) -> String {
    format!("{address:02X}")
}

fn spec(address: u8) -> Result<ModuleSpec, SimError> {
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
    let settings = toml::from_str(&table).map_err(|error| SimError::FaultValue {
        name: LINE.into(),
        found: table.clone(),
        expected: error.to_string(),
    })?;
    Ok(ModuleSpec {
        id: id(address),
        line: LINE.into(),
        address,
        model: model.into(),
        settings,
    })
}

/// The world behind the terminals.
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

    fn analog_out(&mut self, module: &str, volts: f64) {
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

impl Record for Fingerprints {
    fn truth(&mut self) -> Vec<serde_json::Value> {
        Vec::new()
    }

    fn crashes(&mut self) -> Vec<String> {
        Vec::new()
    }
}

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
    fn every_input_tells_its_module_and_channel_and_time() {
        let line = FingerprintLine::build(1, 115_200, &[]).unwrap();
        for round in 1..50u64 {
            let now_us = round * 700_000;
            for (address, channels) in [(1, 8), (2, 8), (3, 3)] {
                for channel in 0..channels {
                    let code =
                        hex(&ask(&line, &format!("#{address:02X}{channel}"), now_us), 1) as u16;
                    assert_eq!(origin_of_analog(code), (address, channel));
                    // At most eight windows of 1/60 s, or three of 1/15 s, ago, and to two steps.
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
    fn outputs_bear_the_mark_of_their_module_until_the_host_writes() {
        let line = FingerprintLine::build(1, 115_200, &[]).unwrap();
        for address in 8..=0x0B {
            assert!(line.carried(address, marked(address, 0), 0, 0));
        }
        assert_eq!(ask(&line, "@098123", 2_000), ">");
        assert_eq!(ask(&line, "#0AA123", 3_000), ">");
        assert!(line.carried(9, 0x8123, 2_000, 9_000) && line.carried(0x0A, 0xA123, 3_000, 9_000));
    }

    #[test]
    fn what_an_output_carried_is_known_for_the_time_that_it_did() {
        let line = FingerprintLine::build(1, 115_200, &[]).unwrap();
        assert_eq!(ask(&line, "@098123", 2_000), ">");
        assert_eq!(ask(&line, "@098456", 5_000), ">");
        let carried = |from_us, to_us| line.carried(9, 0x8123, from_us, to_us);
        assert!(carried(2_000, 2_000) && carried(4_000, 9_000) && carried(1_000, 3_000));
        assert!(!carried(0, 1_999) && !carried(5_001, 9_000));
    }
}
