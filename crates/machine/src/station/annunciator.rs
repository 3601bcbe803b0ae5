//! List of alarms in the states of ISA-18.2.
//!
//! | state | cause present | acknowledged |
//! |---|---|---|
//! | unacknowledged | yes | no |
//! | acknowledged | yes | yes |
//! | returned | no | no |
//! | shelved | either | hidden until its time is over |
//!
//! An acknowledged alarm without cause leaves the list. Alarms of one code share a line if the argument that
//! distinguishes them (for example the place of a lost part) is the same. A listed alarm whose cause returns raises its
//! count; while the cause lasts, only the alarms of [`PER_PART`] raise theirs. So the counts of the list equal the
//! occurrences in the history. An alarm raised while no other is active is the *first-out*; it remains so while it is
//! listed, unless its cause returns during another alarm. Acknowledging resets nothing.

use super::catalogue::{ClearedBy, Entry, PER_PART, Reaction};
use super::trouble::Alarm;
use units::RigTime;

named! {
    /// State of a listed alarm.
    Condition {
        /// The cause is present, and no person has acknowledged the alarm.
        Unacknowledged = "unacknowledged",
        /// The cause is present, and a person has acknowledged the alarm.
        Acknowledged = "acknowledged",
        /// The cause went away before a person acknowledged the alarm.
        Returned = "returned",
    }
}

/// One alarm of the list.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedAlarm {
    /// Code and arguments.
    pub alarm: Alarm,
    /// State of the alarm.
    pub condition: Condition,
    /// Time of the first occurrence.
    pub raised: RigTime,
    /// Number of occurrences.
    pub count: u32,
    /// True for the alarm whose cause last appeared while no other alarm was active.
    pub first_out: bool,
    /// End of the time for which the alarm is shelved; `None` while it is not shelved.
    pub shelved_until: Option<RigTime>,
    /// True for an alarm of an earlier run, whose times do not apply to this run.
    pub inherited: bool,
}

impl ListedAlarm {
    /// Returns true while the cause is present.
    pub fn is_active(&self) -> bool {
        self.condition != Condition::Returned
    }

    fn entry(&self) -> Entry {
        self.alarm.code.entry()
    }
}

/// The list of alarms.
#[derive(Debug, Clone, Default)]
pub struct Annunciator {
    listed: Vec<ListedAlarm>,
    changed: bool,
}

impl Annunciator {
    /// Returns the listed alarms, in order of first occurrence.
    pub fn listed(&self) -> &[ListedAlarm] {
        &self.listed
    }

    /// Returns true if the list has changed since the last call.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }

    /// Lists an alarm of an earlier run as returned, because it was unacknowledged when that run's program ended; if
    /// the cause remains, this run detects it again. A shelved alarm stays shelved.
    pub fn inherit(&mut self, alarm: Alarm, count: u32, shelved_until: Option<RigTime>) {
        self.changed = true;
        self.listed.push(ListedAlarm {
            alarm,
            condition: Condition::Returned,
            raised: RigTime(0),
            count,
            first_out: false,
            shelved_until,
            inherited: true,
        });
    }

    /// Lists an alarm or raises its count; returns true when it did either.
    pub fn raise(&mut self, alarm: &Alarm, now: RigTime) -> bool {
        let quiet = !self.listed.iter().any(ListedAlarm::is_active);
        let at_once = alarm.code.entry().cleared_by == ClearedBy::Itself;
        let condition = if at_once {
            Condition::Returned
        } else {
            Condition::Unacknowledged
        };
        let first_out = quiet && !at_once;
        if first_out {
            self.listed.iter_mut().for_each(|one| one.first_out = false);
        }
        let mut same = self
            .listed
            .iter_mut()
            .filter(|one| one.alarm.is_same(alarm));
        let known = same.next();
        assert!(same.next().is_none(), "{} is listed twice", alarm.code);
        let Some(known) = known else {
            self.changed = true;
            self.listed.push(ListedAlarm {
                alarm: alarm.clone(),
                condition,
                raised: now,
                count: 1,
                first_out,
                shelved_until: None,
                inherited: false,
            });
            return true;
        };
        let again = !known.is_active();
        if !again && !PER_PART.contains(&known.alarm.code) {
            return false;
        }
        self.changed = true;
        known.count += 1;
        known.alarm = alarm.clone();
        if again {
            known.condition = condition;
            known.first_out = first_out;
            known.inherited = false;
        }
        true
    }

    /// Clears the alarms that a sensor clears, except those in `there`, whose cause remains.
    pub fn sensed(&mut self, there: &[Alarm]) {
        self.gone(|one| {
            let by_sensor = one.entry().cleared_by == ClearedBy::Sensor;
            by_sensor && !there.iter().any(|alarm| alarm.is_same(&one.alarm))
        });
    }

    /// Clears the alarms that an operator clears.
    pub fn cleared(&mut self) {
        self.gone(|one| one.entry().cleared_by == ClearedBy::Operator);
    }

    fn gone(&mut self, is_gone: impl Fn(&ListedAlarm) -> bool) {
        let changed = &mut self.changed;
        self.listed.retain_mut(|one| {
            if !one.is_active() || !is_gone(one) {
                return true;
            }
            *changed = true;
            let stays = one.condition == Condition::Unacknowledged;
            one.condition = Condition::Returned;
            stays
        });
        let active = self
            .listed
            .iter()
            .any(|one| one.is_active() && is_gone(one));
        assert!(!active, "an alarm without cause is active");
    }

    /// Acknowledges the alarm with this code, or every alarm when `code` is `None`; returns false when there is none.
    pub fn acknowledge(&mut self, code: Option<&str>) -> bool {
        let mut found = false;
        self.listed.retain_mut(|one| {
            if code.is_some_and(|code| one.alarm.code.name() != code) {
                return true;
            }
            found = true;
            let stays = one.is_active();
            one.condition = Condition::Acknowledged;
            stays
        });
        self.changed |= found;
        found
    }

    /// Shelves every alarm with this code; returns false when there is none.
    pub fn shelve(&mut self, code: &str, until: RigTime) -> bool {
        let mut found = false;
        for one in &mut self.listed {
            if one.alarm.code.name() == code {
                found = true;
                one.shelved_until = Some(until);
            }
        }
        self.changed |= found;
        found
    }

    /// Shows alarms again whose shelving time is over.
    pub fn unshelve(&mut self, now: RigTime) {
        for one in &mut self.listed {
            if one.shelved_until.is_some_and(|until| until <= now) {
                one.shelved_until = None;
                self.changed = true;
            }
        }
    }

    /// Returns the first active alarm with this reaction.
    pub fn stopping(&self, stops: Reaction) -> Option<&ListedAlarm> {
        self.listed
            .iter()
            .find(|one| one.is_active() && one.entry().reaction == stops)
    }

    /// Returns the first active alarm with the reaction `Abort` that only a sensor can clear, whose cause the sensor
    /// thus still shows.
    pub fn still_sensed(&self) -> Option<&ListedAlarm> {
        self.listed.iter().find(|one| {
            let entry = one.entry();
            one.is_active()
                && entry.cleared_by == ClearedBy::Sensor
                && entry.reaction == Reaction::Abort
        })
    }
}
