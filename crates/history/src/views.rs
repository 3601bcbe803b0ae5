//! Views for people who open the file with other tools: plural names, local time, one column per parameter.
//!
//! Migrations do not contain views. All views are rebuilt after each migration, and whenever a new parameter gets a
//! column in `parts`.

use rusqlite::Connection;

const FIXED: &str = "
DROP VIEW IF EXISTS lots;
CREATE VIEW lots AS
  SELECT lot.name AS lot, run.number AS run, recipe.name AS recipe, run.source, run.seed,
    strftime('%Y-%m-%d %H:%M:%f', run.opened_at_us / 1e6, 'unixepoch', 'localtime') AS opened,
    strftime('%Y-%m-%d %H:%M:%f', run.closed_at_us / 1e6, 'unixepoch', 'localtime') AS closed,
    count(part.id) AS parts,
    sum(ifnull(part.verdict = 'pass', 0)) AS pass, sum(ifnull(part.verdict = 'fail', 0)) AS fail,
    sum(ifnull(part.verdict = 'void', 0)) AS void,
    round(100.0 * sum(part.verdict = 'pass') / nullif(sum(part.verdict <> 'unjudged'), 0), 2)
      AS yield_percent,
    run_end.ended, run_end.cause, run_end.cause_text
  FROM run JOIN lot ON lot.id = run.lot_id JOIN recipe ON recipe.id = run.recipe_id
    LEFT JOIN run_end ON run_end.run_id = run.id
    LEFT JOIN part ON part.run_id = run.id AND part.kind = 'lot'
  GROUP BY run.id;
DROP VIEW IF EXISTS measurements;
CREATE VIEW measurements AS
  SELECT lot.name AS lot, run.number AS run, part.kind, part.seq, parameter.key AS parameter,
    m.attempt, m.value, m.uncertainty, m.low, m.high, m.verdict, m.budget
  FROM measurement AS m JOIN part ON part.id = m.part_id JOIN run ON run.id = part.run_id
    JOIN lot ON lot.id = run.lot_id JOIN parameter ON parameter.id = m.parameter_id;
DROP VIEW IF EXISTS samples;
CREATE VIEW samples AS
  SELECT lot.name AS lot, run.number AS run, part.kind, part.seq, parameter.key AS parameter,
    s.attempt, s.n, s.line, s.module, s.channel, s.command, s.raw,
    strftime('%Y-%m-%d %H:%M:%f', s.at_us / 1e6, 'unixepoch', 'localtime') AS at
  FROM sample AS s JOIN part ON part.id = s.part_id JOIN run ON run.id = part.run_id
    JOIN lot ON lot.id = run.lot_id JOIN parameter ON parameter.id = s.parameter_id;
DROP VIEW IF EXISTS reasons;
CREATE VIEW reasons AS
  SELECT lot.name AS lot, run.number AS run, part.kind, part.seq, reason.n, reason.code,
    parameter.key AS parameter, reason.side, reason.detail
  FROM reason JOIN part ON part.id = reason.part_id JOIN run ON run.id = part.run_id
    JOIN lot ON lot.id = run.lot_id LEFT JOIN parameter ON parameter.id = reason.parameter_id;
DROP VIEW IF EXISTS curves;
CREATE VIEW curves AS
  SELECT lot.name AS lot, run.number AS run, part.kind, part.seq, curve.signal, curve.unit,
    strftime('%Y-%m-%d %H:%M:%f', curve.begin_us / 1e6, 'unixepoch', 'localtime') AS begin,
    curve.samples, length(curve.packed) AS bytes
  FROM curve JOIN part ON part.id = curve.part_id JOIN run ON run.id = part.run_id
    JOIN lot ON lot.id = run.lot_id;
DROP VIEW IF EXISTS external_results;
CREATE VIEW external_results AS
  SELECT lot.name AS lot, it.serial, it.run, it.seq, it.key AS parameter, it.value, it.uncertainty, it.low, it.high,
    it.verdict, EXISTS (SELECT 1 FROM external_result AS later WHERE later.lot_id = it.lot_id AND later.key = it.key
      AND later.serial IS it.serial AND later.run IS it.run AND later.seq IS it.seq AND later.id > it.id) AS superseded,
    it.who, strftime('%Y-%m-%d %H:%M:%f', it.measured_at_us / 1e6, 'unixepoch', 'localtime') AS measured,
    strftime('%Y-%m-%d %H:%M:%f', it.entered_at_us / 1e6, 'unixepoch', 'localtime') AS entered,
    it.file_hash, it.line, it.recipe_hash
  FROM external_result AS it JOIN lot ON lot.id = it.lot_id;
DROP VIEW IF EXISTS alarms;
CREATE VIEW alarms AS
  SELECT lot.name AS lot, run.number AS run, alarm.code, alarm.line, alarm.text,
    strftime('%Y-%m-%d %H:%M:%f', raised_at_us / 1e6, 'unixepoch', 'localtime') AS raised,
    strftime('%Y-%m-%d %H:%M:%f', cleared_at_us / 1e6, 'unixepoch', 'localtime') AS cleared
  FROM alarm LEFT JOIN run ON run.id = alarm.run_id LEFT JOIN lot ON lot.id = run.lot_id;
DROP VIEW IF EXISTS parts;
";

/// Rebuilds all views; the caller holds a write transaction.
pub(super) fn rebuild(connection: &Connection) -> rusqlite::Result<()> {
    connection.execute_batch(FIXED)?;
    let parameters: Vec<(i64, String)> = connection
        .prepare("SELECT id, key FROM parameter ORDER BY id")?
        .query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?
        .collect::<rusqlite::Result<_>>()?;
    connection.execute_batch(&parts(&parameters))
}

/// Returns the SQL of the view `parts`, which shows the last attempt at each parameter as a column.
fn parts(parameters: &[(i64, String)]) -> String {
    let columns: String = parameters
        .iter()
        .map(|(id, key)| {
            let name = key.replace('"', "\"\"");
            format!(
                ",\n (SELECT m.value FROM measurement AS m WHERE m.part_id = part.id \
                 AND m.parameter_id = {id} ORDER BY m.attempt DESC LIMIT 1) AS \"{name}\""
            )
        })
        .collect();
    format!(
        "CREATE VIEW parts AS SELECT lot.name AS lot, run.number AS run, part.kind, part.seq,
    strftime('%Y-%m-%d %H:%M:%f', judged_at_us / 1e6, 'unixepoch', 'localtime') AS judged,
    recipe.name AS recipe, part.serial, part.verdict, part.bin, part.landed_bin,
    (SELECT group_concat(value, '; ') FROM json_each(part.reasons)) AS reasons,
    part.test_s, part.cycle_s{columns}
  FROM part JOIN run ON run.id = part.run_id JOIN lot ON lot.id = run.lot_id
    JOIN recipe ON recipe.id = run.recipe_id;"
    )
}
