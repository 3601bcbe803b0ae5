//! A running test of any kind: stages made of acts, then a verdict.

use super::Characteristic;
use super::em_relay::measure;
use super::reason::Reason;
use super::record::{Own, Stop, TestRecord};
use super::resistor;
use super::verdict::Verdict;
use crate::gauge::Judgement;
use crate::instrument::act::{Doing, JobDone};
use crate::rig::image::Image;
use crate::rig::supply::RangeMismatch;
use units::{RigTime, Span};

/// What a test wants from its surroundings.
#[derive(Debug)]
pub enum Progress {
    /// As the runner of the present stage says.
    Doing(Doing),
    /// The part is judged.
    Judged,
}

/// Longest time of the stages that measure; confirmation measurements takes below 10 s.
const MEASURING: Span = Span::ms(60_000);

/// A test under way, by kind.
#[derive(Debug)]
pub enum Procedure {
    /// Of an electromagnetic relay.
    EmRelay(Box<measure::Test>),
    /// Of a resistor.
    Resistor(Box<resistor::Test>),
}

impl Procedure {
    /// Goes on as far as it can. `done` answers the job that it asked for before, once.
    pub fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> Progress {
        match self {
            Self::EmRelay(test) => test.step(now, done, image),
            Self::Resistor(test) => test.step(now, done, image),
        }
    }

    /// Number of the test of this part, from 1.
    pub fn number(&self) -> u8 {
        match self {
            Self::EmRelay(test) => test.number(),
            Self::Resistor(test) => test.number(),
        }
    }

    /// Longest time of the test; one that takes longer is stuck.
    pub fn longest(&self) -> Span {
        match self {
            Self::EmRelay(test) => MEASURING + test.conditioning(),
            Self::Resistor(_) => MEASURING,
        }
    }

    /// Name of the stage under way.
    pub fn stage(&self) -> &'static str {
        match self {
            Self::EmRelay(test) => test.stage().name(),
            Self::Resistor(test) => test.stage(),
        }
    }

    /// Why the test could not be carried through, if it was not: the rig was in trouble or the part could not be seen.
    pub fn why_void(&self) -> Option<&Reason> {
        let stop = match self {
            Self::EmRelay(test) => test.record().why_stopped()?,
            Self::Resistor(test) => test.record().why_stopped()?,
        };
        match stop {
            Stop::Void(why) | Stop::Trouble(why) => Some(why),
            Stop::Fail(_) => None,
        }
    }

    /// Returns the selected supply range and the one that was read back, once they differ: trouble of the rig, not of the part.
    pub fn range_mismatch(&self) -> Option<&RangeMismatch> {
        match self {
            Self::EmRelay(test) => test.range_mismatch(),
            Self::Resistor(test) => test.range_mismatch(),
        }
    }

    /// Returns each result against its limit.
    pub fn judgements(&self) -> Vec<(Characteristic, Judgement)> {
        match self {
            Self::EmRelay(test) => test.judgements(),
            Self::Resistor(test) => test.judgements(),
        }
    }

    /// Verdict of the part.
    pub fn verdict(&self) -> Verdict {
        match self {
            Self::EmRelay(test) => test.verdict(),
            Self::Resistor(test) => test.verdict(),
        }
    }

    /// What was found so far, with the replies behind it.
    pub fn record(&self) -> TestRecord {
        match self {
            Self::EmRelay(test) => test.record().clone().of_any_kind(Own::EmRelay),
            Self::Resistor(test) => test.record().clone().of_any_kind(|()| Own::Nothing),
        }
    }

    /// Hands over what was found, once the part is judged.
    pub fn take_record(&mut self) -> TestRecord {
        match self {
            Self::EmRelay(test) => test.take_record().of_any_kind(Own::EmRelay),
            Self::Resistor(test) => test.take_record(),
        }
    }
}
