//! Selects one of several answers to the same request, of which one may be damaged. The answers come some milliseconds
//! apart.
//!
//! An eight-bit checksum lets one damaged reply in 256 pass. Damage rarely repeats identically, so two consecutive
//! equal answers count as true. A quantity that moves or is noisy gives different answers: the host then reads it a
//! third time and takes the answer between the other two, because one damaged answer of three cannot move this value
//! beyond the two intact ones.
//!
//! | three answers, no two consecutive ones equal | selected |
//! |---|---|
//! | analog reading, level, frequency | the answer with the middle value |
//! | all analog inputs at once | the second, if each input lies between its first and its third reading, or at most 1/1024 of its range outside: the noise of the coarsest converter (twelve bits) |
//! | count | the second, if the counts rise at most at 100 kHz, which is more than any input of a 7080 accepts |
//! | event counter | the second, if the counts rise at most at 100 Hz |
//! | everything else | none |

use super::{Command, Reading, Reply, TypeCode};

/// Noise, as a fraction of the range, by which an input read together with others may lie outside its first and third
/// reading.
const NOISE_SHARE: f64 = 1.0 / 1024.0;
/// Fastest accepted rise of a count, counts per millisecond.
const COUNTS_PER_MS: u64 = 100;
/// Least time between two events counted on a digital input, milliseconds.
const MS_PER_EVENT: u64 = 10;

impl Command {
    /// Returns the index of the answer to accept among two or three. `apart_ms` is the time from the first to the last
    /// request, milliseconds, rounded up. `None` for two answers means that a third one is needed; for three, that no
    /// answer is trustworthy.
    pub fn select_answer(&self, answers: &[Reply], apart_ms: u64) -> Option<usize> {
        let alike = answers.windows(2).position(|pair| pair[0] == pair[1]);
        let [first, second, third] = answers else {
            return alike;
        };
        alike.or_else(|| self.middle([first, second, third], apart_ms))
    }

    fn middle(&self, answers: [&Reply; 3], apart_ms: u64) -> Option<usize> {
        let second = |holds: bool| holds.then_some(1);
        match answers {
            [Reply::Count(a), Reply::Count(b), Reply::Count(c)] => {
                let most = apart_ms * COUNTS_PER_MS;
                let rises = |from: u32, to: u32| u64::from(to.wrapping_sub(from)) <= most;
                second(rises(*a, *b) && rises(*b, *c))
            }
            [Reply::Events(a), Reply::Events(b), Reply::Events(c)] => {
                let most = 1 + apart_ms / MS_PER_EVENT;
                let rises = |from: u16, to: u16| u64::from(to.wrapping_sub(from)) <= most;
                second(rises(*a, *b) && rises(*b, *c))
            }
            [Reply::Readings(a), Reply::Readings(b), Reply::Readings(c)] => second(
                a.iter()
                    .zip(b.iter())
                    .zip(c.iter())
                    .all(|((before, it), after)| self.lies_between(before, it, after)),
            ),
            [a, b, c] => {
                let values = [self.size(a)?, self.size(b)?, self.size(c)?];
                let mut places = [0, 1, 2];
                places.sort_by(|one, other| values[*one].total_cmp(&values[*other]));
                Some(places[1])
            }
        }
    }

    /// Returns the number by which [`Self::select_answer`] compares answers; `None` for answers without an order.
    fn size(&self, answer: &Reply) -> Option<f64> {
        match answer {
            Reply::Reading(reading) => reading.value.in_units(self.range()?),
            Reply::Frequency(hertz) => Some(f64::from(*hertz)),
            Reply::Level(level) => Some(f64::from(level.steps())),
            _ => None,
        }
    }

    /// Returns true when reading `it` lies between those before and after it, up to noise. Readings without a number,
    /// such as over range, must be the same in all three answers.
    fn lies_between(&self, before: &Reading, it: &Reading, after: &Reading) -> bool {
        let scale = self.range().and_then(TypeCode::full_scale);
        let noise = scale.map_or(0.0, |scale| (scale.high - scale.low) * NOISE_SHARE);
        let value = |reading: &Reading| reading.value.in_units(self.range()?);
        match (value(before), value(it), value(after)) {
            (Some(before), Some(it), Some(after)) => {
                before.min(after) - noise <= it && it <= before.max(after) + noise
            }
            (None, None, None) => before.value == it.value && it.value == after.value,
            (_, _, _) => false,
        }
    }

    /// Returns the range of the analog inputs that the command reads; `None` for other commands.
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
    use crate::{
        Address, AnalogIn, Channel, Command, Counter, DataFormat, Digital, InputForm, TypeCode,
        UpTo,
    };

    /// Returns the index of the selected answer; the requests lie 3 ms apart.
    fn select(command: Command, said: &[&str]) -> Option<usize> {
        let answers: Vec<_> = said
            .iter()
            .map(|text| command.decode(text.as_bytes(), false).unwrap())
            .collect();
        command.select_answer(&answers, 3 * (said.len() as u64 - 1))
    }

    fn form(format: DataFormat) -> InputForm {
        InputForm::eight(format, TypeCode(0x08))
    }

    fn volts() -> Command {
        let channel = Channel::new(0).unwrap();
        let form = form(DataFormat::Engineering);
        AnalogIn::ReadOne { channel, form }.to(Address(1))
    }

    #[test]
    fn two_equal_answers_are_accepted() {
        let port = Digital::ReadPort.to(Address(3));
        assert_eq!(select(port, &[">BEDE\r", ">BEDE\r"]), Some(0));
        assert_eq!(select(port, &[">BEDE\r", ">BEDC\r"]), None);
        assert_eq!(select(port, &[">BEDE\r", ">BEDC\r", ">BEDC\r"]), Some(1));
        assert_eq!(select(port, &[">BEDE\r", ">BEDC\r", ">BEDE\r"]), None);
        assert_eq!(select(volts(), &[">+05.000\r", ">+05.001\r"]), None);
        assert_eq!(select(volts(), &[">+9999.9\r", ">+9999.9\r"]), Some(0));
    }

    #[test]
    fn the_middle_of_three_readings_is_accepted() {
        let middle = |said: [&str; 3]| select(volts(), &said);
        assert_eq!(middle([">+05.019\r", ">+05.001\r", ">+05.000\r"]), Some(1));
        assert_eq!(middle([">+05.001\r", ">+05.019\r", ">+05.000\r"]), Some(0));
        assert_eq!(middle([">+05.002\r", ">+05.000\r", ">+05.001\r"]), Some(2));
        assert_eq!(middle([">+01.000\r", ">+02.000\r", ">+03.000\r"]), Some(1));
        assert_eq!(middle([">+01.000\r", ">+9999.9\r", ">+02.000\r"]), None);
    }

    #[test]
    fn frequencies_may_fall_unlike_counts() {
        let frequency = Counter::ReadFrequency(UpTo::new(0).unwrap()).to(Address(3));
        let said = [">00000032\r", ">00000009\r", ">00000031\r"];
        assert_eq!(select(frequency, &said), Some(2));
        let count = Counter::Read(UpTo::new(0).unwrap()).to(Address(3));
        assert_eq!(select(count, &said), None);
    }

    #[test]
    fn inputs_lie_between_neighbours_allowing_twelve_bit_noise() {
        let hex = AnalogIn::ReadAll(form(DataFormat::Hex)).to(Address(1));
        let all = |last: &str| format!(">{}{last}\r", "4000".repeat(7));
        let second = |last: [&str; 3]| {
            let [a, b, c] = last.map(all);
            select(hex, &[&a, &b, &c])
        };
        assert_eq!(second(["4000", "4040", "4001"]), Some(1));
        assert_eq!(second(["4000", "4050", "4001"]), None);
        assert_eq!(second(["4000", "5000", "6000"]), Some(1), "ramp");
        assert_eq!(second(["4000", "3000", "5000"]), None);
        assert_eq!(second(["    ", "4000", "    "]), None);
    }

    #[test]
    fn a_count_rises_no_faster_than_its_input_allows() {
        let count = Counter::Read(UpTo::new(0).unwrap()).to(Address(3));
        let second = |said: [&str; 3]| select(count, &said);
        assert_eq!(
            second([">000003E8\r", ">00000514\r", ">00000640\r"]),
            Some(1)
        );
        assert_eq!(second([">000003E8\r", ">00000641\r", ">00000642\r"]), None);
        assert_eq!(second([">000003E8\r", ">000003E7\r", ">000003E9\r"]), None);
        assert_eq!(
            second([">FFFFFFFF\r", ">00000001\r", ">00000002\r"]),
            Some(1)
        );
        let channel = Channel::new(2).unwrap();
        let events = Digital::ReadEvents { channel }.to(Address(3));
        let second = |said: [&str; 3]| select(events, &said);
        assert_eq!(second(["!0300103\r", "!0300104\r", "!0300105\r"]), Some(1));
        assert_eq!(second(["!0300103\r", "!0300105\r", "!0300106\r"]), None);
    }
}
