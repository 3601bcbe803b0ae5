//! State of many rigs, as the page of all rigs shows it. The database that collects the histories gives two answers:
//! what each rig does now, and what each rig made in the last shifts.

use super::pareto::Ranked;
use super::shifts::ShiftYield;
use crate::{LotYield, Moment};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use utoipa::ToSchema;

/// Longest silence of a rig with an open run before its condition is [`Condition::Silent`], seconds.
pub const SILENT_S: f64 = 300.0;
/// Longest time from the judgement of a part to its sending before the condition is [`Condition::Late`], seconds.
pub const LATE_S: f64 = 300.0;

/// Latest answers about all rigs. Old answers remain while the database does not answer; `trouble` then says why.
#[derive(Debug, Clone, PartialEq, Default, Serialize, ToSchema)]
pub struct Overview {
    /// Address of the database, without password.
    pub target: String,
    /// Why the last question failed; `None` when it succeeded.
    pub trouble: Option<Trouble>,
    /// What each rig does.
    pub now: Option<Now>,
    /// What each rig made in the last shifts.
    pub day: Option<Day>,
}

/// A database that does not answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Trouble {
    /// English text that names the database, what happened and the remedy.
    pub text: String,
    /// Code of the remedy, in family `rigs_remedy` of the texts.
    pub remedy: &'static str,
    /// Time of the first question that failed.
    pub since: Moment,
}

/// What each rig does.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Now {
    /// Clock of the database when it answered.
    pub at: Moment,
    /// Rigs, in order of plant and name.
    pub rigs: Vec<RigNow>,
}

/// What a rig does.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct RigNow {
    /// Name of the plant.
    pub site: String,
    /// Name of the rig.
    pub rig: String,
    /// The worst condition that applies.
    pub condition: Condition,
    /// Name of the computer that sends the rows of the rig.
    pub host: String,
    /// Arrival of the last rows; a rig sends only new rows.
    pub contact: Option<Moment>,
    /// Seconds from `contact` to [`Now::at`].
    pub silent_s: Option<f64>,
    /// Seconds from the judgement of the newest part to its sending, both by the clock of the rig.
    pub lag_s: Option<f64>,
    /// Clock of the rig minus that of the database at the last contact, seconds.
    pub clock_ahead_s: Option<f64>,
    /// The latest run.
    pub run: Option<LatestRun>,
    /// Time of judgement of the newest part; `None` without a part in the last 36 hours.
    pub last_part: Option<Moment>,
    /// Number of production parts judged in the last hour.
    pub parts_per_hour: u64,
    /// Active alarms of the latest run, the newest first.
    pub alarms: Vec<ActiveAlarm>,
    /// Newest calibration for each coil voltage.
    pub calibrations: Vec<CalibrationDue>,
}

/// The run that a rig began last.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct LatestRun {
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// Name of the recipe.
    pub recipe: String,
    /// `rig`, `simulated` or `import`.
    pub source: String,
    /// Start of the run.
    pub opened: Moment,
    /// End of the run; `None` while the run is open.
    pub closed: Option<Moment>,
}

/// Condition of a rig: the first of these that applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// An alarm is active in the open run.
    Alarm,
    /// A run is open, and no rows have arrived for over [`SILENT_S`].
    Silent,
    /// The rig sends parts later than [`LATE_S`] after their judgement.
    Late,
    /// A run is open.
    Testing,
    /// No run is open.
    Idle,
}

impl Condition {
    /// Returns the condition of a rig with these facts.
    #[must_use]
    pub fn of(is_open: bool, alarms: usize, silent_s: Option<f64>, lag_s: Option<f64>) -> Self {
        let over = |found: Option<f64>, most| found.is_some_and(|it| it > most);
        match is_open {
            true if alarms > 0 => Self::Alarm,
            true if over(silent_s, SILENT_S) => Self::Silent,
            _ if over(lag_s, LATE_S) => Self::Late,
            true => Self::Testing,
            false => Self::Idle,
        }
    }
}

/// An alarm that is active.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct ActiveAlarm {
    /// Code of the alarm.
    pub code: String,
    /// Message in English.
    pub text: String,
    /// Message in Chinese; `None` when this program does not know the code.
    pub text_zh: Option<String>,
    /// Time at which the alarm was raised.
    pub raised: Moment,
    /// True after a person has acknowledged the alarm.
    pub acknowledged: bool,
}

/// When a calibration expires.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct CalibrationDue {
    /// Nominal coil voltage of the reference parts, V; `None` for a rack of sockets, whose parts have no coil.
    pub nominal_v: Option<f64>,
    /// Time of the calibration.
    pub made: Moment,
    /// Time at which the calibration expires.
    pub due: Moment,
    /// True once the calibration has expired.
    pub overdue: bool,
    /// False after a failed verification, else true.
    pub verified: bool,
}

/// What each rig made in the last shifts.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Day {
    /// Clock of the database when it answered.
    pub at: Moment,
    /// Rigs with parts, in order of plant and name.
    pub rigs: Vec<RigDay>,
    /// Readings of reference parts, in order of part, characteristic and rig.
    pub references: Vec<ReferenceDrift>,
}

/// Output of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct RigDay {
    /// Name of the plant.
    pub site: String,
    /// Name of the rig.
    pub rig: String,
    /// Counts of the last 24 hours.
    pub counts: LotYield,
    /// Reasons of the rejects of the last 24 hours, the most frequent first, at most [`REASONS`].
    pub reasons: Vec<Ranked>,
    /// Counts of the shifts that began in the last 36 hours.
    pub shifts: Vec<ShiftYield>,
}

/// Largest number of reasons in a [`RigDay`].
pub const REASONS: usize = 5;

/// How the readings of a reference part on a rig changed.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ReferenceDrift {
    /// Serial number of the part.
    pub serial: String,
    /// Key of the characteristic.
    pub parameter: String,
    /// Plant and name of the rig.
    pub rig: String,
    /// Number of reference checks between the two readings, both included.
    pub checks: u64,
    /// First reading.
    pub first: f64,
    /// Time of the first reading.
    pub first_at: Moment,
    /// Last reading.
    pub last: f64,
    /// Time of the last reading.
    pub last_at: Moment,
    /// Expanded uncertainty of the last reading, k = 2.
    pub uncertainty: Option<f64>,
    /// Last reading minus the median of the last readings of all rigs that measured the same part; `None` for one rig.
    pub from_others: Option<f64>,
    /// True when readings of this characteristic on this and on another rig changed in the same direction, each by more
    /// than half its uncertainty.
    pub shared: bool,
}

impl ReferenceDrift {
    /// Returns the direction of a change by more than half the uncertainty: 1 up, -1 down; 0 for a smaller change.
    fn direction(&self) -> i8 {
        let change = self.last - self.first;
        match self.uncertainty {
            Some(u) if change > u / 2.0 => 1,
            Some(u) if change < -u / 2.0 => -1,
            Some(_) | None => 0,
        }
    }
}

/// Compares rigs: fills `from_others` and `shared` of readings in order of part, characteristic and rig.
pub fn compare_rigs(readings: &mut [ReferenceDrift]) {
    let same_part = |one: &ReferenceDrift, other: &ReferenceDrift| {
        (&one.serial, &one.parameter) == (&other.serial, &other.parameter)
    };
    for group in readings.chunk_by_mut(same_part).filter(|it| it.len() > 1) {
        let mut last: Vec<f64> = group.iter().map(|it| it.last).collect();
        last.sort_by(f64::total_cmp);
        let half = last.len() / 2;
        let median = match last.len() % 2 {
            0 => (last[half - 1] + last[half]) / 2.0,
            _ => last[half],
        };
        group
            .iter_mut()
            .for_each(|it| it.from_others = Some(it.last - median));
    }
    // Rigs may have reference parts of their own: a change counts for the characteristic, whatever the part.
    let mut moved = BTreeMap::<(String, i8), BTreeSet<String>>::new();
    for it in readings.iter() {
        let change = (it.parameter.clone(), it.direction());
        moved.entry(change).or_default().insert(it.rig.clone());
    }
    for it in readings.iter_mut() {
        let rigs = moved.get(&(it.parameter.clone(), it.direction()));
        it.shared = it.direction() != 0 && rigs.is_some_and(|it| it.len() > 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_condition_counts() {
        let cases = [
            ((true, 1, Some(900.0), Some(900.0)), Condition::Alarm),
            ((true, 0, Some(900.0), Some(900.0)), Condition::Silent),
            ((true, 0, Some(1.0), Some(900.0)), Condition::Late),
            ((false, 1, Some(9000.0), Some(900.0)), Condition::Late),
            ((true, 0, Some(1.0), Some(1.0)), Condition::Testing),
            ((false, 2, Some(9000.0), Some(1.0)), Condition::Idle),
            ((false, 0, None, None), Condition::Idle),
        ];
        for ((is_open, alarms, silent_s, lag_s), expected) in cases {
            assert_eq!(Condition::of(is_open, alarms, silent_s, lag_s), expected);
        }
    }

    fn reading(serial: &str, rig: &str, (first, last): (f64, f64)) -> ReferenceDrift {
        ReferenceDrift {
            serial: serial.to_owned(),
            parameter: "operate_v".to_owned(),
            rig: rig.to_owned(),
            checks: 2,
            first,
            first_at: Moment(0),
            last,
            last_at: Moment(1),
            uncertainty: Some(0.2),
            from_others: None,
            shared: false,
        }
    }

    #[test]
    fn a_drift_of_several_rigs_is_shared() {
        let mut readings = [
            reading("G-1", "s/1", (5.0, 5.2)),
            reading("G-1", "s/2", (5.0, 5.05)),
            reading("G-1", "s/3", (5.0, 4.8)),
            reading("G-2", "s/4", (6.0, 6.3)),
        ];
        compare_rigs(&mut readings);
        assert_eq!(
            readings.each_ref().map(|it| it.shared),
            [true, false, false, true]
        );
        let others = readings.each_ref().map(|it| it.from_others);
        assert_eq!(others[1], Some(0.0));
        assert_eq!(others[3], None, "no other rig has this part");
        assert!(others[0].is_some_and(|it| (it - 0.15).abs() < 1e-9));
    }
}
