//! What each rig made in the last shifts.

use super::{BACK_US, DOING, HOUR_US, Watched, references};
use crate::error::{FleetError, Result};
use crate::link::Link;
use history::inquiry::pareto::{Ranked, names, ranked};
use history::inquiry::rigs::{Day, REASONS, RigDay};
use history::inquiry::shifts::{ShiftYield, spans};
use history::{LotYield, Moment};
use machine::dut::{Characteristic, Reason};
use machine::gauge::Side;
use std::collections::BTreeMap;

/// Plant and name of a rig.
type Name = (String, String);

/// Asks what each rig made until `at`, and a little beyond, because the clock of a rig may be ahead.
pub(super) async fn ask(link: &Link, watched: &Watched, at: Moment) -> Result<Day> {
    let (since, until) = (Moment(at.0 - BACK_US), Moment(at.0 + HOUR_US));
    let shifts = spans(&watched.shifts, &watched.zone, (since, until)).map_err(|error| {
        FleetError::Shifts {
            target: link.target.clone(),
            why: error.to_string(),
        }
    })?;
    // A shift that began before `since` would have an incomplete count.
    let shifts: Vec<ShiftYield> = shifts.into_iter().filter(|it| it.from > since).collect();
    let a_day_ago = at.0 - 24 * HOUR_US;
    let mut edges: Vec<i64> = shifts.iter().flat_map(|it| [it.from.0, it.to.0]).collect();
    edges.extend([since.0, a_day_ago, until.0]);
    edges.sort_unstable();
    edges.dedup();
    let counts = counts(link, &edges).await?;
    let mut reasons = reasons(link, (a_day_ago, until.0)).await?;
    let rigs = counts.into_iter().map(|((site, rig), spans)| {
        let within = |from: i64, to: i64| sum(&spans, &edges, (from, to));
        RigDay {
            counts: within(a_day_ago, until.0),
            shifts: shifts
                .iter()
                .map(|it| ShiftYield {
                    counts: within(it.from.0, it.to.0),
                    ..it.clone()
                })
                .collect(),
            reasons: reasons
                .remove(&(site.clone(), rig.clone()))
                .unwrap_or_default(),
            site,
            rig,
        }
    });
    Ok(Day {
        at,
        rigs: rigs.collect(),
        references: references::ask(link, until).await?,
    })
}

/// Returns the sum of the counts between the edges `from` and `to`; span `n` begins at `edges[n - 1]`.
fn sum(spans: &BTreeMap<usize, LotYield>, edges: &[i64], (from, to): (i64, i64)) -> LotYield {
    let number = |at: i64| edges.partition_point(|edge| *edge <= at);
    let mut all = LotYield::default();
    for it in spans.range(number(from)..number(to)).map(|(_, it)| it) {
        all.parts += it.parts;
        all.first_pass += it.first_pass;
        all.retest_pass += it.retest_pass;
    }
    all
}

/// Counts the judged parts of lots by rig and span.
async fn counts(link: &Link, edges: &[i64]) -> Result<BTreeMap<Name, BTreeMap<usize, LotYield>>> {
    let (from, to) = (edges[0], edges[edges.len() - 1]);
    let edges: Vec<String> = edges.iter().map(i64::to_string).collect();
    let sql = format!(
        "SELECT site, rig, span, verdict, EXISTS (SELECT 1 FROM relayrig.event WHERE kind = 'retest'
             AND row_id = counted.run_id) AS again, sum(parts)::bigint
         FROM (SELECT history.rig_id, part.run_id, part.span, part.verdict, count(*) AS parts
             FROM relayrig.history CROSS JOIN LATERAL (SELECT it.run_id,
                 width_bucket(it.judged_at_us, ARRAY[{}]::bigint[]) AS span, coalesce(other.verdict, it.verdict) AS verdict
               FROM relayrig.part AS it LEFT JOIN relayrig.part_rejudged AS other ON other.part_id = it.id
                 AND NOT EXISTS (SELECT 1 FROM relayrig.part_rejudged AS later WHERE later.part_id = other.part_id
                   AND later.event > other.event)
               WHERE it.history_id = history.id AND it.judged_at_us >= {from} AND it.judged_at_us < {to}
                 AND it.kind = 'lot' OFFSET 0) AS part
             WHERE part.verdict <> 'unjudged' GROUP BY 1, 2, 3, 4) AS counted
           JOIN relayrig.rig ON rig.id = rig_id
         GROUP BY 1, 2, 3, 4, 5",
        edges.join(", ")
    );
    let mut all = BTreeMap::<Name, BTreeMap<usize, LotYield>>::new();
    for row in link.rows(DOING, &sql, &[]).await? {
        let span = row.get::<_, i32>(2).unsigned_abs() as usize;
        let parts = row.get::<_, i64>(5).unsigned_abs();
        let passed = match row.get::<_, &str>(3) {
            "pass" => parts,
            _ => 0,
        };
        let rig = all.entry((row.get(0), row.get(1))).or_default();
        let of = rig.entry(span).or_default();
        match row.get(4) {
            true => of.retest_pass += passed,
            false => (of.parts, of.first_pass) = (of.parts + parts, of.first_pass + passed),
        }
    }
    Ok(all)
}

/// Ranks the reasons of rejects by rig.
async fn reasons(link: &Link, (from, to): (i64, i64)) -> Result<BTreeMap<Name, Vec<Ranked>>> {
    let sql = format!(
        "SELECT site, rig, reason.code, parameter.key, reason.side, count(DISTINCT reason.part_id)
         FROM relayrig.history JOIN relayrig.rig ON rig.id = history.rig_id
           CROSS JOIN LATERAL (SELECT id FROM relayrig.part WHERE history_id = history.id AND judged_at_us >= {from}
             AND judged_at_us < {to} AND kind = 'lot' AND verdict IN ('fail', 'void') OFFSET 0) AS part
           JOIN relayrig.reason ON reason.part_id = part.id
           LEFT JOIN relayrig.parameter ON parameter.id = reason.parameter_id
         GROUP BY 1, 2, 3, 4, 5"
    );
    let mut all = BTreeMap::<Name, BTreeMap<[String; 2], (u64, Option<f64>)>>::new();
    for row in link.rows(DOING, &sql, &[]).await? {
        let about = row
            .get::<_, Option<&str>>(3)
            .and_then(Characteristic::from_key);
        let side = row.get::<_, Option<&str>>(4).and_then(Side::from_name);
        let Some(reason) = Reason::stored(row.get(2), about, side, "") else {
            continue;
        };
        let rig = all.entry((row.get(0), row.get(1))).or_default();
        rig.entry(names(&reason)).or_default().0 += row.get::<_, i64>(5).unsigned_abs();
    }
    let first = |(name, counts)| {
        let mut all = ranked(counts);
        all.truncate(REASONS);
        (name, all)
    };
    Ok(all.into_iter().map(first).collect())
}
