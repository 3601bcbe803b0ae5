//! The reader of the history: parts that a filter selects, and single parts down to their raw replies.

use super::error::{Doing, Result};
use super::reasons::texts;
use super::{CalibrationRecord, Filter, Measurement, Moment, Part, Sample, filter, open, store};
use rusqlite::{Connection, Row, params, params_from_iter};
use std::path::{Path, PathBuf};

/// A history that is open for reading. Reading never blocks a writer.
#[derive(Debug)]
pub struct Archive {
    pub(super) connection: Connection,
    pub(super) path: PathBuf,
}

/// Selects the values of all attempts of one part.
pub(super) const VALUES: &str = "SELECT parameter.key, m.value, m.uncertainty FROM measurement AS m
    JOIN parameter ON parameter.id = m.parameter_id
    WHERE m.part_id = ?1 ORDER BY m.parameter_id, m.attempt";
/// Selects the measurements of one part: all attempts, with limits, verdict and budget.
pub(super) const MEASUREMENTS: &str = "SELECT parameter.key, m.attempt, m.value, m.uncertainty,
      m.low, m.high, m.verdict, m.budget, m.parameter_id
    FROM measurement AS m JOIN parameter ON parameter.id = m.parameter_id
    WHERE m.part_id = ?1 ORDER BY m.parameter_id, m.attempt";
/// Selects the samples of one attempt, which are replies of modules.
pub(super) const SAMPLES: &str = "SELECT line, module, channel, command, raw, at_us FROM sample
    WHERE part_id = ?1 AND parameter_id = ?2 AND attempt = ?3 ORDER BY n";

impl Archive {
    /// Opens an existing history and migrates an older schema. Fails on a file of another program, and on a newer
    /// schema.
    pub fn open(path: &Path) -> Result<Self> {
        Ok(Self {
            connection: open::reader(path)?,
            path: path.to_owned(),
        })
    }

    /// Opens an existing history to check or copy it, whatever its schema; writes nothing to the file.
    pub fn open_unchanged(path: &Path) -> Result<Self> {
        Ok(Self {
            connection: open::unchanged(path)?.0,
            path: path.to_owned(),
        })
    }

    /// Calls `each` for every selected part, in order of judgement; the memory needed does not grow with their number.
    /// Stops at the first error of `each` and returns it.
    pub fn each<E>(
        &self,
        filter: &Filter,
        mut each: impl FnMut(Part) -> std::result::Result<(), E>,
    ) -> Result<std::result::Result<(), E>> {
        const DOING: &str = "reading parts";
        let select = filter.parts();
        let mut statement = self.connection.prepare(&select.sql).doing(DOING)?;
        let mut rows = statement
            .query(params_from_iter(&select.values))
            .doing(DOING)?;
        while let Some(row) = rows.next().doing(DOING)? {
            let part = self.part(row).doing(DOING)?;
            if let Err(stop) = each(part) {
                return Ok(Err(stop));
            }
        }
        Ok(Ok(()))
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
        filter
            .count()
            .first(&self.connection, |row| row.get(0))
            .map(i64::unsigned_abs)
            .doing("counting parts")
    }

    /// Returns the cycle times of the selected parts, seconds, in no particular order.
    pub fn cycles(&self, filter: &Filter) -> Result<Vec<f64>> {
        filter
            .cycles()
            .rows(&self.connection, |row| row.get(0))
            .doing("reading cycle times")
    }

    /// Returns part `seq` from every run of the lot, the latest run last, with all attempts, raw replies and curves.
    pub fn show(&self, lot: &str, seq: u64, kind: &str) -> Result<Vec<Part>> {
        let filter = Filter {
            lot: Some(lot.to_owned()),
            kind: Some(kind.to_owned()),
            ..Filter::default()
        };
        let mut select = filter.parts();
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
        self.whole(&filter.parts())
    }

    fn whole(&self, select: &filter::Select) -> Result<Vec<Part>> {
        let parts = select.rows(&self.connection, |row| {
            let mut part = self.part(row)?;
            part.measurements = self.measurements(part.row)?;
            Ok(part)
        });
        let mut parts = parts.doing("reading a part")?;
        for part in &mut parts {
            part.curves = self.curves(part)?;
        }
        Ok(parts)
    }

    /// Returns the latest test of the reference part with this serial number.
    pub fn reference_part(&self, serial: &str) -> Result<Option<Part>> {
        const DOING: &str = "reading a reference part";
        let mut statement = self
            .connection
            .prepare(&filter::reference_part())
            .doing(DOING)?;
        let mut rows = statement.query([serial]).doing(DOING)?;
        let row = rows.next().doing(DOING)?;
        row.map(|row| self.part(row)).transpose().doing(DOING)
    }

    /// Returns the calibration that was stored last for each coil voltage, of the real or the simulated rig.
    pub fn calibrations(&self, simulated: bool) -> Result<Vec<CalibrationRecord>> {
        self.connection
            .prepare(
                "SELECT made_at_us, due_at_us, hash, body, verified, max(id) FROM calibration
                 WHERE body ->> 'simulated' = ?1 GROUP BY body ->> 'nominal_v'",
            )
            .and_then(|mut it| it.query_map([simulated], store::calibration)?.collect())
            .doing("reading the latest calibrations")
    }

    /// Returns the keys of all parameters, in the order in which exports list their columns.
    pub fn parameters(&self) -> Result<Vec<String>> {
        self.connection
            .prepare_cached("SELECT key FROM parameter ORDER BY id")
            .and_then(|mut it| it.query_map([], |row| row.get(0))?.collect())
            .doing("reading the parameters")
    }

    fn part(&self, row: &Row<'_>) -> rusqlite::Result<Part> {
        let id: i64 = row.get(0)?;
        let (lot, run, recipe) = self.run(row.get(1)?)?;
        let reasons: serde_json::Value = row.get(7)?;
        let reasons: Vec<String> = texts(&reasons).map(str::to_owned).collect();
        let (values, uncertainty) = self.values_of(id)?;
        Ok(Part {
            tag: "part",
            lot,
            run,
            kind: row.get(2)?,
            seq: row.get::<_, i64>(3)?.unsigned_abs(),
            recipe,
            serial: row.get(4)?,
            verdict: row.get(5)?,
            bin: row.get(6)?,
            landed_bin: row.get(11)?,
            landed_at: row.get::<_, Option<i64>>(12)?.map(Moment),
            reason_codes: self.reasons(id, &reasons)?,
            reasons,
            time: Moment(row.get(8)?),
            test_s: row.get(9)?,
            cycle_s: row.get(10)?,
            values,
            uncertainty,
            measurements: Vec::new(),
            curves: Vec::new(),
            row: id,
        })
    }

    fn run(&self, id: i64) -> rusqlite::Result<(String, u32, String)> {
        self.connection
            .prepare_cached(
                "SELECT lot.name, run.number, recipe.name FROM run JOIN lot ON lot.id = run.lot_id
                 JOIN recipe ON recipe.id = run.recipe_id WHERE run.id = ?1",
            )?
            .query_row([id], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))
    }

    /// Returns value and uncertainty of the last attempt at each parameter, by key.
    fn values_of(&self, part: i64) -> rusqlite::Result<(Map, Map)> {
        let mut statement = self.connection.prepare_cached(VALUES)?;
        let mut rows = statement.query([part])?;
        let (mut values, mut uncertainty) = (Map::new(), Map::new());
        while let Some(row) = rows.next()? {
            let key: String = row.get(0)?;
            values.insert(key.clone(), row.get::<_, Option<f64>>(1)?.into());
            uncertainty.insert(key, row.get::<_, Option<f64>>(2)?.into());
        }
        Ok((values, uncertainty))
    }

    fn measurements(&self, part: i64) -> rusqlite::Result<Vec<Measurement>> {
        let mut statement = self.connection.prepare_cached(MEASUREMENTS)?;
        let rows = statement.query_map([part], |row| {
            let attempt = row.get(1)?;
            Ok(Measurement {
                parameter: row.get(0)?,
                attempt,
                value: row.get(2)?,
                uncertainty: row.get(3)?,
                low: row.get(4)?,
                high: row.get(5)?,
                verdict: row.get(6)?,
                budget: row.get(7)?,
                samples: self.samples(part, row.get(8)?, attempt)?,
            })
        })?;
        rows.collect()
    }

    fn samples(&self, part: i64, parameter: i64, attempt: u32) -> rusqlite::Result<Vec<Sample>> {
        let mut statement = self.connection.prepare_cached(SAMPLES)?;
        let rows = statement.query_map(params![part, parameter, attempt], |row| {
            Ok(Sample {
                line: row.get(0)?,
                module: row.get(1)?,
                channel: row.get(2)?,
                command: row.get(3)?,
                raw: row.get(4)?,
                at: Moment(row.get(5)?),
            })
        })?;
        rows.collect()
    }
}

type Map = serde_json::Map<String, serde_json::Value>;
