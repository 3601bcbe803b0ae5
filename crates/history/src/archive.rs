//! The reader of the history: parts that a filter selects, and single parts down to their raw replies.

use super::details::Found;
use super::error::{Doing, Result};
use super::reasons::texts;
use super::source::{Read, Row, Server, Source};
use super::{CalibrationRecord, Filter, Moment, Part, filter, open, store};
use rusqlite::types::Value;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// A history that is open for reading: the file of a rig, or a server with many rigs. Reading never blocks a writer.
#[derive(Debug)]
pub struct Archive {
    pub(super) source: Source,
    /// Path of the file, or name of the server, for messages.
    pub(super) path: PathBuf,
}

/// Parts whose details are read at once.
const CHUNK: usize = 200;

impl Archive {
    /// Opens an existing history and migrates an older schema. Fails on a file of another program, and on a newer
    /// schema.
    pub fn open(path: &Path) -> Result<Self> {
        Ok(Self {
            source: Source::File(open::reader(path)?),
            path: path.to_owned(),
        })
    }

    /// Opens an existing history to check or copy it, whatever its schema; writes nothing to the file.
    pub fn open_unchanged(path: &Path) -> Result<Self> {
        Ok(Self {
            source: Source::File(open::unchanged(path)?.0),
            path: path.to_owned(),
        })
    }

    /// Returns a reader of the histories that many rigs have sent to a server.
    pub fn of_server(server: Box<dyn Server>) -> Self {
        Self {
            path: server.name().into(),
            source: Source::Server(server),
        }
    }

    /// Calls `each` for every selected part, in order of judgement; the memory needed does not grow with their number.
    /// Stops at the first error of `each` and returns it.
    pub fn each<E>(
        &self,
        filter: &Filter,
        mut each: impl FnMut(Part) -> std::result::Result<(), E>,
    ) -> Result<std::result::Result<(), E>> {
        let mut found = Vec::with_capacity(CHUNK);
        let mut stopped = None;
        let mut complete = |found: &mut Vec<Found>| -> Read<ControlFlow<()>> {
            for part in self.completed(std::mem::take(found))? {
                if let Err(stop) = each(part) {
                    stopped = Some(stop);
                    return Ok(ControlFlow::Break(()));
                }
            }
            Ok(ControlFlow::Continue(()))
        };
        let select = filter.parts(self.source.dialect());
        let mut ended = ControlFlow::Continue(());
        let read = self.source.each(&select.sql, &select.values, |row| {
            found.push(found_in(row)?);
            if found.len() == CHUNK {
                ended = complete(&mut found)?;
            }
            Ok(ended)
        });
        read.and_then(|()| match ended {
            ControlFlow::Continue(()) => complete(&mut found).map(drop),
            ControlFlow::Break(()) => Ok(()),
        })
        .doing("reading parts")?;
        Ok(stopped.map_or(Ok(()), Err))
    }

    /// Returns all selected parts at once; use it only when they fit into memory.
    pub fn query(&self, filter: &Filter) -> Result<Vec<Part>> {
        let mut parts = Vec::new();
        let end = self.each(filter, |part| {
            parts.push(part);
            Ok::<(), std::convert::Infallible>(())
        })?;
        match end {
            Ok(()) => Ok(parts),
            Err(never) => match never {},
        }
    }

    /// Counts the selected parts.
    pub fn count_parts(&self, filter: &Filter) -> Result<u64> {
        let count = filter.count(self.source.dialect());
        let count = count.first(&self.source, |row| row.get::<i64>(0));
        Ok(count.doing("counting parts")?.unwrap_or(0).unsigned_abs())
    }

    /// Returns the cycle times of the selected parts, seconds, in no particular order.
    pub fn cycles(&self, filter: &Filter) -> Result<Vec<f64>> {
        filter
            .cycles()
            .rows(&self.source, |row| row.get(0))
            .doing("reading cycle times")
    }

    /// Returns part `seq` from every run of the lot, the latest run last, with all attempts, raw replies and curves.
    pub fn show(&self, lot: &str, seq: u64, kind: &str) -> Result<Vec<Part>> {
        let filter = Filter {
            lot: Some(lot.to_owned()),
            kind: Some(kind.to_owned()),
            ..Filter::default()
        };
        let mut select = filter.parts(self.source.dialect());
        let seq = i64::try_from(seq).unwrap_or(i64::MAX);
        select.sql = select
            .sql
            .replace(" ORDER BY", &format!(" AND part.seq = {seq} ORDER BY"));
        self.whole(&select)
    }

    /// Returns every test of the production parts with this serial number, the latest last, with all attempts, raw
    /// replies and curves.
    pub fn of_serial(&self, serial: &str) -> Result<Vec<Part>> {
        let filter = Filter {
            serial: Some(serial.to_owned()),
            ..Filter::default()
        };
        self.whole(&filter.parts(self.source.dialect()))
    }

    fn whole(&self, select: &filter::Select) -> Result<Vec<Part>> {
        const DOING: &str = "reading a part";
        let found = select.rows(&self.source, found_in).doing(DOING)?;
        let mut parts = self.completed(found).doing(DOING)?;
        for part in &mut parts {
            part.measurements = self.measurements(part).doing(DOING)?;
            part.curves = self.curves(part)?;
        }
        Ok(parts)
    }

    /// Returns the latest test of the reference part with this serial number.
    pub fn reference_part(&self, serial: &str) -> Result<Option<Part>> {
        const DOING: &str = "reading a reference part";
        let serial = Value::Text(serial.to_owned());
        let found = self
            .source
            .first(&filter::reference_part(), &[serial], found_in);
        let found = found.doing(DOING)?.into_iter().collect();
        Ok(self.completed(found).doing(DOING)?.pop())
    }

    /// Returns the calibration that was stored last for each coil voltage, of the real or the simulated rig. Fails on a
    /// server.
    pub fn calibrations(&self, simulated: bool) -> Result<Vec<CalibrationRecord>> {
        self.source
            .file()?
            .prepare(
                "SELECT made_at_us, due_at_us, hash, body, verified, max(id) FROM calibration
                 WHERE body ->> 'simulated' = ?1 GROUP BY body ->> 'nominal_v'",
            )
            .and_then(|mut it| it.query_map([simulated], store::calibration)?.collect())
            .doing("reading the latest calibrations")
    }

    /// Returns the keys of all parameters, in the order of the columns of an export.
    pub fn parameters(&self) -> Result<Vec<String>> {
        self.source
            .rows("SELECT key FROM parameter ORDER BY id", &[], |row| {
                row.get(0)
            })
            .doing("reading the parameters")
    }
}

/// Reads a part from the columns of [`Filter::parts`], without its details.
fn found_in(row: &Row<'_>) -> Read<Found> {
    let reasons: serde_json::Value = row.get(7)?;
    let part = Part {
        tag: "part",
        lot: String::new(),
        run: 0,
        rig: None,
        kind: row.get(2)?,
        seq: row.get::<i64>(3)?.unsigned_abs(),
        recipe: String::new(),
        serial: row.get(4)?,
        verdict: row.get(5)?,
        bin: row.get(6)?,
        landed_bin: row.get(11)?,
        landed_at: row.get::<Option<i64>>(12)?.map(Moment),
        reason_codes: Vec::new(),
        reasons: texts(&reasons).map(str::to_owned).collect(),
        time: Moment(row.get(8)?),
        test_s: row.get(9)?,
        cycle_s: row.get(10)?,
        values: serde_json::Map::new(),
        uncertainty: serde_json::Map::new(),
        measurements: Vec::new(),
        curves: Vec::new(),
        external: Vec::new(),
        row: row.get(0)?,
    };
    Ok(Found {
        part,
        run: row.get(1)?,
    })
}
