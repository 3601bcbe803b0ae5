//! Gates of a lot: what must hold before the next part may be judged, beside the machine itself.
//!
//! - *First article*: the first parts are measured by the slow strategy, every result a mean.
//! - *Golden check*: a golden part is measured like a first article and compared with its certificate: when a stored
//!   calibration is used, after so many parts, after so many hours. By parts it is expected in its place of the magazine;
//!   by hours nobody can have put it there, so that the line holds and asks for it. A check that fails holds the line,
//!   and the next part has to be a golden one again: nothing else is judged before one has read as certified.
//!   A golden part that was interrupted has said nothing: the check is made anew.
//! - *Calibration*: one that runs out during a lot stops it; the next start makes a new one.
//! - *Discard limit*: more failed parts than the lot may have hold the line, once.
//! - *Wear*: a counter at its limit is told, once, and the line goes on. So is the contact of the probes, where the
//!   mean over the last parts is beyond its limit.

use super::Station;
use super::catalogue::AlarmCode;
use super::packml::State;
use super::trouble::Alarm;
use super::wants::{Checked, Wants};
use crate::dut::verdict::Verdict;
use crate::handling::Place;
use crate::handling::ledger::Kind;
use crate::handling::wants::Judged;
use crate::handling::wear::{Uses, Wearing};
use serde::Deserialize;
use std::collections::VecDeque;
use units::{Ohm, RigTime, Span};

/// Without a known size of the lot a share of failed parts means something from so many on.
const ENOUGH: u64 = 20;

/// What a lot is run by, `lot.toml`. Nothing is asked for by default.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct LotSettings {
    /// Parts at the begin of a run that are measured by the slow strategy.
    pub first_article_parts: u64,
    /// Failed parts that a lot may have, % of its size.
    #[serde(rename = "discard_limit_pct")]
    pub reject_rate_limit_pct: Option<f64>,
    /// When a golden part is measured.
    pub golden_check: CheckSettings,
    /// Uses after which probes and jaws are worn.
    pub wear: WearSettings,
}

/// When a golden part is measured.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct CheckSettings {
    /// Before the first part of a run on a stored calibration.
    pub at_start: bool,
    /// After so many parts of the lot.
    pub after_parts: Option<u64>,
    /// After so many hours.
    pub after_h: Option<f64>,
}

impl CheckSettings {
    /// Some check is asked for.
    pub fn any(&self) -> bool {
        self.at_start || self.after_parts.is_some() || self.after_h.is_some()
    }
}

/// Uses after which something is worn.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct WearSettings {
    /// Of the probes: times they rose.
    pub probe_touches: Option<u64>,
    /// Of the jaws: times they closed.
    pub jaw_closings: Option<u64>,
    /// Of the probes at the coil: resistance in series of both force contacts, ohm.
    pub probe_contact_ohm: Option<f64>,
}

/// Where the gates stand.
#[derive(Debug, Default)]
pub(super) struct Gates {
    /// A golden part has to read as certified before anything else is judged.
    checking: bool,
    /// When one last did, and how many parts of the lot had entered the nest by then.
    good: Option<(RigTime, u64)>,
    judged: u64,
    failed: u64,
    /// The discard limit was told.
    reject_rate_reported: bool,
    /// Counters whose limit was told.
    worn: Vec<Wearing>,
    /// The limit of the probes' contact is passed, and was told.
    fouled: bool,
}

impl Gates {
    /// Nothing but a golden part may be judged now.
    pub(super) fn is_checking(&self) -> bool {
        self.checking
    }

    /// The rig reads as certified now.
    pub(super) fn good(&mut self, now: RigTime, parts: u64) {
        let before = self.good.map_or(0, |(_, parts)| parts);
        assert!(parts >= before, "fewer parts of the lot than before");
        self.checking = false;
        self.good = Some((now, parts));
    }

    fn due_by_parts(&self, settings: &CheckSettings, parts: u64) -> bool {
        let since = parts - self.good.map_or(0, |(_, parts)| parts);
        settings.after_parts.is_some_and(|after| since >= after)
    }

    fn due_by_time(&self, settings: &CheckSettings, now: RigTime) -> bool {
        let (Some(after_h), Some((at, _))) = (settings.after_h, self.good) else {
            return false;
        };
        now.since(at) >= Span::seconds(after_h * 3600.0)
    }

    /// Counts a part of the lot; true when it is one failed part too many, once.
    fn exceeds_reject_rate(
        &mut self,
        failed: bool,
        limit_pct: Option<f64>,
        count: Option<u64>,
    ) -> bool {
        self.judged += 1;
        self.failed += u64::from(failed);
        assert!(self.failed <= self.judged, "more failed than judged");
        let size = count.unwrap_or(self.judged).max(self.judged);
        let known = count.is_some() || self.judged >= ENOUGH;
        let over = limit_pct.is_some_and(|pct| self.failed as f64 > size as f64 * pct / 100.0);
        let first = known && over && !self.reject_rate_reported;
        self.reject_rate_reported |= first;
        first
    }
}

impl Station {
    /// A golden part comes next: nothing else is judged before one has read as certified.
    pub(super) fn begin_check(&mut self) {
        let next: VecDeque<String> = self.plan.golden.first().cloned().into_iter().collect();
        self.lot.reference_planned +=
            next.len().saturating_sub(self.lot.reference_left.len()) as u64;
        self.lot.gates.checking = !next.is_empty();
        self.lot.reference_left = next;
    }

    /// Looks whether a golden check is due while parts are being made.
    pub(super) fn look_for_check(&mut self, now: RigTime, wants: &mut Wants) {
        let executes = self.machine.state == State::Execute;
        assert!(executes, "a check is looked for while nothing is made");
        let at_us = self.plan.epoch_us + i64::try_from(now.0).unwrap_or(i64::MAX);
        if !self.is_calibrating()
            && self
                .device
                .due_at_us()
                .is_some_and(|due_us| due_us <= at_us)
        {
            return wants
                .notes
                .trouble
                .push(AlarmCode::CalibrationOverdue.into());
        }
        let none = self.plan.golden.is_empty();
        if none || self.lot.gates.checking || self.is_calibrating() || !self.wants_more() {
            return;
        }
        let (parts, settings) = (self.line.ledger.lot_parts(), &self.plan.lot.golden_check);
        if self.lot.gates.good.is_none() {
            // What the run began with counts as good: its calibration, or the check before the first part.
            self.lot.gates.good(now, parts);
        } else if self.lot.gates.due_by_parts(settings, parts) {
            self.begin_check();
        } else if self.lot.gates.due_by_time(settings, now) {
            self.begin_check();
            let trouble = &mut wants.notes.trouble;
            trouble.extend(self.next_serial().map(Alarm::reference_check_due));
        }
    }

    fn next_serial(&self) -> Option<&str> {
        self.lot.reference_left.front().map(String::as_str)
    }

    /// Golden parts that teach the lags are still to come or have not taught them yet.
    pub(super) fn is_calibrating(&self) -> bool {
        !self.lot.reference_left.is_empty() || !self.device.is_calibrated()
    }

    /// The part in the nest is measured by the slow strategy.
    pub(super) fn is_thorough(&self) -> bool {
        match self.line.ledger.part(Place::NEST).map(|part| &part.kind) {
            Some(Kind::Lot(seq)) => *seq <= self.plan.lot.first_article_parts,
            Some(Kind::Reference(_)) => self.lot.gates.checking,
            None => false,
        }
    }

    /// A golden part of a check was measured, or was not because it was interrupted.
    pub(super) fn check(&mut self, judged: &Judged, serial: &str, outcome: &mut Outcome) {
        if judged.part.interrupted.is_some() {
            return self.begin_check();
        }
        let read = self.device.check(serial, &judged.record);
        outcome.checked = Some(Checked {
            passed: read.is_ok(),
            text: match &read {
                Ok(()) => serial.to_owned(),
                Err(why) => why.to_string(),
            },
        });
        match read {
            Ok(()) => self.lot.gates.good(judged.at, self.line.ledger.lot_parts()),
            Err(why) => {
                self.begin_check();
                outcome
                    .trouble
                    .push(Alarm::reference_check_failed(&why.to_string()));
            }
        }
    }

    /// Counts a part of the lot against the discard limit.
    pub(super) fn count_rejects(&mut self, judged: &Judged, outcome: &mut Outcome) {
        let failed = matches!(judged.verdict, Verdict::Fail(_));
        let (limit_pct, count) = (self.plan.lot.reject_rate_limit_pct, self.plan.count);
        if self.lot.gates.exceeds_reject_rate(failed, limit_pct, count) {
            let (failed, judged) = (self.lot.gates.failed, self.lot.gates.judged);
            outcome.trouble.push(Alarm::reject_rate_limit(
                failed,
                judged,
                limit_pct.unwrap_or_default(),
            ));
        }
    }

    /// Uses of what wears in this run.
    pub fn uses(&self) -> Uses {
        self.line.mechanism.uses()
    }

    /// Resistance of the probes in series with the part, mean over the last parts of the lot.
    pub fn probe_contact(&self) -> Option<Ohm> {
        self.device.probe_contact()
    }

    /// The limit of the probes' contact is passed, told once until it is kept again.
    fn fouled(&mut self) -> Option<Alarm> {
        let limit_ohm = self.plan.lot.wear.probe_contact_ohm?;
        let Ohm(mean) = self.device.settled_probe_contact()?;
        let told = std::mem::replace(&mut self.lot.gates.fouled, mean > limit_ohm);
        (self.lot.gates.fouled && !told).then(|| Alarm::probe_contact(mean, limit_ohm))
    }

    /// Counters at their limit, each told once.
    pub(super) fn worn(&mut self) -> Vec<Alarm> {
        let uses = self.plan.worn.with(self.line.mechanism.uses());
        let limits = &self.plan.lot.wear;
        let each = [
            (Wearing::Probes, uses.probe_touches, limits.probe_touches),
            (Wearing::Jaws, uses.jaw_closings, limits.jaw_closings),
        ];
        let mut alarms: Vec<Alarm> = self.fouled().into_iter().collect();
        for (what, count, limit) in each {
            if let Some(limit) = limit.filter(|limit| count >= *limit)
                && !self.lot.gates.worn.contains(&what)
            {
                self.lot.gates.worn.push(what);
                alarms.push(Alarm::worn(what, count, limit));
            }
        }
        alarms
    }
}

/// What the parts judged in a turn have told.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    pub trouble: Vec<Alarm>,
    pub checked: Option<Checked>,
}
