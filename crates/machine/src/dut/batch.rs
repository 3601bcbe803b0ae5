//! The test of a batch: a kind of device tests the parts of all sockets together.

use super::batch_shown::{AirCurve, BatchShown, SocketSwitched};
use super::characteristic::Characteristic;
use super::experiment::Found;
use super::record::TestRecord;
use super::verdict::Verdict;
use crate::gauge::Judgement;
use crate::instrument::act::{JobDone, RunnerState};
use crate::rig::image::Image;
use std::fmt::Debug;
use units::{RigTime, Span};

/// The parts that are tested together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BatchOrder {
    /// Sockets that hold a part, by number, in ascending order.
    pub sockets: Vec<u16>,
    /// Number of the batch in its run, from 1.
    pub number: u64,
}

/// Result of one part of a batch.
#[derive(Debug, Clone)]
pub struct SocketResult {
    /// Socket of the part.
    pub socket: u16,
    /// Verdict of the part.
    pub verdict: Verdict,
    /// Judgement of each result against its limit.
    pub judgements: Vec<(Characteristic, Judgement)>,
    /// Results, with the replies from which they came.
    pub record: TestRecord,
}

named! {
    /// Trouble with the heating of a batch: the test switches the heater off and judges no part.
    HeatTrouble {
        /// A thermometer of the air has no usable reading.
        ThermometerBroken = "thermometer_broken",
        /// A thermometer moves faster than the air can.
        ThermometerJump = "thermometer_jump",
        /// The two thermometers of the air disagree.
        ThermometersDiffer = "thermometers_differ",
        /// The reading of a thermometer does not change although the heater has power.
        ThermometerStuck = "thermometer_stuck",
        /// The air does not warm or cool as its power demands.
        EnergyBalance = "energy_balance",
        /// The air warms without power.
        HeatWithoutCommand = "heat_without_command",
        /// The air is far above its set point.
        OverSetPoint = "over_set_point",
        /// The air does not follow a rising set point.
        RampNotReached = "ramp_not_reached",
        /// The air does not follow a falling set point.
        CoolingTooSlow = "cooling_too_slow",
        /// The air warms or cools faster than the recipe allows.
        RampTooFast = "ramp_too_fast",
        /// The identification finds no usable response of the air to the heater.
        NotIdentified = "heating_not_identified",
        /// The limiter on the heater has tripped.
        LimiterTripped = "limiter_tripped",
        /// The airflow switch is open.
        AirflowLost = "airflow_lost",
        /// The mains of the heater have failed.
        MainsLost = "mains_lost",
        /// Limiter, airflow switch or mains relay has no fresh reading.
        ChainNotRead = "chain_not_read",
    }
}

/// Trouble with the rig that the test of a batch has met; the station raises an alarm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BatchTrouble {
    /// Trouble with the heating.
    Heat(HeatTrouble),
    /// Sockets whose contact was open before heating, in words; the test goes on.
    SocketsOpen(String),
    /// Thermal lag of the lot, s, then the lag that earlier batches or the recipe state, s; the test goes on.
    LagUnexpected(u32, u32),
}

/// Outcome of the test of a batch.
#[derive(Debug)]
pub struct BatchOutcome {
    /// A result for each socket of the order.
    pub results: Vec<SocketResult>,
    /// Troubles, in the order in which the test met them.
    pub troubles: Vec<BatchTrouble>,
    /// Figures that an experiment without parts has found; `None` after the test of parts, and after trouble.
    pub found: Option<Found>,
}

/// Temperatures of the air and switchings of the contacts that a test has recorded, for the history.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchCurve {
    /// Time zero of the curve.
    pub origin: RigTime,
    /// The air.
    pub air: AirCurve,
    /// Sockets of the batch, by number.
    pub switched: Vec<SocketSwitched>,
}

/// Progress of the test of a batch after a step.
#[derive(Debug)]
pub enum BatchProgress {
    /// The test goes on; holds the state of the runner that carries out the present stage.
    Running(RunnerState),
    /// Every part is judged. The test has switched its heater off.
    Judged(BatchOutcome),
}

/// The test of a batch under way. It takes the contacts of the sockets from the image, because the scan reads them.
pub trait BatchTest: Debug + Send {
    /// Advances the test as far as it can. `done` is the outcome of the job that an earlier step requested; the caller
    /// passes it once. The test has no job under way when it returns [`BatchProgress::Judged`].
    fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> BatchProgress;

    /// Returns the name of the stage under way.
    fn stage(&self) -> &'static str;

    /// Returns the longest time that the test may take; a longer one counts as stuck.
    fn longest(&self) -> Span;

    /// Returns the progress of the test as pages show it.
    fn shown(&self) -> BatchShown;

    /// Returns air and contacts for the history; `None` for a test without parts, and before the first reading.
    fn curve(&self) -> Option<BatchCurve>;
}
