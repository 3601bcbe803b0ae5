//! The station: takes the rig through a lot. This page is its specification.
//!
//! `Station::step(now, inputs) -> TurnOutput` is a function of its state and arguments: no clock, no I/O, no `async`.
//! The caller may call it at any time; the states hold the deadlines.
//!
//! The state machine of the whole rig, around those of feed, nest and sorter, is [`packml`], with names of
//! ISA-TR88.00.02 (PackML). `states` performs its states, `answers` answers orders.
//! 1. `Resetting`: [`crate::handling::recovery`] brings every actuator to its rest end and discharges the parts found
//!    inside;
//! 2. `Starting`: without a valid calibration the probes rise in the empty nest and the station measures the
//!    references;
//! 3. `Execute`: reference parts when there is no calibration, then the lot behind its [`gates`], through the
//!    [`crate::handling::feeder`];
//! 4. `Completing`, `Stopping`, `Holding`, `Suspending`: the parts inside go to their waiting positions.
//!
//! Trouble: the [`catalogue`] gives the reaction to an [`trouble::Alarm`]; the [`annunciator`] lists the alarm until
//! its cause is gone and a person has acknowledged it. After `clear` and `reset` the station continues; a part that was
//! inside is void, "interrupted". A stale sensor raises an alarm; the station never guesses what it would show.
//!
//! A run ends with its lot, or when a person leaves the lot for another one. An unattended run ([`Plan::attended`] is
//! false) also ends with an alarm that needs a person. The station resets the machine and starts its lot by itself;
//! between lots ([`Plan::between_lots`]) it acts only on orders.

mod activity;
pub mod annunciator;
mod answers;
pub mod catalogue;
pub mod gates;
mod lamps;
mod learning;
mod line;
mod machine;
pub mod orders;
pub mod packml;
mod panel;
mod produce;
mod prompts;
mod resetting;
mod safety;
mod starting;
mod states;
mod timeouts;
pub mod trouble;
pub mod turn;

use crate::dut::Device;
use crate::dut::experiment::Experiment;
use crate::dut::prompt::Prompt;
use crate::guard::{Motion, Situation};
use crate::handling::inside::Inside;
use crate::handling::serial::Serials;
use crate::handling::wear::Uses;
use crate::handling::{Batch, Feeder, Ledger, Mechanism, Move};
use crate::rig::axis::AxisTable;
use crate::rig::image::Image;
use crate::rig::rack::Rack;
pub use activity::Activity;
use annunciator::Annunciator;
use gates::{Gates, LotSettings};
use lamps::Lamps;
use line::{FeederLine, Handling, Line};
use machine::Machine;
use packml::{Mode, State};
use panel::Panel;
use prompts::Prompts;
use starting::Start;
use std::collections::VecDeque;
use timeouts::Timeouts;
use turn::{Inputs, TurnOutput};
use units::RigTime;

/// Plan of a run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Number of parts of the lot; `None` for an endless lot.
    pub count: Option<u64>,
    /// Serial numbers of the reference parts, in the order of the magazine. A run without a calibration begins with all
    /// of them; a reference check uses the first.
    pub reference_serials: Vec<String>,
    /// True with a valid calibration: the run measures neither references nor reference parts.
    pub calibrated: bool,
    /// How long a calibration is valid, microseconds.
    pub valid_us: i64,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub epoch_us: i64,
    /// True on a simulated rig.
    pub simulated: bool,
    /// True when a person is at a screen: alarms and stops do not end the run.
    pub attended: bool,
    /// State in which the last lot left the machine, between lots; `None` during a lot. Between lots the machine
    /// discharges parts found inside and begins nothing by itself.
    pub between_lots: Option<State>,
    /// Settings of the lot's gates.
    pub lot: LotSettings,
    /// Use counts of the wearing parts before this run.
    pub worn: Uses,
    /// Parts that the previous run left inside.
    pub left: Inside,
    /// Serial numbers of the parts.
    pub serials: Serials,
    /// What a person must answer during the lot.
    pub prompts: Vec<Prompt>,
    /// Experiment of the run, which tests no parts; `None` for a lot.
    pub experiment: Option<Experiment>,
}

impl Plan {
    /// Returns the wall clock at `now`, microseconds since 1970 UTC.
    fn wall_clock_us(&self, now: RigTime) -> i64 {
        self.epoch_us + i64::try_from(now.0).unwrap_or(i64::MAX)
    }
}

/// State of the whole station.
#[derive(Debug)]
pub struct Station {
    plan: Plan,
    /// Recipe and calibration of the device under test.
    device: Device,
    start: Start,
    /// True once this run has measured the references.
    referenced: bool,
    machine: Machine,
    line: Line,
    lot: LotControl,
    prompts: Prompts,
    alarms: Alarms,
}

/// Gates and reference parts of the lot.
#[derive(Debug)]
struct LotControl {
    gates: Gates,
    reference_left: VecDeque<String>,
    /// Number of reference parts that this run has planned so far.
    reference_planned: u64,
    /// True once calibration and reference parts are complete and the prompts before the first part are answered.
    began: bool,
}

impl LotControl {
    /// Plans these reference parts next, instead of those planned before.
    fn plan_references(&mut self, serials: &[String]) {
        let more = serials.len().saturating_sub(self.reference_left.len());
        self.reference_planned += more as u64;
        self.reference_left = serials.iter().cloned().collect();
    }

    /// Panics when an invariant of the lot is broken.
    fn check(&self) {
        let left = self.reference_left.len() as u64;
        assert!(
            self.reference_planned >= left,
            "reference parts without a plan"
        );
    }
}

/// Alarms, timeouts, push buttons and lamps.
#[derive(Debug, Default)]
struct Alarms {
    annunciator: Annunciator,
    timeouts: Timeouts,
    panel: Panel,
    lamps: Lamps,
    /// Time at which the emergency-stop chain was last open.
    chain_open: Option<RigTime>,
    /// True once the safety inputs were read after the start or the last verification.
    sensed: bool,
}

impl Station {
    /// Returns the station of a rig with a feeder, before the first reading of its sensors.
    pub fn new(plan: Plan, device: Device, table: AxisTable, mechanism: Mechanism) -> Self {
        let own = FeederLine::new(Feeder::new(table), mechanism);
        Self::of(plan, device, Handling::Feeder(Box::new(own)))
    }

    /// Returns the station of a rig with a rack, before the first reading of its sensors.
    pub fn with_rack(plan: Plan, device: Device, rack: Rack) -> Self {
        Self::of(plan, device, Handling::Batch(Box::new(Batch::new(rack))))
    }

    fn of(plan: Plan, device: Device, handling: Handling) -> Self {
        let ledger = Ledger::after(plan.left);
        let serials = plan.serials.clone();
        let mut station = Self {
            machine: Machine::new(plan.between_lots.unwrap_or(State::Stopped)),
            line: Line::new(handling, ledger, serials),
            lot: LotControl {
                gates: Gates::default(),
                reference_planned: 0,
                reference_left: VecDeque::new(),
                began: false,
            },
            prompts: Prompts::new(plan.prompts.clone()),
            alarms: Alarms::default(),
            plan,
            device,
            start: Start::Begin,
            referenced: false,
        };
        if !station.plan.calibrated {
            station.lot.plan_references(&station.plan.reference_serials);
        } else if station.plan.lot.reference_check.at_start {
            station.begin_check();
        }
        station
    }

    /// Returns the part ledger.
    pub fn ledger(&self) -> &Ledger {
        &self.line.ledger
    }

    /// Returns rack and batch; `None` on a rig with a feeder.
    pub fn batch(&self) -> Option<&Batch> {
        self.line.batch()
    }

    /// Returns the prompt that waits for its answer, if there is one.
    pub fn prompt(&self) -> Option<&Prompt> {
        let of_batch = || self.line.batch().and_then(Batch::prompt);
        self.prompts.open().or_else(of_batch)
    }

    /// Returns the serial numbers of the lot.
    pub fn serials(&self) -> &Serials {
        &self.line.serials
    }

    /// Returns the mechanism: end sensors and motions; `None` on a rig with a rack.
    pub fn mechanism(&self) -> Option<&Mechanism> {
        self.line.feeder().map(|own| &own.mechanism)
    }

    /// Returns the list of alarms.
    pub fn annunciator(&self) -> &Annunciator {
        &self.alarms.annunciator
    }

    /// Returns the list of alarms, to add those of an earlier run.
    pub fn annunciator_mut(&mut self) -> &mut Annunciator {
        &mut self.alarms.annunciator
    }

    /// Returns true when a person is at a screen.
    pub fn is_attended(&self) -> bool {
        self.plan.attended
    }

    /// Returns true when there is no lot.
    pub fn is_between_lots(&self) -> bool {
        self.plan.between_lots.is_some()
    }

    /// Returns the counts of strokes, touches and bounces since the program started, by name.
    pub fn wear(&self) -> Vec<(&'static str, u64)> {
        self.mechanism().map_or_else(Vec::new, Mechanism::wear)
    }

    /// Returns the PackML state of the rig.
    pub fn outer(&self) -> State {
        self.machine.state
    }

    /// Returns the PackML mode of the rig.
    pub fn mode(&self) -> Mode {
        self.machine.mode
    }

    /// Returns the activity of the station.
    pub fn activity(&self) -> Activity {
        match self.machine.state {
            _ if self.machine.ended => Activity::Ended,
            State::Resetting if !self.alarms.sensed => Activity::WaitingForSensors,
            State::Resetting if !self.line.homed => Activity::Homing,
            State::Resetting => Activity::Discharging,
            State::Starting => Activity::Calibrating,
            State::Execute | State::Completing => match self.line.stage() {
                Some(stage) => Activity::Testing(stage),
                None if self.lot.began || self.lot.reference_left.is_empty() => Activity::Running,
                None => Activity::ReferenceParts,
            },
            state @ (State::Stopped
            | State::Idle
            | State::Complete
            | State::Holding
            | State::Held
            | State::Unholding
            | State::Suspending
            | State::Suspended
            | State::Unsuspending
            | State::Stopping
            | State::Aborting
            | State::Aborted
            | State::Clearing) => Activity::Resting(state),
        }
    }

    /// Performs one turn.
    pub fn step(&mut self, now: RigTime, mut inputs: Inputs) -> TurnOutput {
        let mut output = TurnOutput::default();
        if self.machine.ended {
            return output;
        }
        self.machine.turn(now);
        let (ordered, image) = (inputs.orders.len(), inputs.image);
        if inputs.verified {
            // Samples from before the verification are stale, and must raise no alarm.
            (self.alarms.sensed, self.machine.began) = (false, Some(now));
        }
        self.machine.began.get_or_insert(now);
        for order in std::mem::take(&mut inputs.orders) {
            let answer = self.order(order, now, &mut output);
            output.answers.push(answer);
        }
        if let Some(batch) = self.line.batch_mut() {
            batch.deliver(inputs.job.take());
        }
        let stuck = self.pressed(now, inputs.image, &mut output);
        self.prompts.turn();
        self.own_commands(now, &inputs, &mut output);
        if self.machine.ended {
            return output;
        }
        self.look(now, &inputs, stuck, &mut output);
        self.raise_all(now, &mut output);
        if !output.rig.safe && !self.machine.ended {
            self.act(now, inputs, &mut output);
            self.raise_all(now, &mut output);
        }
        output.record.prompted = self.opened_prompt();
        self.line.postpone(now, image, &mut output);
        self.alarms.annunciator.unshelve(now);
        self.show(now, &mut output);
        self.line.check();
        self.lot.check();
        output.check(now, ordered);
        let ends = output.record.ending.is_some();
        assert_eq!(ends, self.machine.ended, "the end and its event differ");
        output
    }

    /// Returns the prompt that has opened in this turn, of the lot or of the batch.
    fn opened_prompt(&mut self) -> Option<Prompt> {
        let of_lot = self.prompts.opened().cloned();
        of_lot.or_else(|| self.line.batch_mut()?.take_opened())
    }

    /// Records a motion that the guard has cleared and the rig has driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        self.line.driven(movement, now, image);
    }

    /// Returns the motion in the terms of the guard; `None` on a rig with a rack.
    pub fn motion(&self, movement: Move) -> Option<Motion> {
        Some(movement.motion(self.mechanism()?.strokes()))
    }

    /// Returns the situation for the guard; `None` on a rig with a rack.
    pub fn situation(&self, now: RigTime, image: &Image) -> Option<Situation> {
        self.line.situation(now, image)
    }
}

#[cfg(test)]
pub(crate) mod tests;
