//! Gates of a lot: conditions on the lot for the test of the next part, in addition to those of the machine.
//!
//! - *First article*: the first parts get confirmation measurements, so that every result is a mean.
//! - *Reference check*: compares a reference part, measured like a first article, with its certificate: at the start on
//!   a stored calibration, after a number of parts, or after a number of hours. When the check is due by parts, the
//!   machine expects the reference part at its place in the magazine; when it is due by hours, the line holds and
//!   requests the part. A failed check holds the line, and only reference parts are judged until one agrees with its
//!   certificate. An interrupted check begins again.
//! - *Calibration*: a calibration that expires during a lot stops the lot; the next start makes a new one.
//! - *Reject-rate limit*: too many failed parts hold the line, once.
//! - *Wear*: a counter at its limit raises an alarm, once, and the line continues; so does the mean resistance of the
//!   probe contact, once until it has been below its limit again.

use super::Station;
use super::catalogue::AlarmCode;
use super::packml::State;
use super::trouble::Alarm;
use super::turn::{Checked, TurnOutput};
use crate::dut::prompt::Prompt;
use crate::dut::verdict::Verdict;
use crate::handling::ledger::PartRole;
use crate::handling::output::Judged;
use crate::handling::serial::SerialSettings;
use crate::handling::wear::{Uses, Wearing};
use crate::handling::{Batch, Place};
use serde::Deserialize;
use units::{Ohm, RigTime, Span};

/// Number of parts judged before the reject-rate limit applies to a lot of unknown size.
const MIN_JUDGED: u64 = 20;

/// Settings of `lot.toml`; by default no gate applies.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct LotSettings {
    /// Number of parts at the beginning of a run that get confirmation measurements.
    pub first_article_parts: u64,
    /// Greatest share of failed parts, % of the parts ordered, else of those judged; `None` for no limit.
    #[serde(rename = "discard_limit_pct")]
    pub reject_rate_limit_pct: Option<f64>,
    /// When the machine checks a reference part.
    #[serde(rename = "golden_check")]
    pub reference_check: CheckSettings,
    /// Use counts at which probes and jaws count as worn, and the limit of the probe contact.
    pub wear: WearSettings,
    /// What a person must answer during every lot.
    #[serde(rename = "prompt")]
    pub prompts: Vec<Prompt>,
    /// Source of the serial numbers; without it the parts have none.
    pub serial: Option<SerialSettings>,
}

/// When the machine checks a reference part.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct CheckSettings {
    /// Before the first part of a run on a stored calibration.
    pub at_start: bool,
    /// Number of parts of the lot from one check to the next.
    pub after_parts: Option<u64>,
    /// Hours from one check to the next.
    pub after_h: Option<f64>,
}

impl CheckSettings {
    /// Returns true when any check is set.
    pub fn any(&self) -> bool {
        self.at_start || self.after_parts.is_some() || self.after_h.is_some()
    }
}

/// Limits of wear.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct WearSettings {
    /// Number of probe strokes at which the probes count as worn.
    pub probe_touches: Option<u64>,
    /// Number of jaw closings at which the jaws count as worn.
    pub jaw_closings: Option<u64>,
    /// Resistance of the coil's two force contacts above which an alarm is raised, ohm.
    pub probe_contact_ohm: Option<f64>,
}

/// State of the gates.
#[derive(Debug, Default)]
pub(super) struct Gates {
    /// True while only reference parts are tested, until one agrees with its certificate.
    checking: bool,
    /// Time of the last good check, and number of parts of the lot that had entered the nest by then; `None` before the
    /// first.
    good: Option<(RigTime, u64)>,
    judged: u64,
    failed: u64,
    /// True once the reject-rate limit has raised its alarm.
    reject_rate_reported: bool,
    /// Wearing parts whose counter has raised its alarm.
    worn: Vec<Wearing>,
    /// True from the alarm of the probe contact until its mean is below the limit again.
    fouled: bool,
}

impl Gates {
    /// Returns true while only reference parts may be judged.
    pub(super) fn is_checking(&self) -> bool {
        self.checking
    }

    /// Records a good check at `now`, when `parts` parts of the lot had entered the nest.
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

    /// Counts a part of the lot; returns true once, when the failed parts exceed the limit.
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
        let known = count.is_some() || self.judged >= MIN_JUDGED;
        let over = limit_pct.is_some_and(|pct| self.failed as f64 > size as f64 * pct / 100.0);
        let first = known && over && !self.reject_rate_reported;
        self.reject_rate_reported |= first;
        first
    }
}

impl Station {
    /// Plans a reference part as the next part. From now on only reference parts are judged, until one agrees with its
    /// certificate.
    pub(super) fn begin_check(&mut self) {
        let serials = &self.plan.reference_serials;
        self.lot.plan_references(&serials[..serials.len().min(1)]);
        self.lot.gates.checking = !serials.is_empty();
    }

    /// Begins a reference check if one is due; if the calibration has expired, raises the alarm for it.
    pub(super) fn begin_due_check(&mut self, now: RigTime, output: &mut TurnOutput) {
        let executes = self.machine.state == State::Execute;
        assert!(executes, "a reference check outside Execute");
        let at_us = self.plan.wall_clock_us(now);
        let overdue = self.device.due_at_us().is_some_and(|due| due <= at_us);
        // A batch that has begun with a valid calibration goes on to its end.
        let begins = self.line.batch().is_none_or(Batch::is_empty);
        if overdue && begins && !self.is_calibrating() {
            let trouble = &mut output.notes.trouble;
            return trouble.push(AlarmCode::CalibrationOverdue.into());
        }
        let none = self.plan.reference_serials.is_empty();
        if none || self.lot.gates.checking || self.is_calibrating() || !self.expects_more() {
            return;
        }
        let (parts, settings) = (self.line.ledger.lot_parts(), &self.plan.lot.reference_check);
        if self.lot.gates.good.is_none() {
            // The calibration, or the check at the start, counts as the first good check.
            self.lot.gates.good(now, parts);
        } else if self.lot.gates.due_by_parts(settings, parts) {
            self.begin_check();
        } else if self.lot.gates.due_by_time(settings, now) {
            self.begin_check();
            let trouble = &mut output.notes.trouble;
            trouble.extend(self.next_serial().map(Alarm::reference_check_due));
        }
    }

    fn next_serial(&self) -> Option<&str> {
        self.lot.reference_left.front().map(String::as_str)
    }

    /// Returns true until the reference parts have completed the calibration.
    pub(super) fn is_calibrating(&self) -> bool {
        !self.lot.reference_left.is_empty() || !self.device.is_calibrated()
    }

    /// Returns true when confirmation measurements repeat every result of the part in the nest.
    pub(super) fn is_thorough(&self) -> bool {
        match self.line.ledger.part(Place::NEST).map(|part| &part.role) {
            Some(PartRole::Lot(seq)) => *seq <= self.plan.lot.first_article_parts,
            Some(PartRole::Reference(_)) => self.lot.gates.checking,
            None => false,
        }
    }

    /// Concludes a reference check; begins the check again when it was interrupted or has failed.
    pub(super) fn check(&mut self, judged: &Judged, serial: &str, outcome: &mut Outcome) {
        if judged.part.interrupted.is_some() {
            return self.begin_check();
        }
        let (text, failure) = match self.device.check(serial, &judged.record) {
            Ok(()) => {
                self.lot.gates.good(judged.at, self.line.ledger.lot_parts());
                (serial.to_owned(), None)
            }
            Err(why) => {
                self.begin_check();
                let alarm = Alarm::reference_check_failed(&why.message());
                outcome.trouble.push(alarm.clone());
                (why.to_string(), Some(alarm))
            }
        };
        outcome.checked = Some(Checked { text, failure });
    }

    /// Counts a part of the lot against the reject-rate limit.
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

    /// Returns the use counts of the wearing parts in this run.
    pub fn uses(&self) -> Uses {
        let own = self.line.feeder();
        own.map_or_else(Uses::default, |own| own.mechanism.uses())
    }

    /// Returns the resistance of the probes in series with the part, mean over the last parts of the lot.
    pub fn probe_contact(&self) -> Option<Ohm> {
        self.device.probe_contact()
    }

    /// Returns the alarm of the probe contact when its mean has just exceeded the limit.
    fn fouled(&mut self) -> Option<Alarm> {
        let limit_ohm = self.plan.lot.wear.probe_contact_ohm?;
        let Ohm(mean) = self.device.settled_probe_contact()?;
        let raised = std::mem::replace(&mut self.lot.gates.fouled, mean > limit_ohm);
        (self.lot.gates.fouled && !raised).then(|| Alarm::probe_contact(mean, limit_ohm))
    }

    /// Returns the alarms of the probe contact and of the counters that have reached their limits, each once.
    pub(super) fn worn(&mut self) -> Vec<Alarm> {
        let uses = self.plan.worn.with(self.uses());
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

/// Consequences of the parts judged in a turn.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    pub trouble: Vec<Alarm>,
    pub checked: Option<Checked>,
}
