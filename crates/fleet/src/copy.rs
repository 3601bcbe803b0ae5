//! Writes a batch inside a transaction: binary COPY to staging tables of the session, then
//! `INSERT ... ON CONFLICT DO NOTHING`. Staging tables empty themselves at the end of the transaction.

use history::outbox::{Batch, PartRow};
use std::collections::HashMap;
use tokio_postgres::binary_copy::BinaryCopyInWriter;
use tokio_postgres::types::Type;
use tokio_postgres::{Client, Error, Transaction};

/// Makes the staging tables of a session.
const STAGING: &str = "
CREATE TEMP TABLE IF NOT EXISTS staging_run (LIKE relayrig.run) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS staging_part (LIKE relayrig.part) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS staging_part_change (LIKE relayrig.part_change) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS staging_reason (LIKE relayrig.reason) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS staging_measurement (LIKE relayrig.measurement) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS staging_sample (LIKE relayrig.sample) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS staging_curve (LIKE relayrig.curve) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS staging_event (id bigint, kind text COLLATE \"C\", row_id bigint, run_id bigint, body text)
  ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS fresh (id bigint PRIMARY KEY) ON COMMIT DELETE ROWS;";

/// Moves staged changes of parts, reasons and curves to their tables.
const MOVE: &str = "
INSERT INTO relayrig.part_change SELECT s.* FROM staging_part_change AS s ON CONFLICT DO NOTHING;
INSERT INTO relayrig.reason SELECT * FROM staging_reason ON CONFLICT DO NOTHING;
INSERT INTO relayrig.curve SELECT * FROM staging_curve ON CONFLICT DO NOTHING;";

const PARTS: &str = "
WITH new AS (INSERT INTO relayrig.part SELECT * FROM staging_part ON CONFLICT DO NOTHING RETURNING id)
INSERT INTO fresh SELECT id FROM new";

const MEASUREMENTS: &str =
    "INSERT INTO relayrig.measurement SELECT s.* FROM staging_measurement AS s";
const SAMPLES: &str = "INSERT INTO relayrig.sample SELECT s.* FROM staging_sample AS s";
const ONLY_FRESH: &str = " JOIN fresh ON fresh.id = s.part_id";

/// Stores a change for each part that the database had already, if the part of the rig differs now; `$1` is the event.
const DIFFERING: &str = "
INSERT INTO relayrig.part_change
  SELECT $1, s.id, s.judged_at_us, s.verdict, s.bin, s.reasons, s.cycle_s, s.landed_bin, s.landed_at_us
  FROM staging_part AS s JOIN relayrig.part_now AS there ON there.id = s.id AND there.judged_at_us = s.judged_at_us
  WHERE s.id NOT IN (SELECT id FROM fresh) AND (s.verdict, s.bin, s.reasons, s.cycle_s, s.landed_bin, s.landed_at_us)
    IS DISTINCT FROM (there.verdict, there.bin, there.reasons, there.cycle_s, there.landed_bin, there.landed_at_us)
ON CONFLICT DO NOTHING";

const EVENTS: &str = "
INSERT INTO relayrig.event (id, history_id, kind, row_id, run_id, body)
  SELECT s.id, $1, s.kind, s.row_id, s.run_id, s.body::jsonb FROM staging_event AS s
  WHERE s.body::jsonb IS DISTINCT FROM (SELECT it.body FROM relayrig.event AS it WHERE it.kind = s.kind
    AND it.row_id = s.row_id ORDER BY it.id DESC LIMIT 1)
ON CONFLICT DO NOTHING";

/// Copies `$rows` to a staging table.
macro_rules! stage {
    ($tx:expr, $table:literal, $rows:expr, $row:pat => $($column:literal $type:ident $value:expr;)*) => {{
        let columns: &[&str] = &[$($column),*];
        let sql = format!("COPY pg_temp.{} ({}) FROM STDIN BINARY", $table, columns.join(", "));
        let sink = $tx.copy_in(&sql).await?;
        let mut writer = Box::pin(BinaryCopyInWriter::new(sink, &[$(Type::$type),*]));
        for $row in $rows {
            writer.as_mut().write(&[$(&$value),*]).await?;
        }
        writer.as_mut().finish().await?;
    }};
}

/// Makes the staging tables.
pub(crate) async fn prepare(client: &Client) -> Result<(), Error> {
    client.batch_execute(STAGING).await
}

/// Makes row numbers of a file unique over the files of all rigs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Base(i64);

impl Base {
    /// Returns the base of a history: the number of the history, shifted left by 40 bits.
    pub(crate) fn of(history: i32) -> Self {
        assert!(history > 0, "a history without its number");
        Self(i64::from(history) << 40)
    }

    /// Returns the number that a row of the file, 0 to 2^40 - 1, has in the database.
    fn number(self, row: i64) -> i64 {
        assert!((0..1 << 40).contains(&row), "row {row} of a file");
        self.0 | row
    }
}

/// Writes the rows. Returns the number of runs whose numbers belong to other runs; above 0, the caller must not commit.
pub(crate) async fn write(tx: &Transaction<'_>, history: i32, batch: &Batch) -> Result<i64, Error> {
    let base = Base::of(history);
    let parameters = parameters(tx, batch).await?;
    let differing = runs(tx, (history, base), batch).await?;
    if differing > 0 {
        return Ok(differing);
    }
    if !batch.parts.is_empty() {
        parts(tx, (history, base), batch, &parameters).await?;
    }
    later(tx, base, batch, &parameters).await?;
    if !batch.events.is_empty() {
        stage!(tx, "staging_event", &batch.events, it =>
            "id" INT8 base.number(it.event); "kind" TEXT it.kind; "row_id" INT8 base.number(it.row);
            "run_id" INT8 it.run.map(|run| base.number(run)); "body" TEXT it.body;);
        tx.execute(EVENTS, &[&history]).await?;
    }
    Ok(0)
}

/// Returns the number in the database of each parameter of the file.
async fn parameters(tx: &Transaction<'_>, batch: &Batch) -> Result<HashMap<i64, i32>, Error> {
    let keys: Vec<&str> = batch
        .parameters
        .iter()
        .map(|(_, key, _)| key.as_str())
        .collect();
    let known = "SELECT key, id FROM relayrig.parameter WHERE key = ANY ($1)";
    let mut numbers: HashMap<String, i32> = HashMap::new();
    for row in tx.query(known, &[&keys]).await? {
        numbers.insert(row.get(0), row.get(1));
    }
    for (_, key, meaning) in batch
        .parameters
        .iter()
        .filter(|(_, key, _)| !numbers.contains_key(key))
    {
        tx.execute(
            "INSERT INTO relayrig.parameter (key, meaning) VALUES ($1, $2) ON CONFLICT DO NOTHING",
            &[key, meaning],
        )
        .await?;
    }
    for row in tx.query(known, &[&keys]).await? {
        numbers.insert(row.get(0), row.get(1));
    }
    Ok(batch
        .parameters
        .iter()
        .map(|(row, key, _)| (*row, numbers[key]))
        .collect())
}

async fn runs(
    tx: &Transaction<'_>,
    (history, base): (i32, Base),
    batch: &Batch,
) -> Result<i64, Error> {
    for it in &batch.recipes {
        tx.execute(
            "INSERT INTO relayrig.recipe (hash, name, body, first_used_us) VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING",
            &[&it.hash, &it.name, &it.body, &it.first_used_us],
        )
        .await?;
    }
    if batch.runs.is_empty() {
        return Ok(0);
    }
    stage!(tx, "staging_run", &batch.runs, it =>
        "id" INT8 base.number(it.id); "history_id" INT4 history; "uuid" TEXT it.uuid; "lot" TEXT it.lot;
        "number" INT4 i32::try_from(it.number).unwrap_or(i32::MAX); "recipe_hash" TEXT it.recipe_hash;
        "opened_at_us" INT8 it.opened_at_us; "source" TEXT it.source; "seed" TEXT it.seed;
        "written_by" TEXT it.written_by;);
    tx.execute(
        "INSERT INTO relayrig.run SELECT * FROM staging_run ON CONFLICT DO NOTHING",
        &[],
    )
    .await?;
    let differing =
        "SELECT count(*) FROM staging_run AS s WHERE NOT EXISTS (SELECT 1 FROM relayrig.run
        WHERE run.id = s.id AND run.uuid = s.uuid)";
    Ok(tx.query_one(differing, &[]).await?.get(0))
}

async fn parts(
    tx: &Transaction<'_>,
    (history, base): (i32, Base),
    batch: &Batch,
    parameters: &HashMap<i64, i32>,
) -> Result<(), Error> {
    stage!(tx, "staging_part", &batch.parts, it =>
        "id" INT8 base.number(it.id); "history_id" INT4 history; "run_id" INT8 base.number(it.run); "kind" TEXT it.kind;
        "seq" INT8 it.seq; "serial" TEXT it.serial; "verdict" TEXT it.state.verdict; "bin" TEXT it.state.bin;
        "reasons" TEXT it.state.reasons; "judged_at_us" INT8 it.judged_at_us; "test_s" FLOAT8 it.test_s;
        "cycle_s" FLOAT8 it.state.cycle_s; "landed_bin" TEXT it.state.landed_bin;
        "landed_at_us" INT8 it.state.landed_at_us;);
    stage!(tx, "staging_measurement", &batch.measurements, it =>
        "part_id" INT8 base.number(it.part); "run_id" INT8 base.number(it.run); "judged_at_us" INT8 it.judged_at_us;
        "parameter_id" INT4 parameters[&it.parameter]; "attempt" INT4 small(it.attempt); "value" FLOAT8 it.value;
        "uncertainty" FLOAT8 it.uncertainty; "low" FLOAT8 it.low; "high" FLOAT8 it.high; "verdict" TEXT it.verdict;
        "population" TEXT it.population; "budget" TEXT it.budget;);
    let judged: HashMap<i64, i64> = batch.parts.iter().map(judged).collect();
    if !batch.samples.is_empty() {
        stage!(tx, "staging_sample", &batch.samples, it =>
            "part_id" INT8 base.number(it.part); "judged_at_us" INT8 judged[&it.part];
            "parameter_id" INT4 parameters[&it.parameter]; "attempt" INT4 small(it.attempt); "n" INT4 small(it.n);
            "line" TEXT it.line; "module" TEXT it.module; "channel" TEXT it.channel; "command" TEXT it.command;
            "raw" TEXT it.raw; "at_us" INT8 it.at_us;);
    }
    let fresh = tx.execute(PARTS, &[]).await?;
    let only_fresh = if fresh == batch.parts.len() as u64 {
        ""
    } else {
        ONLY_FRESH
    };
    tx.execute(&format!("{MEASUREMENTS}{only_fresh}"), &[])
        .await?;
    if !batch.samples.is_empty() {
        tx.execute(&format!("{SAMPLES}{only_fresh}"), &[]).await?;
    }
    if !only_fresh.is_empty() {
        tx.execute(DIFFERING, &[&base.number(batch.to)]).await?;
    }
    Ok(())
}

/// Writes later changes of parts, reasons and curves.
async fn later(
    tx: &Transaction<'_>,
    base: Base,
    batch: &Batch,
    parameters: &HashMap<i64, i32>,
) -> Result<(), Error> {
    if !batch.changes.is_empty() {
        stage!(tx, "staging_part_change", &batch.changes, it =>
            "event" INT8 base.number(it.event); "part_id" INT8 base.number(it.part); "judged_at_us" INT8 it.judged_at_us;
            "verdict" TEXT it.state.verdict; "bin" TEXT it.state.bin; "reasons" TEXT it.state.reasons;
            "cycle_s" FLOAT8 it.state.cycle_s; "landed_bin" TEXT it.state.landed_bin;
            "landed_at_us" INT8 it.state.landed_at_us;);
    }
    if !batch.reasons.is_empty() {
        stage!(tx, "staging_reason", &batch.reasons, it =>
            "part_id" INT8 base.number(it.part); "n" INT4 small(it.n); "code" TEXT it.code;
            "parameter_id" INT4 it.parameter.map(|row| parameters[&row]); "side" TEXT it.side; "detail" TEXT it.detail;);
    }
    if !batch.curves.is_empty() {
        stage!(tx, "staging_curve", &batch.curves, it =>
            "part_id" INT8 base.number(it.part); "signal" TEXT it.signal; "unit" TEXT it.unit; "step" FLOAT8 it.step;
            "begin_us" INT8 it.begin_us; "samples" INT8 it.samples; "packed" BYTEA it.packed;);
    }
    tx.batch_execute(MOVE).await
}

fn judged(part: &PartRow) -> (i64, i64) {
    (part.id, part.judged_at_us)
}

/// Converts a count of attempts or samples; panics beyond 2^31 - 1.
fn small(count: i64) -> i32 {
    let small = i32::try_from(count);
    assert!(small.is_ok(), "a count of {count}");
    small.unwrap_or_default()
}
