//! Acts of a relay test by the names of its points, and their translation into acts on a wired rig.

use super::points::{AnalogIn, AnalogOut, Counter, DigitalIn, DigitalOut, Points};
use crate::instrument::act;
use crate::rig::point::Point;
use units::{Span, Volt};

/// Points that one [`Act::Read`] reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Read {
    /// All inputs of the interface board.
    Board,
    /// One scan of the enabled channels of the coil converter.
    Coil,
    /// The drop across the contact under test.
    Drop,
    /// Both gate counters.
    Gates,
    /// Gate counter 0 alone, which is enough for a ramp; the readings repeat the last count of counter 1.
    Gate,
    /// Temperature of the magazine track, taken as that of the part.
    Track,
    /// Restart flag of each module with outputs; a set flag raises an alarm.
    Resets,
}

/// One step of a stage; waits and marks work as those of [`act::Act`].
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// Sets outputs of the interface board in one write.
    Board(Vec<(DigitalOut, bool)>),
    /// Sets supply outputs one after the other, in volts at the coil.
    Supply(Vec<(AnalogOut, Volt)>),
    /// Reads these inputs once.
    Read(Read),
    /// Selects the range of the supply with this code; the board switches only once the drive is off and all sources
    /// are at zero.
    SelectRange(u8),
    /// Reads the board until it is in the range with this code; if the wait ends first, the runner skips the acts after
    /// this one. A rig with one range reads the board once.
    ConfirmRange {
        /// Code of the range.
        code: u8,
        /// Longest wait.
        within: Span,
    },
    /// Enables these channels of the coil converter and no others. This writes EEPROM, so only a calibration does it,
    /// before a lot.
    CoilMask(Vec<AnalogIn>),
    /// Marks this instant.
    Mark,
    /// See [`act::Act::WaitSinceMark`].
    WaitSinceMark(Span),
    /// See [`act::Act::RampSinceMark`].
    RampSinceMark(Span),
    /// See [`act::Act::Wait`].
    Wait(Span),
    /// See [`act::Act::ConvertSinceMark`].
    ConvertSinceMark(Span),
    /// Reads a channel of the coil converter until its magnitude is below a value; see [`act::Act::Below`].
    Below {
        /// The channel.
        channel: AnalogIn,
        /// The value, in the unit of the channel.
        amount: f64,
        /// Time from the last mark to the last reading.
        within: Span,
    },
    /// Reads the board until the point is active or the wait ends, and records which came first.
    Until {
        /// Point of the interface board.
        point: DigitalIn,
        /// Longest wait.
        within: Span,
    },
}

impl Points {
    /// Translates acts of a relay test into acts on the rig that has these points; `scanned` lists the enabled channels
    /// of the coil converter.
    pub fn wired(&self, acts: Vec<Act>, scanned: &[AnalogIn]) -> Vec<act::Act> {
        let acts = acts.into_iter();
        acts.map(|act| self.wired_act(act, scanned)).collect()
    }

    fn wired_act(&self, act: Act, scanned: &[AnalogIn]) -> act::Act {
        match act {
            Act::Board(outputs) => {
                let wired = |(output, on)| (self.output(output), on);
                act::Act::Set(outputs.into_iter().map(wired).collect())
            }
            Act::SelectRange(code) => {
                let range = self.range.iter();
                act::Act::Set(range.flat_map(|it| it.select(code)).collect())
            }
            Act::ConfirmRange { code, within } => act::Act::Agree {
                expected: self.range.iter().flat_map(|it| it.expects(code)).collect(),
                word: self.board.clone(),
                within,
            },
            Act::Supply(outputs) => self.supplied(outputs),
            Act::Read(read) => act::Act::Read(self.wired_read(read, scanned)),
            Act::CoilMask(channels) => {
                act::Act::Mask(channels.iter().map(|it| self.analog(*it)).collect())
            }
            Act::Mark => act::Act::Mark,
            Act::WaitSinceMark(span) => act::Act::WaitSinceMark(span),
            Act::RampSinceMark(span) => act::Act::RampSinceMark(span),
            Act::Wait(span) => act::Act::Wait(span),
            Act::ConvertSinceMark(span) => act::Act::ConvertSinceMark(span),
            Act::Below {
                channel,
                amount,
                within,
            } => act::Act::Below {
                point: self.analog(channel),
                amount,
                within,
            },
            Act::Until { point, within } => act::Act::Until {
                point: self.input(point),
                word: self.board.clone(),
                within,
            },
        }
    }

    /// Translates new supply voltages: into a level act when only the level output changes, else into a ramp act.
    fn supplied(&self, outputs: Vec<(AnalogOut, Volt)>) -> act::Act {
        let ramps = |(output, _): &(AnalogOut, Volt)| *output != AnalogOut::SupplyLevel;
        let ramps = outputs.iter().any(ramps);
        let wired = |(output, volts)| (self.source(output), volts);
        let wired = outputs.into_iter().map(wired).collect();
        match ramps {
            true => act::Act::Ramp(wired),
            false => act::Act::Level(wired),
        }
    }

    fn wired_read(&self, read: Read, scanned: &[AnalogIn]) -> act::Read {
        let analog = |input| Point::Analog(self.analog(input));
        let count = |counter| Point::Count(self.counter(counter));
        match read {
            Read::Board => act::Read::Word(self.board.clone()),
            Read::Coil => act::Read::points(scanned.iter().copied().map(analog)),
            Read::Drop => act::Read::points([analog(AnalogIn::ContactDrop)]),
            Read::Gates => act::Read::points([Counter::Gate0, Counter::Gate1].map(count)),
            Read::Gate => act::Read::Points {
                read: vec![count(Counter::Gate0)],
                retained: vec![count(Counter::Gate1)],
            },
            Read::Track => act::Read::points([Point::Temperature(self.track)]),
            Read::Resets => act::Read::Restarts,
        }
    }
}

#[cfg(test)]
mod tests;
