//! Alarms that stand, in the states of ISA-18.2.
//!
//! | state | cause there | seen by a person |
//! |---|---|---|
//! | unacknowledged | yes | no |
//! | acknowledged | yes | yes |
//! | returned | no | no |
//! | shelved | either | not shown until its time is over |
//!
//! An alarm whose cause is gone and that was seen is normal again and leaves the list. One that comes again
//! while it stands is counted, not listed twice. The first one after a quiet time is the *first-out*
//! and stays so until the list is empty of causes. Acknowledging resets nothing.

use super::catalogue::{ClearedBy, Entry, PER_PART, Reaction};
use super::trouble::Alarm;
use units::RigTime;

/// State of a standing alarm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// The cause is there, nobody has seen it.
    Unacknowledged,
    /// The cause is there, somebody has.
    Acknowledged,
    /// The cause has gone before anybody saw it.
    Returned,
}

impl Condition {
    /// Every one.
    pub const ALL: [Self; 3] = [Self::Unacknowledged, Self::Acknowledged, Self::Returned];

    /// The name in files and views.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unacknowledged => "unacknowledged",
            Self::Acknowledged => "acknowledged",
            Self::Returned => "returned",
        }
    }
}

/// One alarm of the list.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// What happened.
    pub alarm: Alarm,
    /// Its state.
    pub condition: Condition,
    /// When it came first.
    pub raised: RigTime,
    /// How often since.
    pub count: u32,
    /// It began the trouble.
    pub first_out: bool,
    /// Not shown before this time.
    pub shelved_until: Option<RigTime>,
    /// Kept from a run before: its times are not of this one.
    pub inherited: bool,
}

impl Standing {
    /// The cause is there.
    pub fn is_active(&self) -> bool {
        self.condition != Condition::Returned
    }

    fn entry(&self) -> Entry {
        self.alarm.code.entry()
    }
}

/// The list.
#[derive(Debug, Clone, Default)]
pub struct Annunciator {
    standing: Vec<Standing>,
    changed: bool,
}

impl Annunciator {
    /// The list, in order of coming.
    pub fn standing(&self) -> &[Standing] {
        &self.standing
    }

    /// True once after every change.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }

    /// Puts in an alarm that nobody had acknowledged when the program ended: what its cause does now is found out
    /// anew, what nobody has seen stays unseen, and what was shelved stays on the shelf.
    pub fn inherit(&mut self, alarm: Alarm, count: u32, shelved_until: Option<RigTime>) {
        self.changed = true;
        self.standing.push(Standing {
            alarm,
            condition: Condition::Returned,
            raised: RigTime(0),
            count,
            first_out: false,
            shelved_until,
            inherited: true,
        });
    }

    /// An alarm is there; true when its cause was not there before, or when it is about a body of its own.
    pub fn raise(&mut self, alarm: &Alarm, now: RigTime) -> bool {
        let quiet = !self.standing.iter().any(Standing::is_active);
        let at_once = alarm.code.entry().cleared_by == ClearedBy::Itself;
        let condition = if at_once {
            Condition::Returned
        } else {
            Condition::Unacknowledged
        };
        let twice = self
            .standing
            .iter()
            .filter(|one| one.alarm.code == alarm.code);
        assert!(twice.count() <= 1, "{} stands twice", alarm.code);
        let known = self
            .standing
            .iter_mut()
            .find(|one| one.alarm.code == alarm.code);
        let Some(known) = known else {
            self.changed = true;
            self.standing.push(Standing {
                alarm: alarm.clone(),
                condition,
                raised: now,
                count: 1,
                first_out: quiet && !at_once,
                shelved_until: None,
                inherited: false,
            });
            return true;
        };
        let again = !known.is_active();
        if again || known.entry().cleared_by == ClearedBy::Operator {
            self.changed = true;
            known.count += 1;
            known.alarm = alarm.clone();
        }
        if again {
            known.condition = condition;
            known.first_out = quiet && !at_once;
            known.inherited = false;
        }
        again || PER_PART.contains(&known.alarm.code)
    }

    /// Alarms that go by their sensor and whose cause is not among `there` any more have gone.
    pub fn sensed(&mut self, there: &[Alarm]) {
        self.gone(|one| {
            let by_sensor = one.entry().cleared_by == ClearedBy::Sensor;
            by_sensor && !there.iter().any(|alarm| alarm.code == one.alarm.code)
        });
    }

    /// A person says that the causes are gone.
    pub fn cleared(&mut self) {
        self.gone(|one| one.entry().cleared_by == ClearedBy::Operator);
    }

    fn gone(&mut self, is_gone: impl Fn(&Standing) -> bool) {
        for one in &mut self.standing {
            if one.is_active() && is_gone(one) {
                self.changed = true;
                one.condition = match one.condition {
                    // Marked here, taken out below.
                    Condition::Acknowledged => {
                        one.count = 0;
                        Condition::Returned
                    }
                    Condition::Unacknowledged | Condition::Returned => Condition::Returned,
                };
            }
        }
        self.standing.retain(|one| one.count > 0);
        let active = self
            .standing
            .iter()
            .any(|one| one.is_active() && is_gone(one));
        assert!(!active, "an alarm stands whose cause is gone");
    }

    /// A person has seen the alarm of this code, or all; false when there is none.
    pub fn acknowledge(&mut self, code: Option<&str>) -> bool {
        let mut found = false;
        for one in &mut self.standing {
            if code.is_none_or(|code| one.alarm.code.name() == code) {
                found = true;
                match one.condition {
                    Condition::Unacknowledged => one.condition = Condition::Acknowledged,
                    Condition::Acknowledged => {}
                    Condition::Returned => one.count = 0,
                }
            }
        }
        self.standing.retain(|one| one.count > 0);
        self.changed |= found;
        found
    }

    /// Shelves the alarm of this code; false when there is none.
    pub fn shelve(&mut self, code: &str, until: RigTime) -> bool {
        let one = self
            .standing
            .iter_mut()
            .find(|one| one.alarm.code.name() == code);
        self.changed |= one.is_some();
        one.map(|one| one.shelved_until = Some(until)).is_some()
    }

    /// Alarms whose time on the shelf is over are shown again.
    pub fn unshelve(&mut self, now: RigTime) {
        for one in &mut self.standing {
            if one.shelved_until.is_some_and(|until| until <= now) {
                one.shelved_until = None;
                self.changed = true;
            }
        }
    }

    /// The first active alarm that stops as much as this.
    pub fn stopping(&self, stops: Reaction) -> Option<&Standing> {
        self.standing
            .iter()
            .find(|one| one.is_active() && one.entry().reaction == stops)
    }

    /// The first active alarm whose sensor still shows the cause.
    pub fn still_sensed(&self) -> Option<&Standing> {
        self.standing.iter().find(|one| {
            let entry = one.entry();
            one.is_active()
                && entry.cleared_by == ClearedBy::Sensor
                && entry.reaction == Reaction::Abort
        })
    }
}
