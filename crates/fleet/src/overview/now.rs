//! What each rig does now.

use super::{BACK_US, DOING, HOUR_US};
use crate::error::Result;
use crate::link::Link;
use history::Moment;
use history::inquiry::rigs::{ActiveAlarm, CalibrationDue, Condition, LatestRun, Now, RigNow};
use machine::station::catalogue::AlarmCode;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use texts::{Args, Lang};
use tokio_postgres::Row;

/// The history that may send for each rig: the one with the highest epoch.
const CURRENT: &str = "SELECT DISTINCT ON (rig_id) id, rig_id, host FROM relayrig.history ORDER BY rig_id, epoch DESC";

/// Asks what each rig does at the instant `as_of`, or now by the clock of the database.
pub(super) async fn ask(link: &Link, as_of: Option<Moment>) -> Result<Now> {
    let clock = "SELECT (extract(epoch FROM clock_timestamp()) * 1000000)::bigint";
    let at_us = match as_of {
        Some(at) => at.0,
        None => link.row(DOING, clock, &[]).await?.get(0),
    };
    let states = link.rows(DOING, &states(at_us), &[]).await?;
    let mut alarms = alarms(link).await?;
    let mut calibrations = calibrations(link, at_us).await?;
    let rigs = states.iter().map(|row| {
        let history: i32 = row.get(0);
        let mut rig = rig(row, at_us);
        let opened = rig.run.as_ref().map_or(i64::MIN, |it| it.opened.0);
        rig.alarms = alarms.remove(&history).unwrap_or_default();
        // An alarm that ended its run is never cleared, but alarms of earlier runs are over.
        rig.alarms.retain(|it| it.raised.0 >= opened);
        rig.calibrations = calibrations.remove(&history).unwrap_or_default();
        let is_open = rig.run.as_ref().is_some_and(|it| it.closed.is_none());
        rig.condition = Condition::of(is_open, rig.alarms.len(), rig.silent_s, rig.lag_s);
        rig
    });
    Ok(Now {
        at: Moment(at_us),
        rigs: rigs.collect(),
    })
}

/// Returns the statement with one row per rig: last batch, latest run, newest part, parts of the last hour.
fn states(at_us: i64) -> String {
    let (since, hour, until) = (at_us - BACK_US, at_us - HOUR_US, at_us + HOUR_US);
    let us = |it: &str| format!("(extract(epoch FROM {it}) * 1000000)::bigint");
    let (at, clock, sent) = (us("last.at"), us("last.rig_clock"), us("filled.rig_clock"));
    format!(
        "SELECT current.id, site, rig, host, {at}, {clock}, {sent}, run.lot, run.number, recipe.name, run.source,
           run.opened_at_us, (SELECT (body ->> 'closed_at_us')::bigint FROM relayrig.event
             WHERE kind = 'run_state' AND row_id = run.id ORDER BY id DESC LIMIT 1),
           (SELECT judged_at_us FROM relayrig.part WHERE history_id = current.id AND judged_at_us >= {since}
             AND judged_at_us < {until} ORDER BY judged_at_us DESC LIMIT 1),
           (SELECT count(*) FROM relayrig.part WHERE history_id = current.id AND judged_at_us >= {hour}
             AND judged_at_us < {until} AND kind = 'lot')
         FROM ({CURRENT}) AS current JOIN relayrig.rig ON rig.id = current.rig_id
           LEFT JOIN LATERAL (SELECT at, rig_clock FROM relayrig.batch WHERE history_id = current.id
             ORDER BY number DESC LIMIT 1) AS last ON true
           LEFT JOIN LATERAL (SELECT rig_clock FROM (SELECT rig_clock, parts, number FROM relayrig.batch
             WHERE history_id = current.id ORDER BY number DESC LIMIT 100) AS latest WHERE parts > 0
             ORDER BY number DESC LIMIT 1) AS filled ON true
           LEFT JOIN LATERAL (SELECT * FROM relayrig.run WHERE history_id = current.id
             ORDER BY opened_at_us DESC, id DESC LIMIT 1) AS run ON true
           LEFT JOIN relayrig.recipe ON recipe.hash = run.recipe_hash
         ORDER BY site, rig"
    )
}

fn rig(row: &Row, at_us: i64) -> RigNow {
    let seconds = |from: i64, to: i64| (to - from) as f64 / 1e6;
    let [contact, clock, sent, last_part] = [4, 5, 6, 13].map(|it| row.get::<_, Option<i64>>(it));
    let lot: Option<String> = row.get(7);
    RigNow {
        site: row.get(1),
        rig: row.get(2),
        condition: Condition::Idle,
        host: row.get(3),
        contact: contact.map(Moment),
        silent_s: contact.map(|it| seconds(it, at_us).max(0.0)),
        lag_s: sent
            .zip(last_part)
            .map(|(sent, judged)| seconds(judged, sent).max(0.0)),
        clock_ahead_s: clock.zip(contact).map(|(clock, at)| seconds(at, clock)),
        run: lot.map(|lot| LatestRun {
            lot,
            run: row.get::<_, i32>(8).unsigned_abs(),
            recipe: row.get::<_, Option<String>>(9).unwrap_or_default(),
            source: row.get(10),
            opened: Moment(row.get(11)),
            closed: row.get::<_, Option<i64>>(12).map(Moment),
        }),
        last_part: last_part.map(Moment),
        parts_per_hour: row.get::<_, i64>(14).unsigned_abs(),
        alarms: Vec::new(),
        calibrations: Vec::new(),
    }
}

/// Returns the active alarms among the last 200 of each rig, by history, the newest first.
async fn alarms(link: &Link) -> Result<HashMap<i32, Vec<ActiveAlarm>>> {
    let sql = format!(
        "SELECT current.id, alarm.body, EXISTS (SELECT 1 FROM relayrig.event WHERE kind = 'alarm_state'
           AND row_id = alarm.row_id AND body ->> 'acknowledged_at_us' IS NOT NULL)
         FROM ({CURRENT}) AS current CROSS JOIN LATERAL (SELECT DISTINCT ON (row_id) row_id, body FROM
           (SELECT id, row_id, body FROM relayrig.event WHERE history_id = current.id AND kind = 'alarm'
             ORDER BY id DESC LIMIT 200) AS latest ORDER BY row_id DESC, id DESC) AS alarm
         WHERE alarm.body ->> 'cleared_at_us' IS NULL ORDER BY current.id, alarm.row_id DESC"
    );
    let mut all = HashMap::<_, Vec<_>>::new();
    for row in link.rows(DOING, &sql, &[]).await? {
        let body = json(&row, 1);
        let code = body["code"].as_str().unwrap_or_default().to_owned();
        let args: Args = serde_json::from_value(body["args"].clone()).unwrap_or_default();
        let known = AlarmCode::from_name(&code);
        all.entry(row.get(0)).or_default().push(ActiveAlarm {
            text: body["text"].as_str().unwrap_or_default().to_owned(),
            text_zh: known.and_then(|it| it.message(args).try_say(Lang::Zh)),
            raised: Moment(body["raised_at_us"].as_i64().unwrap_or_default()),
            acknowledged: row.get(2),
            code,
        });
    }
    Ok(all)
}

/// Returns the newest calibration for each coil voltage among the last 50 of each rig, by history.
async fn calibrations(link: &Link, at_us: i64) -> Result<HashMap<i32, Vec<CalibrationDue>>> {
    let sql = format!(
        "SELECT current.id, made.body FROM ({CURRENT}) AS current CROSS JOIN LATERAL
           (SELECT DISTINCT ON (row_id) row_id, body - 'hash' AS body FROM
             (SELECT id, row_id, body FROM relayrig.event WHERE history_id = current.id AND kind = 'calibration'
               ORDER BY id DESC LIMIT 50) AS latest ORDER BY row_id, id DESC) AS made
         ORDER BY current.id, made.row_id"
    );
    let mut newest = HashMap::<i32, BTreeMap<String, CalibrationDue>>::new();
    for row in link.rows(DOING, &sql, &[]).await? {
        let body = json(&row, 1);
        let nominal_v = body["body"]["nominal_v"].as_f64().filter(|it| *it > 0.0);
        let due_us = body["due_at_us"].as_i64().unwrap_or_default();
        let due = CalibrationDue {
            nominal_v,
            made: Moment(body["made_at_us"].as_i64().unwrap_or_default()),
            due: Moment(due_us),
            overdue: due_us <= at_us,
            verified: body["verified"].as_i64() != Some(0),
        };
        let of_rig = newest.entry(row.get(0)).or_default();
        // A later row replaces an earlier one of the same voltage.
        of_rig.insert(format!("{nominal_v:?}"), due);
    }
    let of_rig = |(history, found): (i32, BTreeMap<_, _>)| (history, found.into_values().collect());
    Ok(newest.into_iter().map(of_rig).collect())
}

/// Returns the JSON of a column.
fn json(row: &Row, at: usize) -> Value {
    match row.get::<_, crate::value::Cell>(at).0 {
        history::Value::Text(text) => serde_json::from_str(&text).unwrap_or_default(),
        _ => Value::Null,
    }
}
