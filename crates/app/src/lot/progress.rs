//! Tracks the progress of a run, and decides how the run ends: [`LotProgress::exit`] chooses exit and cause.

use super::context::LotContext;
use super::counts::Counts;
use super::event::LotEvent;
use super::rows;
use super::summary::{BrokenPromise, Summary, WallProfile};
use crate::cycle::{Event, Profile};
use crate::exit::{Cause, Exit};
use crate::links::EepromCount;
use bus::LineLog;
use machine::dut::{Bin, Reason, Verdict};
use machine::handling::ledger::PartRole;
use machine::handling::output::{Interrupted, Judged, Landed};
use machine::station::trouble::Alarm;
use machine::station::turn::Ending;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use units::RigTime;

/// A judged part that has not landed yet.
#[derive(Debug)]
pub struct PartUnderWay {
    /// The part with its record and verdict.
    pub judged: Box<Judged>,
    /// Time from the moment the previous part left the nest to the moment this one left it, seconds of rig time; `None`
    /// before it leaves, and for the first part.
    pub cycle_s: Option<f64>,
    /// Number of reference parts judged so far; this part counts if it is one.
    pub reference_count: u64,
}

impl PartUnderWay {
    /// Returns the part's number within its kind, and the name of the kind.
    pub fn number(&self) -> (u64, &'static str) {
        rows::number(&self.judged.part.kind, self.reference_count)
    }
}

/// Progress of a run.
pub struct LotProgress<'a> {
    /// Plant, recipe, order and rig of the run.
    pub context: LotContext<'a>,
    /// Counts of parts and alarms.
    pub counts: Counts,
    /// Number of reference parts judged.
    pub reference_count: u64,
    began: Instant,
    lot_began: Option<RigTime>,
    last_landed: Option<RigTime>,
    under_way: BTreeMap<u64, PartUnderWay>,
    eeprom: EepromCount,
    eeprom_at_start: Option<u64>,
    broken: Vec<BrokenPromise>,
    /// First alarm of the present trouble; without present trouble, the last alarm.
    trouble: Option<Alarm>,
}

impl<'a> LotProgress<'a> {
    /// Creates the progress of a run that has had no event.
    pub fn new(context: LotContext<'a>, eeprom: EepromCount) -> Self {
        Self {
            context,
            counts: Counts::default(),
            reference_count: 0,
            began: Instant::now(),
            lot_began: None,
            last_landed: None,
            under_way: BTreeMap::new(),
            eeprom,
            eeprom_at_start: None,
            broken: Vec::new(),
            trouble: None,
        }
    }

    /// Returns the part with this ordinal while it is under way, from verdict to landing.
    pub fn part(&self, ordinal: u64) -> Option<&PartUnderWay> {
        self.under_way.get(&ordinal)
    }

    /// Returns judged parts per hour of rig time at `now`; `None` before the lot begins.
    pub fn per_hour(&self, now: RigTime) -> Option<f64> {
        let began = self.lot_began?;
        self.counts.per_hour(now.since(began).as_seconds())
    }

    /// Returns when the last part landed; before the first landing, when the lot began; before that, rig time zero.
    pub fn end(&self) -> RigTime {
        self.last_landed.or(self.lot_began).unwrap_or_default()
    }

    /// Takes an event of the cycle into account; returns the event of the run that follows from it.
    pub fn apply(&mut self, event: &Event) -> Option<LotEvent> {
        match event {
            Event::Judged(judged) => self.judged(judged),
            Event::Left(left) => {
                if let Some(part) = self.under_way.get_mut(&left.ordinal) {
                    part.cycle_s = left.cycle.map(|cycle| cycle.0);
                }
            }
            Event::Landed(landed) => return self.landed(landed),
            Event::Interrupted(interrupted) => self.interrupted(interrupted),
            Event::Alarm(alarm, _) => {
                self.counts.alarms += 1;
                self.trouble = Some(alarm.clone());
            }
            Event::ListedAlarms(standing, _) => {
                let first = standing.iter().find(|it| it.first_out && it.is_active());
                self.trouble = first.map(|it| it.alarm.clone()).or(self.trouble.take());
            }
            Event::LotBegan(at) => {
                self.lot_began = Some(*at);
                self.eeprom_at_start = (self.eeprom)();
            }
            Event::PromiseBroken(broken) => self.broken.push(BrokenPromise {
                after_parts: self.counts.parts(),
                broken: *broken,
            }),
            Event::State(_)
            | Event::Calibrated(_)
            | Event::Checked(..)
            | Event::Ordered(..)
            | Event::Inside(..) => {}
        }
        None
    }

    fn judged(&mut self, judged: &Judged) {
        let ordinal = judged.part.ordinal;
        match judged.part.kind {
            PartRole::Reference(_) => self.reference_count += 1,
            PartRole::Lot(_) => self.counts.add(judged.verdict.name()),
        }
        let part = PartUnderWay {
            judged: Box::new(judged.clone()),
            cycle_s: None,
            reference_count: self.reference_count,
        };
        let before = self.under_way.insert(ordinal, part);
        assert!(before.is_none(), "part {ordinal} was judged twice");
    }

    /// Makes a judged part void, because it goes to retest.
    fn interrupted(&mut self, interrupted: &Interrupted) {
        let Some(part) = self.under_way.get_mut(&interrupted.ordinal) else {
            return;
        };
        let mut reasons = part.judged.verdict.reasons().to_vec();
        reasons.push(Reason::interrupted(&interrupted.why));
        let before = std::mem::replace(&mut part.judged.verdict, Verdict::Void(reasons));
        part.judged.part.bin = Some(Bin::RETEST);
        if matches!(part.judged.part.kind, PartRole::Lot(_)) {
            self.counts.remove(before.name());
            self.counts.add("void");
        }
    }

    fn landed(&mut self, landed: &Landed) -> Option<LotEvent> {
        let part = self.under_way.remove(&landed.part.ordinal)?;
        if matches!(landed.part.kind, PartRole::Lot(_)) {
            self.last_landed = Some(landed.at);
            *self.counts.bins.entry(landed.bin.to_string()).or_insert(0) += 1;
        }
        Some(LotEvent::PartDone(Box::new(part), Some(landed.clone())))
    }

    /// Removes and returns the parts that will never land.
    pub fn take_unlanded(&mut self) -> impl Iterator<Item = LotEvent> + use<> {
        let parts = std::mem::take(&mut self.under_way).into_values();
        parts.map(|part| LotEvent::PartDone(Box::new(part), None))
    }

    /// Returns how the run ended: complete, stopped, or trouble with the alarm (else the abort) that caused it.
    pub fn exit(&self, ending: &Ending) -> Exit {
        match ending {
            Ending::Complete => Exit::Done,
            Ending::Stopped => Exit::Stopped,
            Ending::Alarm => {
                let alarm = self.trouble.as_ref();
                Exit::Trouble(alarm.map_or_else(Cause::aborted, Cause::from))
            }
        }
    }

    /// Returns the summary of the run; `writing` is the wall time that the history took.
    pub fn summary(
        &self,
        ending: &Ending,
        cause: Option<&Cause>,
        profile: &Profile,
        writing: Duration,
        logs: &[(String, LineLog)],
    ) -> Summary {
        let wall = self.began.elapsed();
        let began = self.lot_began;
        let elapsed_s = began.map_or(0.0, |began| self.end().since(began).as_seconds());
        let eeprom = self.eeprom_at_start.zip((self.eeprom)());
        let mut summary = Summary::new(&self.counts, (ending, cause), elapsed_s, wall, logs);
        summary.eeprom_writes = eeprom.map(|(before, after)| after - before);
        summary.broken_promises = self.broken.clone();
        summary.bodies_watched = self.context.source.bodies_watched();
        summary.wall_profile = WallProfile::new(profile, writing, wall);
        summary
    }
}
