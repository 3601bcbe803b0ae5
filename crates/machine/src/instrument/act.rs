//! Acts, the steps of a test stage: each takes a few transactions of one line, or one wait.
//!
//! A stage lists its acts before it begins; [`Runner`] carries them out and stores the readings. The order of a test
//! can therefore be read, printed and replayed, and no stage occupies a bus line. Acts name wired points and are
//! independent of the kind of device; the wiring turns them into transactions.

mod runner;

use super::conversion::{Conversion, Converted};
use super::query::{Delivered, Query, Waveform};
use crate::rig::image::Image;
use crate::rig::point::{AnalogInput, AnalogOutput, DigitalInput, DigitalOutput, Point};
use std::sync::Arc;
use texts::Message;
use units::{RigTime, Span, Volt};

pub use runner::{Runner, RunnerState, Spent};

/// Digital inputs read together and kept as one signal: bit n is input n.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Word {
    /// Name of the signal.
    pub name: &'static str,
    /// The inputs; all of one module take one transaction.
    pub inputs: Vec<DigitalInput>,
}

/// The points that one act reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Read {
    /// Inputs read together.
    Word(Arc<Word>),
    /// Single points.
    Points {
        /// Points to read.
        read: Vec<Point>,
        /// Points that are not read; the readings repeat their last values.
        retained: Vec<Point>,
    },
    /// Restart check: asks each module with outputs whether it has restarted since the last such check. A restart
    /// raises an alarm.
    Restarts,
}

impl Read {
    /// Returns a read of these points without any retained ones.
    pub fn points(read: impl IntoIterator<Item = Point>) -> Self {
        Self::Points {
            read: read.into_iter().collect(),
            retained: Vec::new(),
        }
    }

    fn job(&self) -> Job {
        match self {
            Self::Word(word) => Job::Read(word.inputs.iter().copied().map(Point::Input).collect()),
            Self::Points { read, .. } => Job::Read(read.clone()),
            Self::Restarts => Job::Restarts,
        }
    }
}

/// One step of a stage.
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// Sets digital outputs; those of one module in one write.
    Set(Vec<(DigitalOutput, bool)>),
    /// Sets sources to voltages, in volts of the supply, one after the other.
    Level(Vec<(AnalogOutput, Volt)>),
    /// Starts ramps of sources to voltages, without waiting for their end.
    Ramp(Vec<(AnalogOutput, Volt)>),
    /// Reads points.
    Read(Read),
    /// Runs programs on SCPI instruments: those of different instruments at the same time, those of one instrument in
    /// their order.
    Query(Vec<Query>),
    /// Converts the waveforms that the stage has read so far into [`super::readings::Readings::converted`].
    Convert(Conversion),
    /// Enables these inputs of their converters and no others. This writes EEPROM, so only a calibration does it,
    /// before a lot.
    Mask(Vec<AnalogInput>),
    /// Stores the current time for [`Act::WaitSinceMark`].
    Mark,
    /// Waits until this time has passed since the last [`Act::Mark`].
    WaitSinceMark(Span),
    /// Waits as [`Act::WaitSinceMark`] does, for a ramp started after the mark; longer if the ramp started late.
    RampSinceMark(Span),
    /// Waits this long after the answer to the previous act.
    Wait(Span),
    /// Waits as [`Act::WaitSinceMark`] does, for a conversion that began after the mark.
    ConvertSinceMark(Span),
    /// Reads a word until the point is active or the time is over, and records which came first.
    Until {
        /// The awaited input.
        point: DigitalInput,
        /// Inputs recorded at the last poll.
        word: Arc<Word>,
        /// Longest wait.
        within: Span,
    },
    /// Reads an analog input until its magnitude is below a value. The last reading begins at `within` after the last
    /// [`Act::Mark`] or later; it is the one that counts. Only for a quantity that does not rise again, because a
    /// reading may be older than the mark.
    Below {
        /// The input.
        point: AnalogInput,
        /// The value, in the unit of the input.
        amount: f64,
        /// Time from the mark to the last reading.
        within: Span,
    },
    /// Reads a word until all these inputs have their expected states. If they do not in time, the runner skips the
    /// acts after this one.
    Agree {
        /// The inputs, all of the word, each with its state.
        expected: Vec<(DigitalInput, bool)>,
        /// Inputs recorded at the last poll.
        word: Arc<Word>,
        /// Longest wait.
        within: Span,
    },
}

/// A task for the lines and the instruments.
#[derive(Debug, Clone, PartialEq)]
pub enum Job {
    /// See [`Act::Set`].
    Set(Vec<(DigitalOutput, bool)>),
    /// See [`Act::Level`].
    Level(Vec<(AnalogOutput, Volt)>),
    /// Reads these points.
    Read(Vec<Point>),
    /// See [`Read::Restarts`].
    Restarts,
    /// See [`Act::Query`].
    Query(Vec<Query>),
    /// See [`Act::Convert`].
    Convert(Conversion, Vec<Arc<Waveform>>),
    /// See [`Act::Mask`].
    Mask(Vec<AnalogInput>),
}

/// Completion of a [`Job`].
#[derive(Debug, Clone, PartialEq)]
pub struct JobDone {
    /// Time at which the last reply of the job was complete.
    pub at: RigTime,
    /// Reason for a failure (line, address, command, number of tries; or instrument, program); none after a success.
    pub trouble: Option<Message>,
    /// What each query of a [`Job::Query`] has delivered; empty for other jobs, and after a failure.
    pub delivered: Vec<Delivered>,
    /// Result of a [`Job::Convert`]; none for other jobs.
    pub converted: Option<Converted>,
}

impl JobDone {
    /// Returns the end of a job without queries.
    pub fn new(at: RigTime, trouble: Option<Message>) -> Self {
        Self {
            at,
            trouble,
            delivered: Vec::new(),
            converted: None,
        }
    }
}

impl Word {
    /// Returns the state of each input; `None` unless all were read just now.
    pub(super) fn states(&self, image: &Image, now: RigTime) -> Option<Vec<bool>> {
        let inputs = self.inputs.iter();
        inputs.map(|it| image.answered_input(*it, now)).collect()
    }
}

#[cfg(test)]
mod tests;
