//! What a test saw, sample by sample: the evidence that stays when the part is rejected.
//!
//! Analog samples and counts as they were read, what was asked of sources and of the outputs that a kind wants
//! traced, and inputs that are looked at together. Bits are told when they change and once more at the last look before
//! the next change, so that a poll of many milliseconds takes two samples. Of one test at most [`MOST`]
//! samples are kept, the first ones; a test of the default recipe has some 150.

use crate::rig::point::{AnalogOutput, DigitalOutput, Quantity};
use crate::rig::sample::{CountSample, Quality, Sample};
use crate::rig::wiring::Wiring;
use units::{RigTime, Volt};

/// Samples of one test, all signals together.
pub const MOST: usize = 1_000;

/// What was seen, as the point declares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// Name of its point.
    pub name: &'static str,
    /// Unit of its values; empty for bits and counts.
    pub unit: &'static str,
    /// Step that its values are kept in: a tenth or less of a step of its converter.
    pub step: f64,
    /// Told at its changes only.
    stands: bool,
}

impl Signal {
    /// What a source was asked for, volts of the supply.
    pub const fn source(name: &'static str) -> Self {
        Self {
            name,
            unit: "V",
            step: 1e-5,
            stands: false,
        }
    }

    /// An analog input in its unit, before correction.
    pub const fn input(quantity: Quantity) -> Self {
        Self {
            name: quantity.name,
            unit: quantity.unit,
            step: quantity.step,
            stands: false,
        }
    }

    /// A gated counter.
    pub const fn count(name: &'static str) -> Self {
        Self {
            name,
            unit: "",
            step: 1.0,
            stands: false,
        }
    }

    /// An output, 0 off and 1 on, or inputs that are looked at together, a bit each.
    pub const fn bits(name: &'static str) -> Self {
        Self {
            name,
            unit: "",
            step: 1.0,
            stands: true,
        }
    }
}

/// One look at one signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// At what.
    pub signal: Signal,
    /// When the module was asked; of an output, when it had answered.
    pub at: RigTime,
    /// In the unit of the signal; not a number where the converter gave none (over range).
    pub value: f64,
}

/// All looks of a test, in the order they came.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    looks: Vec<Look>,
}

impl Trace {
    /// In the order they came.
    pub fn looks(&self) -> &[Look] {
        &self.looks
    }

    /// Goes on with what another stage saw.
    pub fn append(&mut self, other: Self) {
        for look in other.looks {
            self.see(look.signal, look.at, look.value);
        }
    }

    /// What was asked of sources, once they have answered.
    pub(super) fn asked(&mut self, wiring: &Wiring, to: &[(AnalogOutput, Volt)], at: RigTime) {
        for (output, volts) in to {
            let signal = Signal::source(wiring.source_name(*output));
            self.see(signal, at, volts.0);
        }
    }

    /// Outputs that were switched, those of them that a trace keeps.
    pub(super) fn switched(&mut self, wiring: &Wiring, to: &[(DigitalOutput, bool)], at: RigTime) {
        for (output, on) in to {
            let switch = wiring.switch(*output);
            if switch.traced {
                self.see(Signal::bits(switch.name), at, f64::from(u8::from(*on)));
            }
        }
    }

    /// Inputs that were looked at together: bit n is input n.
    pub(super) fn word(&mut self, name: &'static str, states: &[bool], at: RigTime) {
        let bits = states.iter().rev();
        let word = bits.fold(0_u32, |word, bit| word << 1 | u32::from(*bit));
        self.see(Signal::bits(name), at, f64::from(word));
    }

    /// One analog sample; a channel that is masked out has none.
    pub(super) fn input(&mut self, quantity: Quantity, sample: &Sample) {
        if sample.quality == Quality::Blank {
            return;
        }
        let value = sample.good().unwrap_or(f64::NAN);
        self.see(Signal::input(quantity), sample.origin.at, value);
    }

    /// A count, unless it was seen before.
    pub(super) fn count(&mut self, name: &'static str, count: &CountSample) {
        let (signal, at) = (Signal::count(name), count.origin.at);
        let mut before = self.looks.iter().rev();
        let is_known = before.any(|look| look.signal == signal && look.at == at);
        if !is_known {
            self.see(signal, at, f64::from(count.count));
        }
    }

    fn see(&mut self, signal: Signal, at: RigTime, value: f64) {
        if signal.stands {
            let looks = self.looks.iter_mut().rev();
            let mut before = looks.filter(|look| look.signal == signal);
            if let (Some(last), Some(earlier)) = (before.next(), before.next())
                && last.value == value
                && earlier.value == value
            {
                last.at = at;
                return;
            }
        }
        if self.looks.len() < MOST {
            self.looks.push(Look { signal, at, value });
        }
    }
}

#[cfg(test)]
mod tests;
