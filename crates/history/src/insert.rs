//! Inserts records as rows, inside a transaction of [`Store`](super::Store).

use super::error::{Doing, HistoryError, Result};
use super::store::{PROGRAM, RowIds};
use super::{LotRecord, MeasurementRecord, PartRecord, SampleRecord};
use super::{curve, outbox, reasons};
use machine::dut::Reason;
use rusqlite::{Connection, OptionalExtension, Transaction, params};

/// Inserts a run, and its lot and recipe if they are new. Returns the row number of the run and its number in the lot.
pub(super) fn run(
    transaction: &Transaction<'_>,
    lot: &LotRecord,
    source: &str,
) -> rusqlite::Result<(i64, u32)> {
    transaction.execute(
        "INSERT INTO lot (name, first_opened_us) VALUES (?1, ?2) ON CONFLICT DO NOTHING",
        params![lot.lot, lot.opened_at_us],
    )?;
    transaction.execute(
        "INSERT INTO recipe (hash, name, body, first_used_us) VALUES (?1, ?2, ?3, ?4)
         ON CONFLICT (hash) DO NOTHING",
        params![
            lot.recipe_hash,
            lot.recipe,
            lot.recipe_snapshot,
            lot.opened_at_us
        ],
    )?;
    let made = transaction.query_row(
        "INSERT INTO run (lot_id, number, recipe_id, calibration_hash, opened_at_us, source, seed,
           written_by, uuid)
         SELECT lot.id, (SELECT ifnull(max(number), 0) + 1 FROM run WHERE lot_id = lot.id),
           recipe.id, ?3, ?4, ?5, ?6, ?7, ?8
         FROM lot, recipe WHERE lot.name = ?1 AND recipe.hash = ?2
         RETURNING id, number",
        params![
            lot.lot,
            lot.recipe_hash,
            lot.calibration_hash,
            lot.opened_at_us,
            source,
            lot.seed.map(|seed| seed.to_string()),
            PROGRAM,
            outbox::uuid(transaction)?
        ],
        |row| Ok((row.get(0)?, row.get(1)?)),
    )?;
    if let Some(consented_by) = &lot.retest {
        transaction.execute(
            "INSERT INTO retest (run_id, consented_by) VALUES (?1, ?2)",
            params![made.0, consented_by],
        )?;
    }
    Ok(made)
}

/// Inserts a part with its measurements, samples and curves; does nothing when an equal row exists.
pub(super) fn part(tx: &Transaction<'_>, row_ids: &mut RowIds, part: &PartRecord) -> Result<()> {
    const DOING: &str = "recording a part";
    let run = row_ids.run(&part.lot)?;
    check(part);
    let seq = signed("part", part.seq)?;
    let texts: Vec<String> = part.reasons.iter().map(Reason::to_string).collect();
    let row = tx
        .prepare_cached(
            "INSERT INTO part (id, run_id, kind, seq, serial, verdict, bin, reasons, judged_at_us,
               test_s, cycle_s, landed_bin, landed_at_us)
             VALUES (max(ifnull((SELECT max(id) FROM part), 0),
                 ifnull((SELECT last FROM row_floor WHERE name = 'part'), 0)) + 1, ?1, ?2, ?3, ?4, ?5, nullif(?6, ''), ?7, ?8, ?9, ?10, ?11, ?12)
             ON CONFLICT (run_id, kind, seq) DO NOTHING RETURNING id",
        )
        .doing(DOING)?
        .query_row(
            params![
                run,
                part.kind,
                seq,
                part.serial,
                part.verdict,
                part.bin,
                serde_json::Value::from(texts),
                part.judged_at_us,
                part.test_s,
                part.cycle_s,
                part.landed_bin,
                part.landed_at_us
            ],
            |row| row.get(0),
        )
        .optional()
        .doing(DOING)?;
    match row {
        Some(row) => {
            reasons::insert(tx, row, 1, &part.reasons).doing("recording reasons")?;
            measurements(tx, row_ids, part, run, row)?;
            let mut curves = part.curves.iter();
            curves
                .try_for_each(|it| curve::insert(tx, row, it))
                .doing("recording a curve")
        }
        None => same_part(tx, part, run, seq),
    }
}

/// Asserts that the record of a part is consistent.
fn check(part: &PartRecord) {
    assert!(part.seq >= 1, "the first part has number 1");
    assert_eq!(
        part.landed_bin.is_some(),
        part.landed_at_us.is_some(),
        "a bin without its time"
    );
    let landed_after = part.landed_at_us.is_none_or(|at| at >= part.judged_at_us);
    assert!(landed_after, "part {} landed before its verdict", part.seq);
    let passed = part.verdict == "pass";
    assert!(!passed || part.curves.is_empty(), "curves of a good part");
}

fn same_part(tx: &Transaction<'_>, part: &PartRecord, run: i64, seq: i64) -> Result<()> {
    let same: bool = tx
        .prepare_cached(
            "SELECT verdict = ?4 AND judged_at_us = ?5 AND bin IS nullif(?6, '') FROM part
             WHERE run_id = ?1 AND kind = ?2 AND seq = ?3",
        )
        .and_then(|mut statement| {
            let key = params![
                run,
                part.kind,
                seq,
                part.verdict,
                part.judged_at_us,
                part.bin
            ];
            statement.query_row(key, |row| row.get(0))
        })
        .doing("comparing a part with its row")?;
    if same {
        return Ok(());
    }
    let (lot, kind) = (part.lot.clone(), part.kind.clone());
    Err(HistoryError::PartTwice {
        lot,
        kind,
        seq: part.seq,
    })
}

fn measurements(
    tx: &Transaction<'_>,
    row_ids: &mut RowIds,
    part: &PartRecord,
    run: i64,
    row: i64,
) -> Result<()> {
    for measurement in &part.measurements {
        assert!(measurement.attempt >= 1, "the first attempt has number 1");
        let parameter = parameter(tx, row_ids, &measurement.key)?;
        let last = part
            .measurements
            .iter()
            .all(|other| other.key != measurement.key || other.attempt <= measurement.attempt);
        let judged = measurement.verdict != "void";
        let finite = measurement.value.is_some_and(f64::is_finite);
        let population = (last && judged && finite).then_some(part.kind.as_str());
        measured(
            tx,
            measurement,
            (row, parameter),
            (run, &part.verdict, population),
        )
        .doing("recording a measurement")?;
        for (n, sample) in (1_i64..).zip(&measurement.samples) {
            sampled(tx, sample, (row, parameter, measurement.attempt, n))
                .doing("recording a sample")?;
        }
    }
    Ok(())
}

fn measured(
    tx: &Transaction<'_>,
    it: &MeasurementRecord,
    (part, parameter): (i64, i64),
    (run, part_verdict, population): (i64, &str, Option<&str>),
) -> rusqlite::Result<()> {
    let finite = |number: Option<f64>| number.filter(|number| number.is_finite());
    let counts = population.is_some();
    assert!(
        !counts || finite(it.value).is_some(),
        "counted, and no number"
    );
    let u = finite(it.uncertainty);
    assert!(u.is_none_or(|u| u >= 0.0), "an uncertainty below zero");
    tx.prepare_cached(
        "INSERT INTO measurement (part_id, parameter_id, attempt, value, uncertainty, low, high,
           verdict, budget, run_id, part_verdict, population)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12)",
    )?
    .execute(params![
        part,
        parameter,
        it.attempt,
        finite(it.value),
        finite(it.uncertainty),
        finite(it.low),
        finite(it.high),
        it.verdict,
        it.budget,
        run,
        part_verdict,
        population
    ])?;
    Ok(())
}

fn sampled(
    tx: &Transaction<'_>,
    it: &SampleRecord,
    (part, parameter, attempt, n): (i64, i64, u32, i64),
) -> rusqlite::Result<()> {
    assert!(!it.command.is_empty(), "a reply without its request");
    tx.prepare_cached(
        "INSERT INTO sample (part_id, parameter_id, attempt, n, line, module, channel, command,
           raw, at_us) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)",
    )?
    .execute(params![
        part, parameter, attempt, n, it.line, it.module, it.channel, it.command, it.raw, it.at_us
    ])?;
    Ok(())
}

fn parameter(tx: &Transaction<'_>, row_ids: &mut RowIds, key: &str) -> Result<i64> {
    if let Some(&row) = row_ids.parameters.get(key) {
        return Ok(row);
    }
    assert!(!key.is_empty(), "a parameter without a name");
    let row = parameter_row(tx, key).doing("naming a parameter")?;
    row_ids.parameters.insert(key.to_owned(), row);
    Ok(row)
}

/// Returns the row number of a parameter; inserts the parameter if it is new, and adds its column to the view `parts`.
pub(super) fn parameter_row(connection: &Connection, key: &str) -> rusqlite::Result<i64> {
    let mut find = connection.prepare_cached("SELECT id FROM parameter WHERE key = ?1")?;
    if let Some(row) = find.query_row([key], |row| row.get(0)).optional()? {
        return Ok(row);
    }
    drop(find);
    connection.execute(
        "INSERT INTO parameter (key, meaning) VALUES (?1, 'named by a recipe')",
        [key],
    )?;
    let row = connection.last_insert_rowid();
    super::views::rebuild(connection)?;
    Ok(row)
}

/// Converts a count to the signed integer of SQLite.
pub(super) fn signed(what: &'static str, value: u64) -> Result<i64> {
    i64::try_from(value).map_err(|_| HistoryError::TooLarge { what, value })
}
