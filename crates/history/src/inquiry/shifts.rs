//! Yield and output by shift: counts of the parts judged in each shift of each day, rig by rig.

use super::{InquiryError, Result};
use crate::error::Doing;
use crate::source::{Read, Row};
use crate::{Archive, Filter, LotYield, Moment};
use jiff::civil::Date;
use jiff::tz::TimeZone;
use jiff::{Span, Timestamp};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use utoipa::ToSchema;

/// Longest time span, days.
const LONGEST: i32 = 400;

/// A shift, the same on each day, in local time of the plant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shift {
    /// Name of the shift.
    pub name: String,
    /// Begin and end, minutes after the midnight before the begin; the shift is at most a day long.
    pub minutes: (u16, u16),
}

/// Counts of the parts judged in one shift.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct ShiftYield {
    /// Day on which the shift begins, `2026-11-22`.
    pub day: String,
    /// Name of the shift.
    pub shift: String,
    /// Plant and name of the rig; `None` from the file of one rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<String>,
    /// Begin of the shift, or of the time span where that is later.
    pub from: Moment,
    /// End of the shift, or of the time span where that is earlier.
    pub to: Moment,
    /// Counts of the parts judged in the shift; `suspect` stays 0.
    #[serde(flatten)]
    pub counts: LotYield,
}

/// Counts the parts that the filter selects, by shift and rig, in order of time and rig. Shifts are those that overlap
/// the time from `since` to `until` of the filter; a shift without parts has no entry.
///
/// # Errors
/// Fails without shifts, without a time span, for a time span over [`LONGEST`] days, and when the history cannot be
/// read.
pub fn by_shift(
    archive: &Archive,
    filter: &Filter,
    shifts: &[Shift],
    zone: &TimeZone,
) -> Result<Vec<ShiftYield>> {
    if shifts.is_empty() {
        return Err(InquiryError::missing(
            "found no [[shift]] in fleet.toml, expected the shifts of the plant",
        ));
    }
    let span = filter.since.zip(filter.until);
    let span =
        span.ok_or_else(|| InquiryError::member("since", "missing: shifts need a time span"))?;
    let spans = spans(shifts, zone, span)?;
    if spans.is_empty() {
        return Ok(Vec::new());
    }
    let mut edges: Vec<i64> = spans.iter().flat_map(|it| [it.from.0, it.to.0]).collect();
    edges.sort_unstable();
    edges.dedup();
    let counts = archive.by_span(filter, &edges)?;
    let of_span = |it: ShiftYield| {
        let n = edges.partition_point(|edge| *edge <= it.from.0);
        let rigs = counts
            .range((n, None)..)
            .take_while(move |((of, _), _)| *of == n);
        rigs.map(move |((_, rig), counts)| ShiftYield {
            rig: rig.clone(),
            counts: *counts,
            ..it.clone()
        })
    };
    Ok(spans.into_iter().flat_map(of_span).collect())
}

/// Returns every shift within the time span, without counts, in order of time.
///
/// # Errors
/// Fails for a time span over [`LONGEST`] days.
pub fn spans(shifts: &[Shift], zone: &TimeZone, span: (Moment, Moment)) -> Result<Vec<ShiftYield>> {
    let mut all = Vec::new();
    for day in days(span, zone)? {
        for shift in shifts {
            let Some((from, to)) = clipped(day, shift, zone, span) else {
                continue;
            };
            all.push(ShiftYield {
                day: day.to_string(),
                shift: shift.name.clone(),
                rig: None,
                from,
                to,
                counts: LotYield::default(),
            });
        }
    }
    all.sort_by_key(|it| it.from);
    Ok(all)
}

/// Returns every day whose shifts may overlap the time span.
fn days((since, until): (Moment, Moment), zone: &TimeZone) -> Result<Vec<Date>> {
    let date = |at: Moment| {
        let at = Timestamp::from_microsecond(at.0);
        at.map(|at| at.to_zoned(zone.clone()).date())
    };
    let out_of_range = |_| InquiryError::member("since", "out of range");
    let first = date(since)
        .and_then(Date::yesterday)
        .map_err(out_of_range)?;
    let last = date(until).map_err(out_of_range)?;
    if (last - first).get_days() > LONGEST {
        let reason = format!("found a time span over {LONGEST} days; choose a shorter one");
        return Err(InquiryError::member("since", reason));
    }
    Ok(first
        .series(Span::new().days(1))
        .take_while(|it| *it <= last)
        .collect())
}

/// Returns begin and end of a shift, cut to the time span; `None` for a shift outside the time span.
fn clipped(
    day: Date,
    shift: &Shift,
    zone: &TimeZone,
    (since, until): (Moment, Moment),
) -> Option<(Moment, Moment)> {
    let at = |minutes: u16| {
        let days = Span::new().days(minutes / (24 * 60));
        let time =
            day.checked_add(days)
                .ok()?
                .at((minutes / 60 % 24) as i8, (minutes % 60) as i8, 0, 0);
        let at = time.to_zoned(zone.clone()).ok()?;
        Some(Moment(at.timestamp().as_microsecond()))
    };
    let from = at(shift.minutes.0)?.max(since);
    let to = at(shift.minutes.1)?.min(until);
    (from < to).then_some((from, to))
}

/// Counts by index of the time span and by rig.
type Counts = BTreeMap<(usize, Option<String>), LotYield>;

impl Archive {
    /// Counts the selected parts by time span and rig, as [`Archive::lot_yield`] does, but no suspect parts. The rig of
    /// a file is `None`.
    fn by_span(&self, filter: &Filter, edges: &[i64]) -> crate::Result<Counts> {
        const DOING: &str = "counting the parts of shifts";
        let read = |row: &Row<'_>| {
            let (span, parts): (i64, i64) = (row.get(0)?, row.get(3)?);
            let verdict: String = row.get(2)?;
            Ok((
                span.unsigned_abs() as usize,
                row.get::<i64>(1)?,
                verdict,
                parts.unsigned_abs(),
            ))
        };
        assert!(edges.len() >= 2, "a shift without begin and end");
        let counted = filter
            .by_span(edges)
            .rows(&self.source, read)
            .doing(DOING)?;
        let mut runs: Vec<i64> = counted.iter().map(|it| it.1).collect();
        runs.sort_unstable();
        runs.dedup();
        let runs = self.rigs_of(&runs).doing(DOING)?;
        let mut all = Counts::new();
        for (span, run, verdict, parts) in counted {
            let (rig, again) = runs.get(&run).cloned().unwrap_or_default();
            let of = all.entry((span, rig)).or_default();
            let passed = if verdict == "pass" { parts } else { 0 };
            match again {
                true => of.retest_pass += passed,
                false => (of.parts, of.first_pass) = (of.parts + parts, of.first_pass + passed),
            }
        }
        Ok(all)
    }

    /// Returns for each run its rig, and whether it was a retest.
    fn rigs_of(&self, runs: &[i64]) -> Read<HashMap<i64, (Option<String>, bool)>> {
        if runs.is_empty() {
            return Ok(HashMap::new());
        }
        let dialect = self.source.dialect();
        let (among, values) = dialect.among("run.id", runs);
        let sql = format!(
            "SELECT run.id, {}, run.id IN (SELECT run_id FROM retest) FROM run WHERE {among}",
            dialect.rig()
        );
        let read = |row: &Row<'_>| Ok((row.get(0)?, (row.get(1)?, row.get(2)?)));
        Ok(self.source.rows(&sql, &values, read)?.into_iter().collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn at(text: &str) -> Moment {
        Moment::exact(text).unwrap()
    }

    #[test]
    fn a_night_shift_belongs_to_the_day_it_begins() {
        let zone = TimeZone::UTC;
        let span = (at("2026-03-02T00:00:00Z"), at("2026-03-03T00:00:00Z"));
        let night = Shift {
            name: "night".into(),
            minutes: (22 * 60, 30 * 60),
        };
        let spans = days(span, &zone).unwrap();
        let spans: Vec<_> = spans
            .into_iter()
            .filter_map(|day| clipped(day, &night, &zone, span))
            .collect();
        let before = (at("2026-03-02T00:00:00Z"), at("2026-03-02T06:00:00Z"));
        let after = (at("2026-03-02T22:00:00Z"), at("2026-03-03T00:00:00Z"));
        assert_eq!(spans, [before, after]);
    }

    #[test]
    fn local_time_moves_with_the_clocks() {
        let zone = TimeZone::get("Europe/Berlin").unwrap();
        let span = (at("2026-03-28T00:00:00Z"), at("2026-03-31T00:00:00Z"));
        let early = Shift {
            name: "early".into(),
            minutes: (6 * 60, 14 * 60),
        };
        let spans = days(span, &zone).unwrap();
        let begins: Vec<_> = spans
            .into_iter()
            .filter_map(|day| clipped(day, &early, &zone, span))
            .map(|it| it.0)
            .collect();
        let expected = [
            "2026-03-28T05:00:00Z",
            "2026-03-29T04:00:00Z",
            "2026-03-30T04:00:00Z",
        ];
        assert_eq!(begins, expected.map(at));
    }
}
