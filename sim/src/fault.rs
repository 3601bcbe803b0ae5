//! Faults of lines and modules: a layer between what a module answers and what the host receives.
//!
//! Faults with a probability strike each reply on its own; faults with a target name a module or a
//! line and, after `@`, the second of rig time at which they begin (0 when left out). Draws come
//! from a stream of their own, so that a fault changes nothing else of the rig.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::error::SimError;
use crate::module::habit;

/// Extra time of a late reply: beyond any time-out, microseconds.
const LATE_US: u64 = 200_000;

/// How long a cut line stays dead, microseconds.
const CUT_US: u64 = 2_000_000;

/// One fault that can be asked for.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct FaultInfo {
    /// Name for `--fault`.
    pub name: String,
    /// Unit or form of the value.
    pub unit: String,
    /// Value when none is given.
    pub default: String,
    /// What happens.
    pub what: String,
}

/// Name, unit, default and effect of the faults of this layer.
const LIST: [(&str, &str, &str, &str); 14] = [
    ("drop", "probability", "0.01", "a reply is lost"),
    ("late", "probability", "0.01", "a reply comes 200 ms late"),
    ("delay", "ms", "20", "every reply takes so much longer"),
    (
        "flip",
        "probability",
        "0.01",
        "one bit of a reply is flipped",
    ),
    ("truncate", "probability", "0.01", "a reply breaks off"),
    (
        "noise",
        "probability",
        "0.01",
        "one to four random bytes before a reply",
    ),
    (
        "echo",
        "probability",
        "1",
        "the request comes back before the reply",
    ),
    (
        "silence",
        "MODULE[@s]",
        "board_di@0",
        "a module is silent for good",
    ),
    (
        "wrong_type",
        "MODULE",
        "board_di",
        "another product sits at the address",
    ),
    (
        "clash",
        "MODULE",
        "board_di",
        "two modules answer at one address",
    ),
    ("reset", "MODULE[@s]", "board_do@5", "a module restarts"),
    (
        "watchdog_trip",
        "MODULE[@s]",
        "board_do@5",
        "a host watchdog expires early",
    ),
    (
        "baud_mismatch",
        "LINE[@s]",
        "measure@0",
        "the modules of a line run at another baud rate",
    ),
    (
        "line_cut",
        "LINE[@s]",
        "measure@5",
        "a line is dead for two seconds",
    ),
];

/// Names, units and defaults of the faults of this layer.
pub fn list() -> Vec<FaultInfo> {
    LIST.iter()
        .map(|(name, unit, default, what)| FaultInfo {
            name: (*name).into(),
            unit: (*unit).into(),
            default: (*default).into(),
            what: (*what).into(),
        })
        .collect()
}

/// A thing that happens to one module or line from an instant on.
#[derive(Debug, Clone, PartialEq)]
pub struct Timed {
    /// Rig time, microseconds.
    pub at_us: u64,
    /// Identifier of the module or line.
    pub target: String,
    /// What happens.
    pub event: Event,
}

/// Kinds of [`Timed`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Module restarts.
    Reset,
    /// Host watchdog expires.
    Trip,
}

/// All faults of this layer.
pub struct Faults {
    rng: ChaCha8Rng,
    drop: f64,
    late: f64,
    delay_us: u64,
    flip: f64,
    truncate: f64,
    noise: f64,
    echo: f64,
    silent: Vec<(String, u64)>,
    /// Lines that carry nothing, from and until.
    cut: Vec<(String, u64, u64)>,
    /// Modules that pose as another product.
    pub wrong_type: Vec<String>,
    clash: Vec<String>,
    /// In order of time.
    pub timed: Vec<Timed>,
    any: bool,
}

impl Faults {
    /// None at all.
    pub fn none(seed: u64) -> Self {
        Self {
            rng: habit::stream(seed, "faults of the line"),
            drop: 0.0,
            late: 0.0,
            delay_us: 0,
            flip: 0.0,
            truncate: 0.0,
            noise: 0.0,
            echo: 0.0,
            silent: Vec::new(),
            cut: Vec::new(),
            wrong_type: Vec::new(),
            clash: Vec::new(),
            timed: Vec::new(),
            any: false,
        }
    }

    /// Adds one; `false` when the name is none of this layer's.
    ///
    /// # Errors
    /// The value does not have the form of the fault.
    pub fn add(&mut self, name: &str, value: Option<&str>) -> Result<bool, SimError> {
        let Some((_, unit, default, _)) = LIST.iter().find(|(known, ..)| *known == name) else {
            return Ok(false);
        };
        self.any = true;
        let value = value.unwrap_or(default);
        match *unit {
            "probability" => self.set_probability(name, probability(name, value)?),
            "ms" => self.delay_us = (number(name, value)?.max(0.0) * 1e3).round() as u64,
            _ => self.set_target(name, value)?,
        }
        Ok(true)
    }

    fn set_probability(&mut self, name: &str, probability: f64) {
        let place = match name {
            "drop" => &mut self.drop,
            "late" => &mut self.late,
            "flip" => &mut self.flip,
            "truncate" => &mut self.truncate,
            "noise" => &mut self.noise,
            _ => &mut self.echo,
        };
        *place = probability;
    }

    fn set_target(&mut self, name: &str, value: &str) -> Result<(), SimError> {
        let (target, seconds) = match value.split_once('@') {
            Some((target, seconds)) => (target.to_owned(), number(name, seconds)?),
            None => (value.to_owned(), 0.0),
        };
        let at_us = (seconds.max(0.0) * 1e6).round() as u64;
        let timed = |event| Timed {
            at_us,
            target: target.clone(),
            event,
        };
        match name {
            "silence" => self.silent.push((target, at_us)),
            "line_cut" => self.cut.push((target, at_us, at_us + CUT_US)),
            "baud_mismatch" => self.cut.push((target, at_us, u64::MAX)),
            "wrong_type" => self.wrong_type.push(target),
            "clash" => self.clash.push(target),
            "reset" => self.timed.push(timed(Event::Reset)),
            _ => self.timed.push(timed(Event::Trip)),
        }
        self.timed.sort_by_key(|timed| timed.at_us);
        Ok(())
    }

    /// Every module or line that a fault names, with the fault's unit.
    pub fn targets(&self) -> impl Iterator<Item = &str> {
        let named = self.silent.iter().map(|(target, _)| target);
        let timed = self.timed.iter().map(|timed| &timed.target);
        let plain = self.wrong_type.iter().chain(&self.clash);
        let lines = self.cut.iter().map(|(target, ..)| target);
        named
            .chain(lines)
            .chain(timed)
            .chain(plain)
            .map(String::as_str)
    }

    /// The line carries nothing now.
    pub fn line_dead(&self, line: &str, now_us: u64) -> bool {
        self.cut
            .iter()
            .any(|(cut, from, until)| cut == line && (*from..*until).contains(&now_us))
    }

    /// The module hears, but is silent.
    pub fn silent(&self, module: &str, now_us: u64) -> bool {
        self.silent
            .iter()
            .any(|(silent, from)| silent == module && *from <= now_us)
    }

    /// A second module answers at the same address.
    pub fn clashes(&self, module: &str) -> bool {
        self.clash.iter().any(|clash| clash == module)
    }

    /// What becomes of a reply: extra microseconds and the bytes, `None` when it is lost.
    pub fn strike(&mut self, request: &[u8], mut reply: Vec<u8>) -> Option<(u64, Vec<u8>)> {
        if !self.any {
            return Some((0, reply));
        }
        if self.happens(self.drop) {
            return None;
        }
        if self.happens(self.flip) {
            let bit = self.rng.random_range(0..reply.len() * 8);
            reply[bit / 8] ^= 1 << (bit % 8);
        }
        if self.happens(self.truncate) {
            let left = self.rng.random_range(0..reply.len());
            reply.truncate(left);
        }
        if self.happens(self.noise) {
            let count = self.rng.random_range(1..=4);
            let noise: Vec<u8> = (0..count).map(|_| self.rng.random()).collect();
            reply.splice(0..0, noise);
        }
        if self.happens(self.echo) {
            reply.splice(0..0, request.iter().copied().chain([b'\r']));
        }
        let late_us = if self.happens(self.late) { LATE_US } else { 0 };
        (!reply.is_empty()).then_some((self.delay_us + late_us, reply))
    }

    /// Two transmitters on one pair: a dominant level wins bit by bit.
    pub fn collide(reply: &mut Vec<u8>, other: &[u8]) {
        for (place, byte) in other.iter().enumerate() {
            match reply.get_mut(place) {
                Some(mine) => *mine &= byte,
                None => reply.push(*byte),
            }
        }
    }

    fn happens(&mut self, probability: f64) -> bool {
        probability > 0.0 && self.rng.random::<f64>() < probability
    }
}

fn number(name: &str, value: &str) -> Result<f64, SimError> {
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(wrong(name, value, "a number")),
    }
}

fn probability(name: &str, value: &str) -> Result<f64, SimError> {
    let probability = number(name, value)?;
    if (0.0..=1.0).contains(&probability) {
        Ok(probability)
    } else {
        Err(wrong(name, value, "a probability from 0 to 1"))
    }
}

fn wrong(name: &str, found: &str, expected: &str) -> SimError {
    SimError::FaultValue {
        name: name.into(),
        found: found.into(),
        expected: expected.into(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_listed_fault_can_be_asked_for_without_a_value() {
        for fault in list() {
            assert!(
                Faults::none(1).add(&fault.name, None).unwrap(),
                "{}",
                fault.name
            );
        }
        assert!(!Faults::none(1).add("jam", None).unwrap());
    }

    #[test]
    fn a_probability_is_checked() {
        assert!(Faults::none(1).add("drop", Some("1.5")).is_err());
        assert!(Faults::none(1).add("silence", Some("timer@soon")).is_err());
    }

    #[test]
    fn a_cut_line_comes_back_after_two_seconds() {
        let mut faults = Faults::none(1);
        faults.add("line_cut", Some("motion@1")).unwrap();
        assert!(!faults.line_dead("motion", 999_999));
        assert!(faults.line_dead("motion", 1_000_000));
        assert!(!faults.line_dead("measure", 1_000_000));
        assert!(!faults.line_dead("motion", 3_000_000));
    }

    #[test]
    fn a_flip_changes_one_bit_and_a_truncation_never_leaves_all() {
        let mut faults = Faults::none(7);
        faults.add("flip", Some("1")).unwrap();
        let (_, bytes) = faults.strike(b"#01", b">+05.123\r".to_vec()).unwrap();
        let differing: u32 = bytes
            .iter()
            .zip(b">+05.123\r")
            .map(|(a, b)| (a ^ b).count_ones())
            .sum();
        assert_eq!(differing, 1);
        let mut faults = Faults::none(7);
        faults.add("truncate", Some("1")).unwrap();
        let left = faults.strike(b"#01", b">+05.123\r".to_vec());
        assert!(left.is_none_or(|(_, bytes)| bytes.len() < 9));
    }
}
