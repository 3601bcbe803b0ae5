//! A kind of device for tests of batches: it switches an output for a fixed time, and passes every part not in `void`.

use super::batch::{
    BatchCurve, BatchOrder, BatchOutcome, BatchProgress, BatchTest, BatchTrouble, SocketResult,
};
use super::batch_shown::BatchShown;
use super::device::{DeviceUnderTest, TestOrder};
use super::procedure::Procedure;
use super::reason::Reason;
use super::record::TestRecord;
use super::verdict::Verdict;
use crate::instrument::act::{Act, JobDone, Runner, RunnerState};
use crate::rig::image::Image;
use crate::rig::point::{DigitalOutput, Thermometer};
use units::{RigTime, Span};

/// Device whose tests last a fixed time.
#[derive(Debug, Clone)]
pub struct MockDevice {
    /// Output that a test switches on and cooling switches off.
    pub heater: DigitalOutput,
    /// Output that is on while the rack cools.
    pub fan: DigitalOutput,
    /// Duration of a test.
    pub lasts: Span,
    /// Longest time of a test.
    pub longest: Span,
    /// Thermometers in the air around the rack.
    pub air: Vec<Thermometer>,
    /// Thermometers on surfaces that give off heat.
    pub surfaces: Vec<Thermometer>,
    /// Sockets whose parts cannot be judged.
    pub void: Vec<u16>,
    /// Troubles that each test reports at its end.
    pub troubles: Vec<BatchTrouble>,
}

impl DeviceUnderTest for MockDevice {
    fn begin(&self, _order: &TestOrder, _now: RigTime) -> Procedure {
        panic!("a kind for a rack gets a nest")
    }

    fn begin_batch(&self, order: &BatchOrder, now: RigTime) -> Box<dyn BatchTest> {
        let acts = vec![
            Act::Set(vec![(self.heater, true)]),
            Act::Wait(self.lasts),
            Act::Set(vec![(self.heater, false)]),
        ];
        Box::new(MockTest {
            runner: Runner::new(acts, now),
            sockets: order.sockets.clone(),
            void: self.void.clone(),
            longest: self.longest,
            troubles: self.troubles.clone(),
        })
    }

    fn air_thermometers(&self) -> Vec<Thermometer> {
        self.air.clone()
    }

    fn hot_surfaces(&self) -> Vec<Thermometer> {
        self.surfaces.clone()
    }

    fn cooling(&self, on: bool) -> Vec<Act> {
        vec![Act::Set(vec![(self.heater, false), (self.fan, on)])]
    }
}

#[derive(Debug)]
struct MockTest {
    runner: Runner,
    sockets: Vec<u16>,
    void: Vec<u16>,
    longest: Span,
    troubles: Vec<BatchTrouble>,
}

impl BatchTest for MockTest {
    fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> BatchProgress {
        match self.runner.step(now, done, image) {
            RunnerState::Done => {}
            waiting => return BatchProgress::Running(waiting),
        }
        let result = |socket: &u16| SocketResult {
            socket: *socket,
            verdict: match self.void.contains(socket) {
                true => Verdict::Void(vec![Reason::interrupted("reset")]),
                false => Verdict::Pass,
            },
            judgements: Vec::new(),
            record: TestRecord::default(),
        };
        BatchProgress::Judged(BatchOutcome {
            results: self.sockets.iter().map(result).collect(),
            troubles: self.troubles.clone(),
            found: None,
        })
    }

    fn stage(&self) -> &'static str {
        "Off"
    }

    fn longest(&self) -> Span {
        self.longest
    }

    fn shown(&self) -> BatchShown {
        BatchShown::default()
    }

    fn curve(&self) -> Option<BatchCurve> {
        None
    }
}
