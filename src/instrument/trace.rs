//! What a test saw, sample by sample: the evidence that stays when the part is rejected.
//!
//! Analog samples and counts as they were read, what was asked of the supply and the coil drive, and the
//! inputs of the board. Board and drive are told when they change and once more at the last look before
//! the next change, so that a poll of many milliseconds takes two samples. Of one test at most [`MOST`]
//! samples are kept, the first ones; a test of the default recipe has some 150.

use super::act::{Act, BoardInputs, CoilScan};
use crate::rig::point::{AnalogIn, AnalogOut, Counter, DigitalOut};
use crate::rig::sample::{CountSample, Quality, Sample};
use crate::units::RigTime;

/// Samples of one test, all signals together.
pub const MOST: usize = 1_000;

/// What was seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// What one output of the supply was asked for, volts of the coil.
    Asked(AnalogOut),
    /// The coil drive: 0 off, 1 on.
    Drive,
    /// An analog input in its unit, before correction.
    Input(AnalogIn),
    /// A gated counter.
    Gate(Counter),
    /// Inputs of the board, a bit each: NO closed, NC closed, source out of compliance, probe chain, then
    /// the Kelvin contacts of coil A, coil B, COM, NO, NC.
    Board,
}

impl Signal {
    /// Name of its point.
    pub fn name(self) -> &'static str {
        match self {
            Self::Asked(output) => output.name(),
            Self::Drive => DigitalOut::CoilDrive.name(),
            Self::Input(input) => input.name(),
            Self::Gate(counter) => counter.name(),
            Self::Board => "board",
        }
    }

    /// Unit of its values; empty for bits and counts.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Input(AnalogIn::CoilCurrent | AnalogIn::CoilCurrentFine) => "A",
            Self::Asked(_) | Self::Input(_) => "V",
            Self::Drive | Self::Gate(_) | Self::Board => "",
        }
    }

    /// Step that its values are kept in: a tenth or less of a step of its converter.
    pub fn step(self) -> f64 {
        match self {
            Self::Input(AnalogIn::CoilCurrent | AnalogIn::CoilCurrentFine) => 1e-8,
            Self::Input(AnalogIn::ContactDrop) => 1e-7,
            Self::Asked(_) | Self::Input(_) => 1e-5,
            Self::Drive | Self::Gate(_) | Self::Board => 1.0,
        }
    }

    /// Told at its changes only.
    fn stands(self) -> bool {
        matches!(self, Self::Drive | Self::Board)
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

    /// What an act has asked of the outputs, once it was answered.
    pub(super) fn asked(&mut self, act: &Act, at: RigTime) {
        match act {
            Act::Supply(outputs) => {
                for (output, volts) in outputs {
                    self.see(Signal::Asked(*output), at, volts.0);
                }
            }
            Act::Board(outputs) => {
                let drive = outputs.iter().find(|(it, _)| *it == DigitalOut::CoilDrive);
                if let Some((_, on)) = drive {
                    self.see(Signal::Drive, at, f64::from(u8::from(*on)));
                }
            }
            Act::Read(_)
            | Act::CoilMask(_)
            | Act::Mark
            | Act::WaitSinceMark(_)
            | Act::RampSinceMark(_)
            | Act::Wait(_)
            | Act::ConvertSinceMark(_)
            | Act::Until { .. } => {}
        }
    }

    /// The inputs of the board.
    pub(super) fn board(&mut self, seen: &BoardInputs, at: RigTime) {
        let [coil_a, coil_b, com, no, nc] = seen.kelvin;
        let bits = [
            seen.no_closed,
            seen.nc_closed,
            seen.compliance,
            seen.probe_chain,
            coil_a,
            coil_b,
            com,
            no,
            nc,
        ];
        let word = bits
            .iter()
            .rev()
            .fold(0_u16, |word, bit| word << 1 | u16::from(*bit));
        self.see(Signal::Board, at, f64::from(word));
    }

    /// The channels of a scan that are enabled.
    pub(super) fn scan(&mut self, scan: &CoilScan) {
        for (input, sample) in [
            (AnalogIn::CoilVoltageFine, &scan.voltage_fine),
            (AnalogIn::CoilCurrentFine, &scan.current_fine),
            (AnalogIn::CoilCurrent, &scan.current_wide),
            (AnalogIn::ReferenceVoltage, &scan.reference),
        ] {
            if let Some(sample) = sample {
                self.input(input, sample);
            }
        }
    }

    /// One analog sample; a channel that is masked out has none.
    pub(super) fn input(&mut self, input: AnalogIn, sample: &Sample) {
        if sample.quality == Quality::Blank {
            return;
        }
        let value = sample.good().unwrap_or(f64::NAN);
        self.see(Signal::Input(input), sample.origin.at, value);
    }

    /// Those of both gates that were read since.
    pub(super) fn gates(&mut self, gates: &[CountSample; 2]) {
        for (counter, sample) in [Counter::Gate0, Counter::Gate1].into_iter().zip(gates) {
            let (signal, at) = (Signal::Gate(counter), sample.origin.at);
            let mut before = self.looks.iter().rev();
            let is_known = before.any(|look| look.signal == signal && look.at == at);
            if !is_known {
                self.see(signal, at, f64::from(sample.count));
            }
        }
    }

    fn see(&mut self, signal: Signal, at: RigTime, value: f64) {
        if signal.stands() {
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
mod tests {
    use super::*;
    use crate::units::{Span, Volt};

    #[test]
    fn a_poll_that_changes_nothing_takes_two_looks() {
        let mut trace = Trace::default();
        let seen = |no_closed| BoardInputs {
            kelvin: [true; 5],
            no_closed,
            nc_closed: !no_closed,
            compliance: false,
            probe_chain: true,
        };
        for at in 0..100 {
            trace.board(&seen(at >= 90), RigTime(at));
        }
        let looks: Vec<(u64, f64)> = trace
            .looks()
            .iter()
            .map(|look| (look.at.0, look.value))
            .collect();
        let [open, made] = [0b1_1111_1010, 0b1_1111_1001].map(f64::from);
        assert_eq!(looks, [(0, open), (89, open), (90, made), (99, made)]);
    }

    #[test]
    fn what_was_asked_is_told_and_what_is_too_much_is_not() {
        let mut trace = Trace::default();
        let act = Act::Supply(vec![
            (AnalogOut::SupplyLevel, Volt(1.0)),
            (AnalogOut::SupplyFine, Volt(0.5)),
        ]);
        trace.asked(&act, RigTime(7));
        trace.asked(&Act::Board(vec![(DigitalOut::CoilDrive, true)]), RigTime(8));
        trace.asked(&Act::Board(vec![(DigitalOut::Arm, true)]), RigTime(9));
        trace.asked(&Act::Wait(Span(5)), RigTime(10));
        let names: Vec<_> = trace.looks().iter().map(|it| it.signal.name()).collect();
        assert_eq!(names, ["supply_level", "supply_fine", "coil_drive"]);
        let mut much = trace.clone();
        (0..MOST).for_each(|_| much.asked(&act, RigTime(11)));
        assert_eq!(much.looks().len(), MOST);
        trace.append(much);
        assert_eq!(trace.looks().len(), MOST);
    }
}
