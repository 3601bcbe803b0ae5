//! Reads the rows that entries of the queue name.

use super::batch::{
    Batch, CurveRow, EventRow, MeasurementRow, PartChange, PartRow, PartState, ReasonRow,
    RecipeRow, RunRow, SampleChoice, SampleRow,
};
use rusqlite::{Connection, Row, params};

/// New parts of the batch.
const NEW: &str = "SELECT row_id FROM outbox WHERE target_id = ?1 AND id <= ?2 AND kind = 'part'";

/// Parts of earlier batches that have changed since, with the last queue entry of each.
const CHANGED: &str = "SELECT row_id, max(id) AS event FROM outbox
    WHERE target_id = ?1 AND id <= ?2 AND kind = 'part_change' GROUP BY row_id";

const STATE: &str =
    "part.verdict, part.bin, part.reasons, part.cycle_s, part.landed_bin, part.landed_at_us";

/// A table whose rows travel as JSON.
struct Table {
    /// Kind of its entries in the queue.
    kind: &'static str,
    /// Name of the table.
    table: &'static str,
    /// Column that the entries name.
    key: &'static str,
    /// Expression for the row number of the run.
    run: &'static str,
    /// Arguments of `json_object`.
    columns: &'static str,
}

const fn table(
    kind: &'static str,
    table: &'static str,
    key: &'static str,
    run: &'static str,
    columns: &'static str,
) -> Table {
    Table {
        kind,
        table,
        key,
        run,
        columns,
    }
}

/// Every table whose rows travel as JSON.
const TABLES: [Table; 11] = [
    table(
        "run_state",
        "run",
        "id",
        "t.id",
        "'closed_at_us', closed_at_us, 'calibration_hash', calibration_hash",
    ),
    table(
        "run_end",
        "run_end",
        "run_id",
        "run_id",
        "'ended', ended, 'cause', cause, 'cause_text', cause_text",
    ),
    table(
        "retest",
        "retest",
        "run_id",
        "run_id",
        "'consented_by', consented_by",
    ),
    table(
        "alarm",
        "alarm",
        "id",
        "run_id",
        "'code', code, 'line', line, 'text', text, 'raised_at_us', raised_at_us, 'cleared_at_us', cleared_at_us, \
         'args', json(args)",
    ),
    table(
        "alarm_state",
        "alarm_state",
        "alarm_id",
        "NULL",
        "'acknowledged_at_us', acknowledged_at_us, 'acknowledged_by', acknowledged_by, 'shelved_until_us', \
         shelved_until_us, 'shelved_by', shelved_by, 'shelf_reason', shelf_reason",
    ),
    table(
        "lot_state",
        "lot_state",
        "lot_id",
        "NULL",
        "'lot', (SELECT name FROM lot WHERE id = lot_id), 'state', state, 'why', why, 'alarm', json(alarm), 'since_us', \
         since_us, 'completed', completed",
    ),
    table(
        "golden_check",
        "golden_check",
        "id",
        "run_id",
        "'at_us', at_us, 'passed', passed, 'text', text, 'alarm', json(alarm), 'suspect_since_us', suspect_since_us",
    ),
    table(
        "ordered",
        "ordered",
        "id",
        "run_id",
        "'at_us', at_us, 'who', who, 'role', role, 'origin', origin, 'what', json(what), 'refused', refused, \
         'refusal', json(refusal)",
    ),
    table(
        "reopening",
        "reopening",
        "id",
        "NULL",
        "'lot', (SELECT name FROM lot WHERE id = lot_id), 'at_us', at_us, 'who', who, 'why', why",
    ),
    table(
        "external_result",
        "external_result",
        "id",
        "NULL",
        "'lot', (SELECT name FROM lot WHERE id = lot_id), 'serial', serial, 'run', run, 'seq', seq, 'key', key, 'value', \
         value, 'uncertainty', uncertainty, 'low', low, 'high', high, 'verdict', verdict, 'recipe_hash', recipe_hash, \
         'who', who, 'measured_at_us', measured_at_us, 'entered_at_us', entered_at_us, 'file_hash', file_hash, 'line', \
         line",
    ),
    table(
        "calibration",
        "calibration",
        "id",
        "NULL",
        "'hash', hash, 'made_at_us', made_at_us, 'due_at_us', due_at_us, 'verified', verified, 'body', json(body)",
    ),
];

/// Reads the rows that the entries of `target` up to `to` name; leaves UUID and number of the batch empty.
pub(super) fn batch(
    connection: &Connection,
    (target, to): (i64, i64),
    samples: SampleChoice,
) -> rusqlite::Result<Batch> {
    let from = Span {
        connection,
        target,
        to,
    };
    let reason_parts = format!("SELECT row_id FROM ({CHANGED}) UNION {NEW}");
    Ok(Batch {
        parameters: parameters(connection)?,
        recipes: from.rows(&format!(
            "SELECT hash, name, body, first_used_us FROM recipe WHERE id IN (SELECT recipe_id FROM run
             WHERE id IN ({}))", NEW.replace("'part'", "'run'")), recipe)?,
        runs: from.rows(&format!(
            "SELECT run.id, run.uuid, lot.name, run.number, recipe.hash, run.opened_at_us, run.source, run.seed,
               run.written_by FROM run JOIN lot ON lot.id = run.lot_id JOIN recipe ON recipe.id = run.recipe_id
             WHERE run.id IN ({})", NEW.replace("'part'", "'run'")), run)?,
        parts: from.rows(&format!(
            "SELECT {STATE}, id, run_id, kind, seq, serial, judged_at_us, test_s FROM part WHERE id IN ({NEW})
             ORDER BY id"), part)?,
        changes: from.rows(&format!(
            "SELECT {STATE}, changed.event, part.id, part.judged_at_us FROM ({CHANGED}) AS changed
             JOIN part ON part.id = changed.row_id WHERE part.id NOT IN ({NEW}) ORDER BY changed.event"), change)?,
        reasons: from.rows(&format!(
            "SELECT part_id, n, code, parameter_id, side, detail FROM reason WHERE part_id IN ({reason_parts})
             ORDER BY part_id, n"), reason)?,
        measurements: from.rows(&format!(
            "SELECT m.part_id, m.run_id, part.judged_at_us, m.parameter_id, m.attempt, m.value, m.uncertainty, m.low,
               m.high, m.verdict, m.budget, m.population FROM part CROSS JOIN measurement AS m ON m.part_id = part.id
             WHERE part.id IN ({NEW}) ORDER BY m.part_id, m.parameter_id, m.attempt"), measurement)?,
        samples: match samples {
            SampleChoice::None => Vec::new(),
            SampleChoice::Rejects => from.rows(&samples_of("part.verdict <> 'pass'"), sample)?,
            SampleChoice::All => from.rows(&samples_of("1"), sample)?,
        },
        curves: from.rows(&format!(
            "SELECT part_id, signal, unit, step, begin_us, samples, packed FROM curve WHERE part_id IN ({NEW})"),
            curve)?,
        events: TABLES
            .iter()
            .try_fold(Vec::new(), |mut all, table| {
                all.extend(events(&from, table)?);
                Ok::<_, rusqlite::Error>(all)
            })?,
        ..Batch::default()
    })
}

/// Queue entries of one target, up to a given entry.
struct Span<'a> {
    connection: &'a Connection,
    target: i64,
    to: i64,
}

impl Span<'_> {
    fn rows<T>(
        &self,
        sql: &str,
        read: impl FnMut(&Row<'_>) -> rusqlite::Result<T>,
    ) -> rusqlite::Result<Vec<T>> {
        self.connection
            .prepare_cached(sql)?
            .query_map(params![self.target, self.to], read)?
            .collect()
    }
}

fn samples_of(which: &str) -> String {
    format!(
        "SELECT s.part_id, s.parameter_id, s.attempt, s.n, s.line, s.module, s.channel, s.command, s.raw, s.at_us
         FROM part CROSS JOIN sample AS s ON s.part_id = part.id WHERE part.id IN ({NEW}) AND {which}"
    )
}

fn events(from: &Span<'_>, table: &Table) -> rusqlite::Result<Vec<EventRow>> {
    let Table {
        kind,
        table,
        key,
        run,
        columns,
    } = table;
    let sql = format!(
        "SELECT outbox.id, outbox.row_id, {run}, json_object({columns}) FROM outbox
         JOIN {table} AS t ON t.{key} = outbox.row_id
         WHERE outbox.target_id = ?1 AND outbox.id <= ?2 AND outbox.kind = '{kind}' ORDER BY outbox.id"
    );
    from.rows(&sql, |row| {
        Ok(EventRow {
            event: row.get(0)?,
            kind: (*kind).to_owned(),
            row: row.get(1)?,
            run: row.get(2)?,
            body: row.get(3)?,
        })
    })
}

fn parameters(connection: &Connection) -> rusqlite::Result<Vec<(i64, String, String)>> {
    connection
        .prepare_cached("SELECT id, key, meaning FROM parameter ORDER BY id")?
        .query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?
        .collect()
}

fn recipe(row: &Row<'_>) -> rusqlite::Result<RecipeRow> {
    Ok(RecipeRow {
        hash: row.get(0)?,
        name: row.get(1)?,
        body: row.get(2)?,
        first_used_us: row.get(3)?,
    })
}

fn run(row: &Row<'_>) -> rusqlite::Result<RunRow> {
    Ok(RunRow {
        id: row.get(0)?,
        uuid: row.get(1)?,
        lot: row.get(2)?,
        number: row.get(3)?,
        recipe_hash: row.get(4)?,
        opened_at_us: row.get(5)?,
        source: row.get(6)?,
        seed: row.get(7)?,
        written_by: row.get(8)?,
    })
}

fn state(row: &Row<'_>) -> rusqlite::Result<PartState> {
    Ok(PartState {
        verdict: row.get(0)?,
        bin: row.get(1)?,
        reasons: row.get(2)?,
        cycle_s: row.get(3)?,
        landed_bin: row.get(4)?,
        landed_at_us: row.get(5)?,
    })
}

fn part(row: &Row<'_>) -> rusqlite::Result<PartRow> {
    Ok(PartRow {
        state: state(row)?,
        id: row.get(6)?,
        run: row.get(7)?,
        kind: row.get(8)?,
        seq: row.get(9)?,
        serial: row.get(10)?,
        judged_at_us: row.get(11)?,
        test_s: row.get(12)?,
    })
}

fn change(row: &Row<'_>) -> rusqlite::Result<PartChange> {
    Ok(PartChange {
        state: state(row)?,
        event: row.get(6)?,
        part: row.get(7)?,
        judged_at_us: row.get(8)?,
    })
}

fn reason(row: &Row<'_>) -> rusqlite::Result<ReasonRow> {
    Ok(ReasonRow {
        part: row.get(0)?,
        n: row.get(1)?,
        code: row.get(2)?,
        parameter: row.get(3)?,
        side: row.get(4)?,
        detail: row.get(5)?,
    })
}

fn measurement(row: &Row<'_>) -> rusqlite::Result<MeasurementRow> {
    Ok(MeasurementRow {
        part: row.get(0)?,
        run: row.get(1)?,
        judged_at_us: row.get(2)?,
        parameter: row.get(3)?,
        attempt: row.get(4)?,
        value: row.get(5)?,
        uncertainty: row.get(6)?,
        low: row.get(7)?,
        high: row.get(8)?,
        verdict: row.get(9)?,
        budget: row.get(10)?,
        population: row.get(11)?,
    })
}

fn sample(row: &Row<'_>) -> rusqlite::Result<SampleRow> {
    Ok(SampleRow {
        part: row.get(0)?,
        parameter: row.get(1)?,
        attempt: row.get(2)?,
        n: row.get(3)?,
        line: row.get(4)?,
        module: row.get(5)?,
        channel: row.get(6)?,
        command: row.get(7)?,
        raw: row.get(8)?,
        at_us: row.get(9)?,
    })
}

fn curve(row: &Row<'_>) -> rusqlite::Result<CurveRow> {
    Ok(CurveRow {
        part: row.get(0)?,
        signal: row.get(1)?,
        unit: row.get(2)?,
        step: row.get(3)?,
        begin_us: row.get(4)?,
        samples: row.get(5)?,
        packed: row.get(6)?,
    })
}
