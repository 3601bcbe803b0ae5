//! How the readings of reference parts changed, rig by rig. The reference checks of a rig say when it measured its
//! reference parts, so the question reads only the parts just before a check.

use super::DOING;
use crate::error::Result;
use crate::link::Link;
use history::Moment;
use history::inquiry::rigs::{ReferenceDrift, compare_rigs};
use std::collections::BTreeMap;

/// Longest time from the first reading of a check to its result, µs.
const CHECK_US: i64 = 15 * 60 * 1_000_000;

/// Age of the oldest check that counts, µs: 30 days.
const OLDEST_US: i64 = 30 * 86_400 * 1_000_000;

/// Number of the latest reference checks that the question reads per rig.
const CHECKS: u32 = 100;

/// A reading: value, uncertainty, instant.
type Reading = (f64, Option<f64>, i64);

/// Asks for the first and the last reading of each reference part and characteristic on each rig.
pub(super) async fn ask(link: &Link, until: Moment) -> Result<Vec<ReferenceDrift>> {
    let (oldest, until) = (until.0 - OLDEST_US, until.0);
    let sql = format!(
        "WITH checks AS (SELECT history.id, history.rig_id, checked.at_us, count(*) OVER of_rig AS checks,
             row_number() OVER (of_rig ORDER BY checked.at_us) AS place
           FROM relayrig.history CROSS JOIN LATERAL (SELECT (body ->> 'at_us')::bigint AS at_us
             FROM relayrig.event WHERE history_id = history.id AND kind = 'golden_check' ORDER BY id DESC LIMIT {CHECKS})
             AS checked WHERE checked.at_us >= {oldest} WINDOW of_rig AS (PARTITION BY history.rig_id))
         SELECT serial, parameter.key, site || '/' || rig, checks, m.value, m.uncertainty, part.judged_at_us
         FROM checks JOIN relayrig.rig ON rig.id = checks.rig_id
           CROSS JOIN LATERAL (SELECT id, serial, judged_at_us FROM relayrig.part AS it
             WHERE it.history_id = checks.id AND it.judged_at_us <= checks.at_us AND it.judged_at_us > checks.at_us - {CHECK_US}
               AND it.judged_at_us > {oldest} AND it.judged_at_us <= {until} AND it.kind = 'golden' AND it.serial IS NOT NULL OFFSET 0) AS part
           JOIN relayrig.measurement AS m ON m.part_id = part.id AND m.judged_at_us = part.judged_at_us
             AND m.judged_at_us > {oldest} AND m.judged_at_us <= {until} AND m.population = 'golden' AND m.value IS NOT NULL
           JOIN relayrig.parameter ON parameter.id = m.parameter_id
         WHERE place = 1 OR place = checks
         ORDER BY 1, 2, 3, part.judged_at_us"
    );
    let mut all = BTreeMap::<(String, String, String), (u64, Vec<Reading>)>::new();
    for row in link.rows(DOING, &sql, &[]).await? {
        let checks = row.get::<_, i64>(3).unsigned_abs();
        let of = all.entry((row.get(0), row.get(1), row.get(2)));
        let of = of.or_insert_with(|| (checks, Vec::new()));
        of.1.push((row.get(4), row.get(5), row.get(6)));
    }
    let mut drifts: Vec<ReferenceDrift> = all.into_iter().filter_map(drift).collect();
    compare_rigs(&mut drifts);
    Ok(drifts)
}

/// Compares the first and the last reading; `None` with a single reading.
fn drift(
    ((serial, parameter, rig), (checks, readings)): ((String, String, String), (u64, Vec<Reading>)),
) -> Option<ReferenceDrift> {
    let (first, last) = (readings.first()?, readings.last()?);
    (first.2 < last.2).then_some(ReferenceDrift {
        serial,
        parameter,
        rig,
        checks,
        first: first.0,
        first_at: Moment(first.2),
        last: last.0,
        last_at: Moment(last.2),
        uncertainty: last.1,
        from_others: None,
        shared: false,
    })
}
