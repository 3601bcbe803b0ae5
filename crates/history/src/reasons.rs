//! Codes of the reasons why a part did not pass: the table `reason` has one row per text in `part.reasons`.

use super::insert::parameter_row;
use super::source::{Read, Row};
use machine::dut::{Characteristic, Reason};
use machine::gauge::Side;
use rusqlite::{Connection, params};

/// Selects the reasons of parts.
pub(super) const REASONS: &str = "SELECT part_id, code, parameter.key, side, detail FROM reason
    LEFT JOIN parameter ON parameter.id = reason.parameter_id";

/// Number of parts that the migration to schema 8 reads at a time.
const BATCH: usize = 1_000;

/// Inserts reasons for the part in row `part`; numbers them from `n`, which is at least 1.
pub(super) fn insert(
    connection: &Connection,
    part: i64,
    n: i64,
    reasons: &[Reason],
) -> rusqlite::Result<()> {
    assert!(n >= 1, "the first reason has number 1");
    for (n, reason) in (n..).zip(reasons) {
        let about = reason.characteristic();
        let about = about.map(|it| parameter_row(connection, it.key()));
        let row = params![
            part,
            n,
            reason.code.name(),
            about.transpose()?,
            reason.side.map(Side::name),
            reason.detail
        ];
        connection
            .prepare_cached(
                "INSERT INTO reason (part_id, n, code, parameter_id, side, detail)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            )?
            .execute(row)?;
    }
    Ok(())
}

/// Texts of reasons before schema 8, one per line: `code|parameter|side|text`, with `*` in place of the detail. This
/// table never changes, so old files are migrated alike whatever the present texts are.
const TEXTS: &str = include_str!("schema/reason_texts.txt");

/// Converts a text that a program before schema 8 wrote; a text that is not known becomes
/// [`Code::Unclassified`](machine::dut::reason::Code).
fn read_text(text: &str) -> Reason {
    let known = TEXTS.lines().find_map(|line| match_text(line, text));
    let known = known.or_else(|| limit_reason(text));
    known.unwrap_or_else(|| Reason::unclassified(text))
}

/// Returns the reason that one line of [`TEXTS`] describes; `None` when its text does not match.
fn match_text(line: &str, text: &str) -> Option<Reason> {
    let [code, key, side, form] = line.splitn(4, '|').collect::<Vec<_>>().try_into().ok()?;
    let detail = match form.split_once('*') {
        Some((before, after)) => text.strip_prefix(before)?.strip_suffix(after)?,
        None if form == text => "",
        None => return None,
    };
    let about = Characteristic::from_key(key);
    Reason::stored(code, about, Side::from_name(side), detail)
}

/// Returns the reason of a text that begins with the key of a characteristic and then names the limit that was missed.
fn limit_reason(text: &str) -> Option<Reason> {
    let (key, rest) = text.split_once(' ')?;
    let (code, side) = match rest {
        "low" => ("outside_limit", Some(Side::Low)),
        "high" => ("outside_limit", Some(Side::High)),
        "low not proven" => ("not_proven", Some(Side::Low)),
        "high not proven" => ("not_proven", Some(Side::High)),
        "not measured" => ("not_measured", None),
        _ => return None,
    };
    Reason::stored(code, Characteristic::from_key(key), side, "")
}

/// Reads the texts stored before schema 8 and inserts their reason codes, part by part.
pub(super) fn read_texts(connection: &Connection) -> rusqlite::Result<()> {
    let mut after = 0;
    loop {
        let batch = with_texts(connection, after)?;
        let Some((last, _)) = batch.last() else {
            return Ok(());
        };
        after = *last;
        for (part, stored) in &batch {
            let reasons: Vec<Reason> = texts(stored).map(read_text).collect();
            insert(connection, *part, 1, &reasons)?;
        }
    }
}

/// Returns the stored texts of the next parts that have reasons, from the row after `after`.
fn with_texts(
    connection: &Connection,
    after: i64,
) -> rusqlite::Result<Vec<(i64, serde_json::Value)>> {
    connection
        .prepare_cached(
            "SELECT id, reasons FROM part WHERE id > ?1 AND reasons <> '[]' ORDER BY id LIMIT ?2",
        )?
        .query_map(params![after, BATCH as i64], |row| {
            Ok((row.get(0)?, row.get(1)?))
        })?
        .collect()
}

/// Returns the texts in a stored JSON list.
pub(super) fn texts(stored: &serde_json::Value) -> impl Iterator<Item = &str> {
    let list = stored.as_array().map(Vec::as_slice).unwrap_or_default();
    list.iter().filter_map(serde_json::Value::as_str)
}

/// Reads a row of [`REASONS`]; returns `None` for a code that this program does not know.
pub(super) fn read(row: &Row<'_>) -> Read<Option<Reason>> {
    let (code, key): (String, Option<String>) = (row.get(1)?, row.get(2)?);
    let (side, detail): (Option<String>, String) = (row.get(3)?, row.get(4)?);
    let about = key.as_deref().and_then(Characteristic::from_key);
    let side = side.as_deref().and_then(Side::from_name);
    Ok(Reason::stored(&code, about, side, &detail))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_of_old_is_read_as_its_code() {
        for line in TEXTS.lines() {
            let code = line.split('|').next().unwrap_or_default();
            let text = line.rsplit('|').next().unwrap_or_default();
            assert_eq!(read_text(&text.replace('*', "COM")).code.name(), code);
        }
    }
}
