//! Packed values of closed runs, for statistics over many runs.
//!
//! [`Store::close_lot`](super::Store::close_lot) packs the counted values of production parts into one blob per
//! parameter of the run; a value counts when it is a number from the last attempt and that attempt is not void. A value
//! takes 8 bytes instead of the 31 of an index entry, and no decoding row by row. Filters that select whole runs read
//! the blobs; all other filters, and runs that were never closed, need the index `measurement_value`. Blobs and index
//! give the same values in the same order.

use super::source::{Read, Source};
use super::{Archive, Filter};
use rusqlite::{Connection, OptionalExtension, params};

/// Selects the parts of one run that have a counted value of a parameter, with this value, in no particular order.
pub(super) const OF_RUN: &str = "SELECT part_id, value FROM measurement
    WHERE parameter_id = ?1 AND population = 'lot' AND run_id = ?2
      AND part_verdict IN ('pass', 'fail', 'void', 'unjudged')";
/// Selects the packed values of a parameter in one run.
pub(super) const PACKED: &str = "SELECT first_part, last_part, packed FROM series
    WHERE run_id = ?2 AND parameter_id = ?1";

/// Values of one run in order of judgement, with the row numbers of its first and last part.
struct Piece {
    first: i64,
    last: i64,
    values: Vec<f64>,
}

/// Packs the values of every parameter of a closed run.
pub(super) fn pack(connection: &Connection, run: i64) -> rusqlite::Result<()> {
    let parameters: Vec<i64> = connection
        .prepare_cached("SELECT id FROM parameter")?
        .query_map([], |row| row.get(0))?
        .collect::<rusqlite::Result<_>>()?;
    let mut insert = connection.prepare_cached(
        "INSERT INTO series (run_id, parameter_id, first_part, last_part, packed)
         VALUES (?1, ?2, ?3, ?4, ?5)",
    )?;
    for parameter in parameters {
        if let Some(it) = loose(connection, parameter, run)? {
            assert!(it.first <= it.last, "parts out of order");
            let parts = it.last.abs_diff(it.first) + 1;
            assert!(it.values.len() as u64 <= parts, "two values of a part");
            let packed: Vec<u8> = it.values.iter().flat_map(|it| it.to_le_bytes()).collect();
            insert.execute(params![run, parameter, it.first, it.last, packed])?;
        }
    }
    Ok(())
}

/// Packs the values of runs that were closed before the table `series` existed.
pub(super) fn pack_all(connection: &Connection) -> rusqlite::Result<()> {
    let runs: Vec<i64> = connection
        .prepare("SELECT id FROM run WHERE closed_at_us IS NOT NULL")?
        .query_map([], |row| row.get(0))?
        .collect::<rusqlite::Result<_>>()?;
    runs.into_iter().try_for_each(|run| pack(connection, run))
}

/// Reads the values of one run from the index `measurement_value`; `None` when the run has no value.
fn loose(connection: &Connection, parameter: i64, run: i64) -> rusqlite::Result<Option<Piece>> {
    let mut found: Vec<(i64, f64)> = connection
        .prepare_cached(OF_RUN)?
        .query_map([parameter, run], |row| Ok((row.get(0)?, row.get(1)?)))?
        .collect::<rusqlite::Result<_>>()?;
    found.sort_unstable_by_key(|&(part, _)| part);
    let (Some(&(first, _)), Some(&(last, _))) = (found.first(), found.last()) else {
        return Ok(None);
    };
    let values = found.into_iter().map(|(_, value)| value).collect();
    Ok(Some(Piece {
        first,
        last,
        values,
    }))
}

fn packed(connection: &Connection, parameter: i64, run: i64) -> rusqlite::Result<Option<Piece>> {
    let read = |row: &rusqlite::Row<'_>| {
        let bytes = row.get_ref(2)?.as_blob()?;
        let values = bytes.as_chunks::<8>().0.iter();
        Ok(Piece {
            first: row.get(0)?,
            last: row.get(1)?,
            values: values.map(|it| f64::from_le_bytes(*it)).collect(),
        })
    };
    connection
        .prepare_cached(PACKED)?
        .query_row([parameter, run], read)
        .optional()
}

impl Archive {
    /// Returns the values of `param` in order of judgement, one run after the other. Returns `None` when the filter
    /// selects only some parts of a run, when parts of two runs alternate in time, and on a server, which has no packed
    /// values.
    pub(super) fn side_by_side(&self, param: &str, filter: &Filter) -> Read<Option<Vec<f64>>> {
        let Source::File(file) = &self.source else {
            return Ok(None);
        };
        if !filter.selects_whole_runs() {
            return Ok(None);
        }
        let find = "SELECT id FROM parameter WHERE key = ?1";
        let mut find = file.prepare_cached(find)?;
        let Some(parameter) = find.query_row([param], |row| row.get(0)).optional()? else {
            return Ok(Some(Vec::new()));
        };
        let mut pieces = Vec::new();
        for run in self.run_rows(filter)? {
            let piece = match packed(file, parameter, run)? {
                None => loose(file, parameter, run)?,
                piece => piece,
            };
            pieces.extend(piece);
        }
        pieces.sort_unstable_by_key(|it| it.first);
        let apart = pieces.windows(2).all(|two| two[0].last < two[1].first);
        Ok(apart.then(|| pieces.into_iter().flat_map(|it| it.values).collect()))
    }

    /// Returns the row numbers of the selected runs.
    pub(super) fn run_rows(&self, filter: &Filter) -> Read<Vec<i64>> {
        filter.runs().rows(&self.source, |row| row.get(0))
    }
}
