//! Tracks the progress of a run, and decides how the run ends: [`LotProgress::exit`] chooses exit and cause.

use super::context::LotContext;
use super::counts::Counts;
use super::event::LotEvent;
use super::rows;
use super::summary::{BrokenPromise, Summary, WallProfile};
use crate::exit::{Cause, Exit};
use crate::links::EepromCount;
use bus::LineLog;
use cycle::{Ended, Event};
use machine::dut::{Bin, Reason, Verdict};
use machine::handling::ledger::PartRole;
use machine::handling::output::{Interrupted, Judged, Landed};
use machine::station::catalogue::Reaction;
use machine::station::packml::State;
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
    /// Rig time from the moment the previous part left the nest to the moment this part left the nest, seconds; `None`
    /// while this part is in the nest, and for the first part.
    pub cycle_s: Option<f64>,
    /// Number of reference parts judged so far, including this part if it is a reference part.
    pub reference_count: u64,
}

impl PartUnderWay {
    /// Returns the number of the part among those of its kind, and the name of the kind (`lot` or `golden`).
    pub fn number(&self) -> (u64, &'static str) {
        rows::number(&self.judged.part.role, self.reference_count)
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
    /// First alarm of the last trouble: the first one that makes the machine abort, hold or suspend.
    trouble: Option<Alarm>,
    /// False while an alarm of the last trouble is active.
    trouble_is_over: bool,
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
            trouble_is_over: true,
        }
    }

    /// Returns the part with this ordinal (its number among all parts of the run) from its verdict until it lands.
    pub fn part(&self, ordinal: u64) -> Option<&PartUnderWay> {
        self.under_way.get(&ordinal)
    }

    /// Returns judged parts per hour of rig time at `now`; `None` until the lot has begun.
    pub fn per_hour(&self, now: RigTime) -> Option<f64> {
        let began = self.lot_began?;
        self.counts.per_hour(now.since(began).as_seconds())
    }

    /// Returns the rig time of the last landing; before the first landing, of the lot's beginning; before the lot,
    /// zero.
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
                if self.trouble_is_over && has_reaction(alarm) {
                    self.trouble = Some(alarm.clone());
                    self.trouble_is_over = false;
                }
            }
            Event::ListedAlarms(listed, _) => {
                let mut active = listed.iter().filter(|it| it.is_active());
                self.trouble_is_over = !active.any(|it| has_reaction(&it.alarm));
            }
            // An order caused this state, because the last trouble has ended.
            Event::State(State::Aborting | State::Suspending) if self.trouble_is_over => {
                self.trouble = None;
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
            | Event::BatchEnded(_)
            | Event::Found(_)
            | Event::Checked(..)
            | Event::Ordered(..)
            | Event::Prompted(_)
            | Event::Inside(..) => {}
        }
        None
    }

    fn judged(&mut self, judged: &Judged) {
        let ordinal = judged.part.ordinal;
        match judged.part.role {
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

    /// Changes the verdict of a judged part to void, because an interruption sends the part to retest.
    fn interrupted(&mut self, interrupted: &Interrupted) {
        let Some(part) = self.under_way.get_mut(&interrupted.ordinal) else {
            return;
        };
        let mut reasons = part.judged.verdict.reasons().to_vec();
        reasons.push(Reason::interrupted(&interrupted.why));
        let before = std::mem::replace(&mut part.judged.verdict, Verdict::Void(reasons));
        part.judged.part.bin = Some(Bin::RETEST);
        if matches!(part.judged.part.role, PartRole::Lot(_)) {
            self.counts.remove(before.name());
            self.counts.add("void");
        }
    }

    fn landed(&mut self, landed: &Landed) -> Option<LotEvent> {
        let part = self.under_way.remove(&landed.part.ordinal)?;
        if matches!(landed.part.role, PartRole::Lot(_)) {
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

    /// Returns how the run ended: complete, stopped, or in trouble. The cause of trouble is an alarm, or else
    /// `aborted`.
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
        ended: &Ended,
        cause: Option<&Cause>,
        writing: Duration,
        logs: &[(String, LineLog)],
    ) -> Summary {
        let wall = self.began.elapsed();
        let began = self.lot_began;
        let elapsed_s = began.map_or(0.0, |began| self.end().since(began).as_seconds());
        let eeprom = self.eeprom_at_start.zip((self.eeprom)());
        let mut summary = Summary::new(&self.counts, (&ended.ending, cause), elapsed_s, wall, logs);
        summary.eeprom_writes = eeprom.map(|(before, after)| after - before);
        summary.broken_promises = self.broken.clone();
        summary.bodies_watched = self.context.source.bodies_watched();
        summary.wall_profile = WallProfile::new(&ended.profile, writing, wall);
        let is_real = !self.context.source.is_virtual();
        summary.lateness = is_real.then(|| ended.lateness.view());
        summary
    }
}

fn has_reaction(alarm: &Alarm) -> bool {
    alarm.code.entry().reaction != Reaction::Nothing
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::lot::Purpose;
    use crate::order::LotOrder;
    use crate::source::RigSource;
    use config::{Folder, Plant, load_recipe};
    use machine::handling::wear::Wearing;
    use machine::station::annunciator::Annunciator;
    use machine::station::catalogue::AlarmCode;
    use std::sync::Arc;

    /// Passes an alarm to `lot` as the cycle does: the alarm, then the list.
    fn raise(lot: &mut LotProgress, list: &mut Annunciator, code: AlarmCode) {
        let alarm = Alarm::from(code);
        list.raise(&alarm, RigTime(1));
        lot.apply(&Event::Alarm(alarm, RigTime(1)));
        pass(lot, list);
    }

    fn pass(lot: &mut LotProgress, list: &Annunciator) {
        lot.apply(&Event::ListedAlarms(list.listed().to_vec(), RigTime(1)));
    }

    #[test]
    fn an_exit_names_the_cause_of_its_own_abort() {
        let config = Folder::built_in();
        let plant = Plant::load(&config).unwrap();
        let recipe = Arc::new(load_recipe(&config, "jzc-22f-012").unwrap());
        let order = LotOrder {
            lot: "A".into(),
            recipe: recipe.name.clone(),
            count: None,
            retest: None,
        };
        let source = RigSource::Serial(Vec::new());
        let context = LotContext::new(&plant, (&order, &recipe), &source, Purpose::Lot);
        let mut lot = LotProgress::new(context, Box::new(|| None));
        let mut list = Annunciator::default();
        let exit = |code: AlarmCode| Exit::Trouble(Cause::from(&code.into()));

        raise(&mut lot, &mut list, AlarmCode::Worn(Wearing::ALL[0]));
        raise(&mut lot, &mut list, AlarmCode::DoorOpen);
        lot.apply(&Event::State(State::Aborting));
        assert_eq!(lot.exit(&Ending::Alarm), exit(AlarmCode::DoorOpen));

        list.sensed(&[]);
        pass(&mut lot, &list);
        let closed = "a door that closes again does not hide the cause";
        assert_eq!(
            lot.exit(&Ending::Alarm),
            exit(AlarmCode::DoorOpen),
            "{closed}"
        );

        lot.apply(&Event::State(State::Execute));
        lot.apply(&Event::State(State::Aborting));
        assert_eq!(lot.exit(&Ending::Alarm), Exit::Trouble(Cause::aborted()));

        raise(&mut lot, &mut list, AlarmCode::AirLost);
        raise(&mut lot, &mut list, AlarmCode::StepTooLong);
        assert_eq!(lot.exit(&Ending::Alarm), exit(AlarmCode::AirLost));
    }
}
