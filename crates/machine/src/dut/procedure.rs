//! A running test of any kind: stages made of acts, then a verdict.

use super::Characteristic;
use super::reason::Reason;
use super::record::{Stop, TestRecord};
use super::verdict::Verdict;
use super::{Kind, em_relay, resistor, ssr};
use crate::gauge::Judgement;
use crate::instrument::act::{JobDone, RunnerState};
use crate::rig::image::Image;
use crate::rig::supply::RangeMismatch;
use std::ops::{Deref, DerefMut};
use units::{RigTime, Span};

/// Progress of a test after a step.
#[derive(Debug)]
pub enum Progress {
    /// The test goes on; holds the state of the runner that carries out its stage.
    Running(RunnerState),
    /// The part is judged.
    Judged,
}

/// Longest time of the stages that measure; confirmation measurements take less than 10 s.
pub const MEASURING: Span = Span::ms(60_000);

/// A test under way.
pub trait TestProcedure {
    /// Advances the test as far as it can. `done` is the outcome of the job that an earlier step requested; the caller
    /// passes it once.
    fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> Progress;

    /// Returns the kind of the part.
    fn kind(&self) -> Kind;

    /// Returns how often the part has been tested, including this test, from 1.
    fn number(&self) -> u8;

    /// Returns the name of the stage under way.
    fn stage(&self) -> &'static str;

    /// Returns why the test ends before its last stage; `None` while it does not.
    fn why_stopped(&self) -> Option<&Stop>;

    /// Judges each result against its limit.
    fn judgements(&self) -> Vec<(Characteristic, Judgement)>;

    /// Returns the results so far, with the replies behind them.
    fn record(&self) -> TestRecord;

    /// Hands over the record, once the part is judged.
    fn take_record(&mut self) -> TestRecord;

    /// Returns the longest time that the test may take; a longer test counts as stuck.
    fn longest(&self) -> Span {
        MEASURING
    }

    /// Returns why the part cannot be judged (the rig was in trouble, or the test could not measure the part); `None`
    /// for any other part.
    fn why_void(&self) -> Option<&Reason> {
        match self.why_stopped()? {
            Stop::Void(why) | Stop::Trouble(why) => Some(why),
            Stop::Fail(_) => None,
        }
    }

    /// Returns the selected supply range and the range that was read back, once they differ. This is trouble of the
    /// rig, not of the part.
    fn range_mismatch(&self) -> Option<&RangeMismatch>;

    /// Returns true when the test has ended without proof that its socket is free of dangerous voltage.
    fn is_live(&self) -> bool {
        false
    }

    /// Returns the verdict of the part.
    fn verdict(&self) -> Verdict {
        let expected = self.kind().characteristics();
        Verdict::after(self.why_stopped(), &expected, self.judgements())
    }
}

/// A test under way, by kind.
#[derive(Debug)]
pub enum Procedure {
    /// Test of an electromagnetic relay.
    EmRelay(Box<em_relay::measure::Test>),
    /// Test of a resistor.
    Resistor(Box<resistor::Test>),
    /// Test of a solid-state relay.
    Ssr(Box<ssr::Test>),
}

impl Deref for Procedure {
    type Target = dyn TestProcedure;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::EmRelay(test) => test.as_ref(),
            Self::Resistor(test) => test.as_ref(),
            Self::Ssr(test) => test.as_ref(),
        }
    }
}

impl DerefMut for Procedure {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::EmRelay(test) => test.as_mut(),
            Self::Resistor(test) => test.as_mut(),
            Self::Ssr(test) => test.as_mut(),
        }
    }
}
