//! The station: the sequence as a specification.
//!
//! `Station::step(now, inputs) -> Wants` is a function of its state and arguments: no clock, no I/O, no
//! `async`. It may be called at any time and as often as one likes; deadlines are kept in the states.
//!
//! Normal sequence of a run:
//! 1. wait until every safety and end sensor was read once;
//! 2. [`homing`]: every actuator to its rest end;
//! 3. without a valid calibration: probes up in the empty nest, [`reference`] measurements, probes down,
//!    then the golden parts, which are fed, tested and sorted like any other and end in `retest`;
//! 4. the lot: [`feed`], [`clamp`] (with the [`test`]), [`sort`] overlap; parts are handed over in the
//!    [`ledger`];
//! 5. when the count is reached or a stop was ordered, the parts inside are finished; outputs go safe.
//!
//! Trouble: an [`trouble::Alarm`] makes all outputs safe and ends the run; a part inside is void,
//! "interrupted". A stale sensor is trouble, never a guess. Reset and recovery are a new start.

pub mod act;
pub mod clamp;
pub mod feed;
pub mod golden;
pub mod homing;
mod learning;
pub mod ledger;
pub mod mechanism;
pub mod moves;
pub mod reference;
pub mod sort;
pub mod supply;
pub mod test;
pub mod trouble;
pub mod turn;
pub mod wants;

use crate::gauge::settings::GoldenPart;
use crate::gauge::verdict::{Bin, Verdict};
use crate::guard::{PartPlaces, Situation};
use crate::rig::axis::AxisTable;
use crate::rig::image::Image;
use crate::rig::point::{DigitalIn, DigitalOut};
use crate::units::{RigTime, Span};
use act::{JobDone, Runner};
use clamp::{Beside, Clamp};
use feed::Feed;
use golden::{CoarseLag, GoldenRun};
use homing::Homing;
use ledger::Ledger;
use mechanism::Mechanism;
use moves::Move;
use sort::Sort;
use std::collections::VecDeque;
use test::Bench;
use trouble::Alarm;
use turn::Turn;
use wants::{Ending, Inputs, Judged, Wants};

/// Sensors must be there so long after the start at the latest.
const FIRST_SCAN: Span = Span::ms(3000);

/// What a run is to do.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Parts of the lot; `None` goes on until stopped.
    pub count: Option<u64>,
    /// Golden parts at the head of the magazine, used when there is no calibration.
    pub golden: Vec<GoldenPart>,
    /// A calibration is at hand: neither references nor golden parts are run.
    pub calibrated: bool,
    /// Life of a calibration, microseconds.
    pub valid_us: i64,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub epoch_us: i64,
    /// The rig is simulated.
    pub simulated: bool,
    /// Volts at the terminal per volt of the coil, fine channel.
    pub voltage_gain: f64,
}

/// Where the run stands.
#[derive(Debug)]
enum Phase {
    /// Until every sensor was read once.
    Waiting,
    Homing(Homing),
    /// Probes rise in the empty nest.
    ReferenceUp,
    Reference(Box<Runner>),
    /// Probes go down again.
    ReferenceDown,
    Running,
    Ended,
}

/// State of the whole station.
#[derive(Debug)]
pub struct Station {
    plan: Plan,
    bench: Bench,
    table: AxisTable,
    phase: Phase,
    began: Option<RigTime>,
    feed: Feed,
    clamp: Clamp,
    sort: Sort,
    ledger: Ledger,
    mechanism: Mechanism,
    golden_left: VecDeque<GoldenPart>,
    golden_run: GoldenRun,
    coarse: (CoarseLag, CoarseLag),
    last_left: Option<RigTime>,
    lot_began: bool,
    stopping: bool,
}

impl Station {
    /// A station that knows nothing of its sensors yet.
    pub fn new(plan: Plan, bench: Bench, table: AxisTable, mechanism: Mechanism) -> Self {
        let golden_left = if plan.calibrated {
            VecDeque::new()
        } else {
            plan.golden.iter().cloned().collect()
        };
        Self {
            plan,
            bench,
            table,
            phase: Phase::Waiting,
            began: None,
            feed: Feed::Empty,
            clamp: Clamp::Empty,
            sort: Sort::Returning,
            ledger: Ledger::default(),
            mechanism,
            golden_left,
            golden_run: GoldenRun::default(),
            coarse: (CoarseLag::default(), CoarseLag::default()),
            last_left: None,
            lot_began: false,
            stopping: false,
        }
    }

    /// The part ledger.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// What the station is doing, in words for a screen.
    pub fn state(&self) -> String {
        match &self.phase {
            Phase::Waiting => "waiting for sensors".into(),
            Phase::Homing(_) => "homing".into(),
            Phase::ReferenceUp | Phase::Reference(_) | Phase::ReferenceDown => "calibrating".into(),
            Phase::Running if self.stopping => "stopping".into(),
            Phase::Running => match self.clamp.test() {
                Some(test) => format!("testing: {:?}", test.stage()),
                None if self.lot_began => "running".into(),
                None => "golden parts".into(),
            },
            Phase::Ended => "ended".into(),
        }
    }

    /// One turn.
    pub fn step(&mut self, now: RigTime, inputs: Inputs) -> Wants {
        let mut wants = Wants::default();
        let began = *self.began.get_or_insert(now);
        self.stopping |= inputs.stop;
        if matches!(self.phase, Phase::Ended) {
            return wants;
        }
        if self.stopping && !matches!(self.phase, Phase::Running) {
            wants.safe = true;
            wants.ending = Some(Ending::Stopped);
            self.phase = Phase::Ended;
            return wants;
        }
        wants
            .alarms
            .extend(self.mechanism.update(now, inputs.image));
        wants.alarms.extend(inputs.bus.clone());
        wants.alarms.extend(self.safety(now, began, inputs.image));
        if wants.alarms.is_empty() {
            self.advance(now, inputs, &mut wants);
        }
        debug_assert!(self.ledger.balances(), "a part is in two places or in none");
        if !wants.alarms.is_empty() {
            self.abort(now, &mut wants);
        }
        wants
    }

    /// A motion was cleared and driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        self.mechanism.driven(movement, now, image);
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

    /// A refused motion ends the run like any alarm.
    pub fn refused(&mut self, movement: Move, refusal: &str, now: RigTime, wants: &mut Wants) {
        wants.alarms.push(Alarm::refused(movement, refusal));
        self.abort(now, wants);
    }

    /// Safety inputs: open is an alarm, unknown is one after the first scan.
    fn safety(&self, now: RigTime, began: RigTime, image: &Image) -> Option<Alarm> {
        let inputs = [
            (
                DigitalIn::EmergencyStopOk,
                "emergency_stop",
                "Emergency stop pressed. Release it and start again.",
                "急停按下。请复位急停后重新启动。",
            ),
            (
                DigitalIn::DoorClosed,
                "door_open",
                "The door is open. Close it and start again.",
                "安全门打开。请关门后重新启动。",
            ),
            (
                DigitalIn::AirOk,
                "air_lost",
                "Air pressure is missing. Check the supply.",
                "气压不足。请检查气源。",
            ),
        ];
        for (point, code, en, zh) in inputs {
            match image.input(point, now, mechanism::SENSOR_AGE) {
                Some(true) => {}
                Some(false) => return Some(Alarm::safety(code, en, zh)),
                None if now.since(began) > FIRST_SCAN || !matches!(self.phase, Phase::Waiting) => {
                    return Some(Alarm::bus(&format!("{point} was not read for too long")));
                }
                None => return None,
            }
        }
        None
    }

    fn advance(&mut self, now: RigTime, inputs: Inputs, wants: &mut Wants) {
        match std::mem::replace(&mut self.phase, Phase::Ended) {
            Phase::Waiting => self.phase = self.first_scan(now, inputs.image),
            Phase::Homing(mut homing) => {
                let mut turn = self.turn(now, &inputs, wants);
                let home = homing.step(&mut turn);
                self.phase = match (home, self.plan.calibrated) {
                    (false, _) => Phase::Homing(homing),
                    (true, true) => Phase::Running,
                    (true, false) => {
                        wants.motions.push(Move::ProbesUp);
                        Phase::ReferenceUp
                    }
                };
            }
            Phase::ReferenceUp => {
                let up = self
                    .mechanism
                    .has_arrived(Move::ProbesUp, now, inputs.image);
                self.phase = if up {
                    Phase::Reference(Box::new(Runner::new(reference::acts(&self.bench), now)))
                } else {
                    Phase::ReferenceUp
                };
                wants.wake_at = up.then_some(now);
            }
            Phase::Reference(runner) => {
                self.phase = self.measure_references(now, &inputs, runner, wants)
            }
            Phase::ReferenceDown => {
                let down = self
                    .mechanism
                    .has_arrived(Move::ProbesDown, now, inputs.image);
                self.phase = if down {
                    Phase::Running
                } else {
                    Phase::ReferenceDown
                };
            }
            Phase::Running => {
                self.phase = Phase::Running;
                self.produce(now, inputs, wants);
            }
            Phase::Ended => {}
        }
    }

    fn first_scan(&self, now: RigTime, image: &Image) -> Phase {
        let seen = [
            DigitalIn::EmergencyStopOk,
            DigitalIn::SortZUp,
            DigitalIn::NestPresent,
            DigitalIn::GripperPart,
        ];
        if seen
            .iter()
            .all(|point| image.input(*point, now, mechanism::SENSOR_AGE).is_some())
        {
            Phase::Homing(Homing::default())
        } else {
            Phase::Waiting
        }
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
        }
    }

    /// Feed, nest and sorter, once each.
    fn produce(&mut self, now: RigTime, mut inputs: Inputs, wants: &mut Wants) {
        let job: Option<JobDone> = inputs.job.take();
        if !self.lot_began
            && self.golden_left.is_empty()
            && self
                .bench
                .calibration
                .lags
                .is_some_and(|lags| lags.operate.fine_v.u.is_finite())
        {
            self.lot_began = true;
            wants.lot_began = true;
        }
        let wanted = !self.stopping && self.wants_more();
        let test_running = matches!(self.clamp, Clamp::Testing(_) | Clamp::Judged);
        let (feed, clamp) = (self.feed, std::mem::replace(&mut self.clamp, Clamp::Empty));
        let (mut sort, mut last_left, bench) = (self.sort, self.last_left, self.bench.clone());
        let table = self.table.clone();
        let mut turn = self.turn(now, &inputs, wants);
        sort = sort.step(&mut turn, &table, test_running);
        let beside = Beside {
            job,
            bench: &bench,
            sort: &mut sort,
            last_left: &mut last_left,
        };
        let clamp = clamp.step(&mut turn, beside);
        let feed = feed.step(&mut turn, wanted);
        (self.feed, self.clamp, self.sort, self.last_left) = (feed, clamp, sort, last_left);
        self.learn(wants);
        self.maybe_end(inputs.recorded, wants);
    }

    fn wants_more(&self) -> bool {
        let golden = if self.plan.calibrated {
            0
        } else {
            self.plan.golden.len() as u64
        };
        self.plan
            .count
            .is_none_or(|count| self.ledger.came_in < golden + count)
    }

    fn maybe_end(&mut self, recorded: u64, wants: &mut Wants) {
        let ledger = &self.ledger;
        let empty = ledger.nest.is_none() && ledger.gripper.is_none() && ledger.falling.is_none();
        let feeding = matches!(
            self.feed,
            Feed::Releasing { .. } | Feed::Holding | Feed::Pushing | Feed::Retracting
        );
        let at_rest = matches!(self.sort, Sort::Returning | Sort::OverNest | Sort::Opening);
        let waiting_part = ledger.pocket && !self.stopping;
        if !empty
            || feeding
            || !at_rest
            || waiting_part
            || wants.judged.iter().any(|j| j.part.ordinal > recorded)
        {
            return;
        }
        if self.stopping || !self.wants_more() {
            wants.ending = Some(if self.wants_more() {
                Ending::Stopped
            } else {
                Ending::Complete
            });
            wants.safe = true;
            self.phase = Phase::Ended;
        }
    }

    /// Safe outputs, the part under test void, the run over.
    fn abort(&mut self, now: RigTime, wants: &mut Wants) {
        wants.motions.clear();
        wants.job = None;
        wants.safe = true;
        wants.outputs.push((DigitalOut::LampRed, true));
        wants.ending = Some(Ending::Alarm);
        self.phase = Phase::Ended;
        let why = wants
            .alarms
            .first()
            .map_or("alarm", |alarm| alarm.code.as_str())
            .to_string();
        let Some(part) = &mut self.ledger.nest else {
            return;
        };
        if part.bin.is_some() {
            return;
        }
        part.bin = Some(Bin::Retest);
        let (findings, judgements) = match std::mem::replace(&mut self.clamp, Clamp::Empty) {
            Clamp::Testing(test) => (test.findings.clone(), test.judgements()),
            Clamp::Empty
            | Clamp::Clamping
            | Clamp::Probing
            | Clamp::Judged
            | Clamp::Gripping
            | Clamp::Unclamping
            | Clamp::Lifting => Default::default(),
        };
        wants.judged.push(Judged {
            part: part.clone(),
            verdict: Verdict::Void(vec![format!("interrupted: {why}")]),
            judgements,
            findings,
            bench: self.bench.clone(),
            at: now,
        });
    }
}

#[cfg(test)]
mod tests;
