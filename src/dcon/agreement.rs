//! Two answers to the same question, the second some milliseconds after the first: can both be true?
//!
//! A checksum of eight bits lets one damaged reply in 256 pass. Asked again, the module says the same, or what the
//! quantity can have become in the time between:
//!
//! | answer | may differ by |
//! |---|---|
//! | analog input | 1/1024 of the range: noise of the coarsest converter, twelve bits |
//! | count | upwards, 100 kHz: more than any input of a 7080 takes |
//! | event counter | upwards, 100 Hz |
//! | everything else | nothing |
//!
//! What was switched, cleared or measured anew between the two does not agree: an input, a count after a reset, a
//! frequency. Asked once more it does, unless it changes faster than it can be asked. A terminal in the middle of a ramp or
//! a step agrees with nothing; its reading is true when it lies between the ones before and after it.

use super::{Command, Reading, Reply, TypeCode};

/// Share of the range between two readings of a terminal at rest.
const READING_SHARE: f64 = 1.0 / 1024.0;
/// Counts in a millisecond at most.
const COUNTS_PER_MS: u64 = 100;
/// A digital input counts one event in so many milliseconds at most.
const MS_PER_EVENT: u64 = 10;

impl Command {
    /// Whether `second`, answered `apart_ms` (rounded up) after `first`, confirms it.
    pub fn agree(&self, first: &Reply, second: &Reply, apart_ms: u64) -> bool {
        match (first, second) {
            (Reply::Count(first), Reply::Count(second)) => {
                u64::from(second.wrapping_sub(*first)) <= apart_ms * COUNTS_PER_MS
            }
            (Reply::Events(first), Reply::Events(second)) => {
                u64::from(second.wrapping_sub(*first)) <= 1 + apart_ms / MS_PER_EVENT
            }
            (Reply::Reading(first), Reply::Reading(second)) => self.at_rest(first, second),
            (Reply::Readings(first), Reply::Readings(second)) => first
                .iter()
                .zip(second.iter())
                .all(|(first, second)| self.at_rest(first, second)),
            (first, second) => first == second,
        }
    }

    /// Whether analog readings lie between those before and after them: of a terminal that moves one way.
    pub fn between(&self, before: &Reply, middle: &Reply, after: &Reply) -> bool {
        match (before, middle, after) {
            (Reply::Reading(before), Reply::Reading(middle), Reply::Reading(after)) => {
                self.on_the_way(before, middle, after)
            }
            (Reply::Readings(before), Reply::Readings(middle), Reply::Readings(after)) => before
                .iter()
                .zip(middle.iter())
                .zip(after.iter())
                .all(|((before, middle), after)| self.on_the_way(before, middle, after)),
            (_, _, _) => false,
        }
    }

    /// No farther from either end than the ends are from each other, but for noise.
    fn on_the_way(&self, before: &Reading, middle: &Reading, after: &Reading) -> bool {
        let whole = self.distance(before, after).unwrap_or(0.0) + READING_SHARE;
        let near = |end| match self.distance(end, middle) {
            Some(share) => share <= whole,
            None => false,
        };
        self.at_rest(before, middle) || self.at_rest(middle, after) || near(before) && near(after)
    }

    fn at_rest(&self, first: &Reading, second: &Reading) -> bool {
        self.distance(first, second)
            .map_or(first.value == second.value, |share| share <= READING_SHARE)
    }

    /// As a share of the range; none unless both are numbers in a known range.
    fn distance(&self, first: &Reading, second: &Reading) -> Option<f64> {
        let range = self.range()?;
        let scale = range.full_scale()?;
        let apart = first.value.in_units(range)? - second.value.in_units(range)?;
        Some(apart.abs() / (scale.high - scale.low))
    }

    /// Of the analog inputs that are asked.
    fn range(&self) -> Option<TypeCode> {
        match self {
            Self::AnalogIn(_, ask) => ask.range(),
            Self::HostOk
            | Self::SampleAll
            | Self::Common(..)
            | Self::AnalogOut(..)
            | Self::Digital(..)
            | Self::Counter(..) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::dcon::{
        Address, AnalogIn, Channel, Command, Counter, DataFormat, Digital, InputForm, TypeCode,
        UpTo,
    };

    fn agree(command: Command, first: &str, second: &str, apart_ms: u64) -> bool {
        let said = |text: &str| command.decode(text.as_bytes(), false).unwrap();
        command.agree(&said(first), &said(second), apart_ms)
    }

    #[test]
    fn a_terminal_at_rest_agrees_within_the_noise_of_twelve_bits() {
        let form = |format| InputForm::eight(format, TypeCode(0x08));
        let channel = Channel::new(0).unwrap();
        let volts = AnalogIn::ReadOne {
            channel,
            form: form(DataFormat::Engineering),
        }
        .to(Address(1));
        assert!(agree(volts, ">+05.000\r", ">+05.019\r", 3));
        assert!(!agree(volts, ">+05.000\r", ">+04.979\r", 3));
        assert!(!agree(volts, ">+05.000\r", ">+9999.9\r", 3));
        let hex = AnalogIn::ReadAll(form(DataFormat::Hex)).to(Address(1));
        let all = |last: &str| format!(">{}{last}\r", "4000".repeat(7));
        assert!(agree(hex, &all("4000"), &all("403F"), 3));
        assert!(!agree(hex, &all("4000"), &all("4050"), 3));
        assert!(agree(hex, &all("    "), &all("    "), 3));
        assert!(!agree(hex, &all("    "), &all("0000"), 3));
    }

    #[test]
    fn a_terminal_that_moves_is_believed_between_its_neighbours() {
        let form = InputForm::eight(DataFormat::Engineering, TypeCode(0x08));
        let channel = Channel::new(0).unwrap();
        let volts = AnalogIn::ReadOne { channel, form }.to(Address(1));
        let between = |texts: [&str; 3]| {
            let said = |text: &str| volts.decode(text.as_bytes(), false).unwrap();
            let [before, middle, after] = texts.map(said);
            volts.between(&before, &middle, &after)
        };
        assert!(between([">+01.000\r", ">+02.000\r", ">+03.000\r"]), "ramp");
        assert!(between([">+01.000\r", ">+05.000\r", ">+05.000\r"]), "step");
        assert!(between([">+09.000\r", ">+02.000\r", ">+02.010\r"]));
        assert!(!between([">+01.000\r", ">+05.000\r", ">+01.000\r"]));
        assert!(!between([">+01.000\r", ">-03.000\r", ">+02.000\r"]));
        assert!(!between([">+01.000\r", ">+9999.9\r", ">+02.000\r"]));
    }

    #[test]
    fn a_count_goes_up_and_no_faster_than_its_input_can() {
        let count = Counter::Read(UpTo::new(0).unwrap()).to(Address(3));
        assert!(agree(count, ">000003E8\r", ">0000047E\r", 3));
        assert!(!agree(count, ">000003E8\r", ">00000515\r", 3));
        assert!(!agree(count, ">000003E8\r", ">000003E7\r", 3));
        assert!(agree(count, ">FFFFFFFF\r", ">00000001\r", 3), "wraps");
        let channel = Channel::new(2).unwrap();
        let events = Digital::ReadEvents { channel }.to(Address(3));
        assert!(agree(events, "!0300103\r", "!0300104\r", 3));
        assert!(!agree(events, "!0300103\r", "!0300105\r", 3));
    }

    #[test]
    fn an_input_that_was_switched_between_does_not_agree() {
        let port = Digital::ReadPort.to(Address(3));
        assert!(agree(port, ">BEDE\r", ">BEDE\r", 3));
        assert!(!agree(port, ">BEDE\r", ">BEDC\r", 3));
    }
}
