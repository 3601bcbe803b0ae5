//! The station: the sequence as a specification.
//!
//! `Station::step(now, inputs) -> Wants` is a function of its state and arguments: no clock, no I/O, no
//! `async`. It may be called at any time and as often as one likes; deadlines are kept in the states.
//!
//! The outer machine is [`packml`]; what a state does is in `states`, who may ask for what in `asked`.
//! 1. `Resetting`: [`recovery`] brings every actuator to its rest end and discharges what is found inside;
//! 2. `Starting`: without a valid calibration probes up in the empty nest, [`reference`] measurements;
//! 3. `Execute`: golden parts when there is no calibration, then the lot behind its [`gates`]. [`feed`], [`clamp`] (with the
//!    [`test`]) and [`sort`] overlap; parts are handed over in the [`ledger`];
//! 4. `Completing`, `Stopping`, `Holding`, `Suspending`: the parts inside go as far as they can rest.
//!
//! Trouble: an [`trouble::Alarm`] stops what the [`catalogue`] says and stands in the [`annunciator`] until its
//! cause is gone and somebody has seen it. After `clear` and `reset` the station goes on from where it is. A
//! part inside is void, "interrupted". A stale sensor is trouble, never a guess.
//!
//! A run ends with its lot, or when a person leaves the lot for another one. Without a person at a screen
//! ([`Plan::stays`] is false) an alarm that would need one ends the run, too. The station resets and starts a lot by
//! itself; between lots ([`Plan::between_lots`]) it does nothing unless it is asked.

pub mod annunciator;
mod asked;
pub mod catalogue;
mod chinese;
pub mod clamp;
pub mod feed;
pub mod gates;
pub mod inside;
mod lamps;
mod learning;
pub mod ledger;
pub mod mechanism;
pub mod moves;
pub mod orders;
pub mod packml;
mod panel;
mod patience;
mod produce;
pub mod recovery;
mod safety;
pub mod sort;
mod states;
pub mod trouble;
pub mod turn;
pub mod wants;
mod watch;

use crate::dut::Device;
use crate::guard::{PartPlaces, Situation};
use crate::instrument::act::Runner;
use crate::rig::axis::AxisTable;
use crate::rig::image::Image;
use crate::units::RigTime;
use annunciator::Annunciator;
use clamp::Clamp;
use feed::Feed;
use gates::{Gates, LotSettings, Uses};
use inside::Inside;
use lamps::Lamps;
use ledger::Ledger;
use mechanism::Mechanism;
use moves::Move;
use packml::{Mode, State};
use panel::Panel;
use patience::Patience;
use recovery::Recovery;
use sort::Sort;
use std::collections::VecDeque;
use std::sync::Arc;
use turn::Turn;
use wants::{Inputs, Wants};

/// What a run is to do.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Parts of the lot; `None` goes on until stopped.
    pub count: Option<u64>,
    /// Serial numbers of the golden parts at the head of the magazine, used when there is no calibration.
    pub golden: Vec<String>,
    /// A calibration is at hand: neither references nor golden parts are run.
    pub calibrated: bool,
    /// Life of a calibration, microseconds.
    pub valid_us: i64,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub epoch_us: i64,
    /// The rig is simulated.
    pub simulated: bool,
    /// A person is at a screen: alarms and stops do not end the run.
    pub stays: bool,
    /// Between lots nothing begins by itself and no part is wanted; what is found inside is discharged. The machine
    /// rests in this state, as the lot before has left it. None: there is a lot.
    pub between_lots: Option<State>,
    /// Gates of the lot.
    pub lot: LotSettings,
    /// Uses of what wears before this run.
    pub worn: Uses,
    /// What the run before left inside.
    pub left: Inside,
}

/// What `Starting` is doing.
#[derive(Debug)]
enum Start {
    /// Nothing asked for yet.
    Begin,
    /// Probes rise in the empty nest.
    Up,
    References(Box<Runner>),
    /// Probes go down again.
    Down,
}

/// State of the whole station.
#[derive(Debug)]
pub struct Station {
    plan: Plan,
    /// The kind under test, with what parts have taught.
    device: Arc<Device>,
    table: AxisTable,
    state: State,
    entered: RigTime,
    mode: Mode,
    recovery: Recovery,
    /// Every actuator was brought home and nothing was moved by hand or made safe since.
    homed: bool,
    start: Start,
    /// References were measured in this run.
    referenced: bool,
    began: Option<RigTime>,
    /// Safety inputs were read since the start or since the modules were verified.
    sensed: bool,
    feed: Feed,
    /// The escapement may have let a part through when the sequence was cut off.
    releasing: bool,
    clamp: Clamp,
    sort: Sort,
    ledger: Ledger,
    mechanism: Mechanism,
    annunciator: Annunciator,
    patience: Patience,
    panel: Panel,
    /// When the emergency-stop chain was last seen open.
    chain_open: Option<RigTime>,
    lamps: Lamps,
    dark: Vec<(crate::rig::point::DigitalInput, RigTime)>,
    /// Motions that wait for a step in maintenance.
    stepwise: VecDeque<Move>,
    /// Motions that wait until no end sensor is in doubt.
    postponed: Vec<Move>,
    /// A person asked for the suspension; it does not end by itself.
    suspended_by_order: bool,
    asked_verify: bool,
    /// When the modules were found as they should be, of this clearing.
    verified: Option<RigTime>,
    golden_left: VecDeque<String>,
    /// Golden parts that this run has asked for so far.
    golden_planned: u64,
    gates: Gates,
    last_left: Option<RigTime>,
    lot_began: bool,
    /// Nobody has started anything yet: the first start is the program's own.
    fresh: bool,
    stopping: bool,
    ended: bool,
}

impl Station {
    /// A station that knows nothing of its sensors yet.
    pub fn new(plan: Plan, device: Device, table: AxisTable, mechanism: Mechanism) -> Self {
        let golden_left = if plan.calibrated {
            VecDeque::new()
        } else {
            plan.golden.iter().cloned().collect()
        };
        let ledger = Ledger::after(plan.left);
        let mut station = Self {
            fresh: true,
            state: plan.between_lots.unwrap_or(State::Stopped),
            plan,
            device: Arc::new(device),
            table,
            entered: RigTime(0),
            mode: Mode::Production,
            recovery: Recovery::default(),
            homed: false,
            start: Start::Begin,
            referenced: false,
            began: None,
            sensed: false,
            feed: Feed::Empty,
            releasing: false,
            clamp: Clamp::Empty,
            sort: Sort::Returning,
            ledger,
            mechanism,
            annunciator: Annunciator::default(),
            patience: Patience::default(),
            panel: Panel::default(),
            chain_open: None,
            lamps: Lamps::default(),
            dark: Vec::new(),
            stepwise: VecDeque::new(),
            postponed: Vec::new(),
            suspended_by_order: false,
            asked_verify: false,
            verified: None,
            golden_planned: golden_left.len() as u64,
            golden_left,
            gates: Gates::default(),
            last_left: None,
            lot_began: false,
            stopping: false,
            ended: false,
        };
        if station.plan.calibrated && station.plan.lot.golden_check.at_start {
            station.begin_check();
        }
        station
    }

    /// The part ledger.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Sensors and motions.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Alarms that stand.
    pub fn annunciator(&self) -> &Annunciator {
        &self.annunciator
    }

    /// The same, to put in what a run before left unseen.
    pub fn annunciator_mut(&mut self) -> &mut Annunciator {
        &mut self.annunciator
    }

    /// A person is at a screen.
    pub fn stays(&self) -> bool {
        self.plan.stays
    }

    /// There is no lot.
    pub fn is_between_lots(&self) -> bool {
        self.plan.between_lots.is_some()
    }

    /// Strokes, touches and bounces since the start, by name.
    pub fn wear(&self) -> Vec<(&'static str, u64)> {
        self.mechanism.wear()
    }

    /// State of the outer machine.
    pub fn outer(&self) -> State {
        self.state
    }

    /// What the machine is used for.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// What the station is doing, in words for a screen.
    pub fn state(&self) -> String {
        match self.state {
            _ if self.ended => "ended".into(),
            State::Resetting if !self.sensed => "waiting for sensors".into(),
            State::Resetting if !self.homed => "homing".into(),
            State::Resetting => "discharging".into(),
            State::Starting => "calibrating".into(),
            State::Execute | State::Completing => match self.clamp.test() {
                Some(test) => format!("testing: {}", test.stage()),
                None if self.lot_began => "running".into(),
                None if self.golden_left.is_empty() => "running".into(),
                None => "golden parts".into(),
            },
            State::Stopped
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
            | State::Clearing => self.state.name().to_lowercase(),
        }
    }

    /// One turn.
    pub fn step(&mut self, now: RigTime, mut inputs: Inputs) -> Wants {
        let mut wants = Wants::default();
        if self.ended {
            return wants;
        }
        if inputs.verified {
            // What was read before the modules were asked is stale by now, and no trouble.
            (self.sensed, self.began) = (false, Some(now));
        }
        self.began.get_or_insert(now);
        for order in std::mem::take(&mut inputs.orders) {
            let answer = self.order(order, now, &mut wants);
            wants.answers.push(answer);
        }
        let stuck = self.pressed(now, inputs.image, &mut wants);
        self.by_itself(now, &inputs, &mut wants);
        if self.ended {
            return wants;
        }
        self.look(now, &inputs, stuck, &mut wants);
        self.raise_all(now, &mut wants);
        if !wants.safe && !self.ended {
            self.act(now, inputs, &mut wants);
            self.raise_all(now, &mut wants);
        }
        self.postpone(now, &mut wants);
        debug_assert!(self.ledger.balances(), "a part is in two places or in none");
        self.annunciator.unshelve(now);
        wants.alarms_changed |= self.annunciator.take_changed();
        let stack = self
            .lamps
            .show(now, self.state, self.annunciator.standing(), wants.safe);
        wants.outputs.extend(stack);
        wants
    }

    /// A motion was cleared and driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        self.mechanism.driven(movement, now, image);
        self.sort = self.sort.driven(movement, &mut self.ledger, now);
    }

    /// The motion as the guard knows it.
    pub fn motion(&self, movement: Move) -> crate::guard::Motion {
        movement.motion(self.mechanism.strokes())
    }

    /// Situation for the guard.
    pub fn situation(&self, now: RigTime, image: &Image) -> Situation {
        let pushing = matches!(self.feed, Feed::Pushing);
        let parts = PartPlaces {
            pocket: self.ledger.pocket && !pushing,
            on_pusher: self.ledger.pocket && pushing,
            nest: self.ledger.nest.is_some() && !matches!(self.clamp, Clamp::Lifting),
            gripper: self.ledger.gripper.is_some() || matches!(self.clamp, Clamp::Lifting),
        };
        self.mechanism.situation(parts, now, image)
    }

    fn turn<'a>(&'a mut self, now: RigTime, inputs: &'a Inputs, wants: &'a mut Wants) -> Turn<'a> {
        Turn {
            now,
            image: inputs.image,
            mechanism: &self.mechanism,
            ledger: &mut self.ledger,
            wants,
            golden: &mut self.golden_left,
            recorded: inputs.recorded,
            resting: matches!(self.state, State::Holding | State::Suspending),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
