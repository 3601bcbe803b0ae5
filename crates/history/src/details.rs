//! Completes the parts that a query has found: reads runs, values and reasons of many parts at once, and for single
//! parts all attempts with their samples and curves.

use super::reasons::REASONS;
use super::source::{Dialect, Read};
use super::{Archive, Measurement, Moment, Part, Sample};
use machine::dut::Reason;
use rusqlite::types::Value;
use std::collections::{BTreeSet, HashMap};

/// Values of all attempts; [`of_parts`] adds the condition that selects parts, and the order.
pub(super) const VALUES: &str =
    "SELECT m.part_id, parameter.key, m.value, m.uncertainty FROM measurement AS m
     JOIN parameter ON parameter.id = m.parameter_id";
/// All attempts with limits, verdict and budget.
pub(super) const MEASUREMENTS: &str = "SELECT parameter.key, m.attempt, m.value, m.uncertainty,
       m.low, m.high, m.verdict, m.budget, m.parameter_id
     FROM measurement AS m JOIN parameter ON parameter.id = m.parameter_id";
/// Samples, which are replies of modules.
pub(super) const SAMPLES: &str =
    "SELECT parameter_id, attempt, line, module, channel, command, raw, at_us FROM sample";

/// A part with the number of its run, before its details are read.
#[derive(Debug)]
pub(super) struct Found {
    /// The part, without run, values and reason codes.
    pub part: Part,
    /// Number of its run.
    pub run: i64,
}

/// Lot, number, recipe and rig of a run.
type RunOf = (String, u32, String, Option<String>);
/// Values and uncertainties of a part, by key.
type Maps = (Map, Map);
type Map = serde_json::Map<String, serde_json::Value>;

/// Returns `select`, restricted to the rows of these parts in `table`, and the values of its parameters.
pub(super) fn of_parts(
    dialect: Dialect,
    (select, table, order): (&str, &str, &str),
    parts: &[&Part],
) -> (String, Vec<Value>) {
    let ids: Vec<i64> = parts.iter().map(|it| it.row).collect();
    let (among, values) = dialect.among(&format!("{table}.part_id"), &ids);
    let times = || parts.iter().map(|it| it.time.0);
    let span = (times().min().unwrap_or(0), times().max().unwrap_or(0));
    let judged = dialect.judged(table, span);
    (
        format!("{select} WHERE {among}{judged} ORDER BY {order}"),
        values,
    )
}

impl Archive {
    /// Adds runs, values and reasons to the parts found.
    pub(super) fn completed(&self, found: Vec<Found>) -> Read<Vec<Part>> {
        if found.is_empty() {
            return Ok(Vec::new());
        }
        let runs = self.runs_of(&found)?;
        let parts: Vec<&Part> = found.iter().map(|it| &it.part).collect();
        let mut values = self.values_of(&parts)?;
        let mut reasons = self.reasons_of(&parts)?;
        let lots: BTreeSet<&str> = runs.values().map(|(lot, ..)| lot.as_str()).collect();
        let external = self.results_of(lots)?;
        let complete = |Found { mut part, run }: Found| {
            if let Some((lot, number, recipe, rig)) = runs.get(&run) {
                part.lot.clone_from(lot);
                part.run = *number;
                part.recipe.clone_from(recipe);
                part.rig.clone_from(rig);
            }
            (part.values, part.uncertainty) = values.remove(&part.row).unwrap_or_default();
            let mut codes = reasons.remove(&part.row).unwrap_or_default().into_iter();
            let code = |text: &String| {
                let known = codes.next().flatten();
                known.unwrap_or_else(|| Reason::unclassified(text))
            };
            part.reason_codes = part.reasons.iter().map(code).collect();
            let own = external
                .iter()
                .filter(|it| it.lot == part.lot && it.is_on(&part));
            part.external = own.cloned().collect();
            part
        };
        Ok(found.into_iter().map(complete).collect())
    }

    fn runs_of(&self, found: &[Found]) -> Read<HashMap<i64, RunOf>> {
        let mut ids: Vec<i64> = found.iter().map(|it| it.run).collect();
        ids.dedup();
        let dialect = self.source.dialect();
        let (among, values) = dialect.among("run.id", &ids);
        let sql = format!(
            "SELECT run.id, lot.name, run.number, recipe.name, {} FROM run JOIN lot ON lot.id = run.lot_id
             JOIN recipe ON recipe.id = run.recipe_id WHERE {among}",
            dialect.rig()
        );
        let runs = self.source.rows(&sql, &values, |row| {
            let run = (row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?);
            Ok((row.get(0)?, run))
        })?;
        Ok(runs.into_iter().collect())
    }

    /// Returns value and uncertainty of the last attempt at each parameter, by part.
    fn values_of(&self, parts: &[&Part]) -> Read<HashMap<i64, Maps>> {
        let order = "m.part_id, m.parameter_id, m.attempt";
        let (sql, bound) = of_parts(self.source.dialect(), (VALUES, "m", order), parts);
        let mut of: HashMap<i64, Maps> = HashMap::new();
        self.source.rows(&sql, &bound, |row| {
            let (values, uncertainty) = of.entry(row.get(0)?).or_default();
            let key: String = row.get(1)?;
            values.insert(key.clone(), row.get::<Option<f64>>(2)?.into());
            uncertainty.insert(key, row.get::<Option<f64>>(3)?.into());
            Ok(())
        })?;
        Ok(of)
    }

    /// Returns the reason codes by part; `None` for a code that this program does not know.
    fn reasons_of(&self, parts: &[&Part]) -> Read<HashMap<i64, Vec<Option<Reason>>>> {
        let with = |it: &&&Part| !it.reasons.is_empty();
        let rejects: Vec<i64> = parts.iter().filter(with).map(|it| it.row).collect();
        let mut of: HashMap<i64, Vec<Option<Reason>>> = HashMap::new();
        if rejects.is_empty() {
            return Ok(of);
        }
        let (among, bound) = self.source.dialect().among("reason.part_id", &rejects);
        let sql = format!("{REASONS} WHERE {among} ORDER BY part_id, n");
        self.source.rows(&sql, &bound, |row| {
            let code = super::reasons::read(row)?;
            of.entry(row.get(0)?).or_default().push(code);
            Ok(())
        })?;
        Ok(of)
    }

    /// Returns all attempts of a part with their samples.
    pub(super) fn measurements(&self, part: &Part) -> Read<Vec<Measurement>> {
        let order = "m.parameter_id, m.attempt";
        let dialect = self.source.dialect();
        let (sql, bound) = of_parts(dialect, (MEASUREMENTS, "m", order), &[part]);
        let mut samples = self.samples(part)?;
        self.source.rows(&sql, &bound, |row| {
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
                samples: samples.remove(&(row.get(8)?, attempt)).unwrap_or_default(),
            })
        })
    }

    /// Returns the samples of a part by parameter and attempt.
    fn samples(&self, part: &Part) -> Read<HashMap<(i64, u32), Vec<Sample>>> {
        let order = "parameter_id, attempt, n";
        let dialect = self.source.dialect();
        let (sql, bound) = of_parts(dialect, (SAMPLES, "sample", order), &[part]);
        let mut of: HashMap<(i64, u32), Vec<Sample>> = HashMap::new();
        self.source.rows(&sql, &bound, |row| {
            let sample = Sample {
                line: row.get(2)?,
                module: row.get(3)?,
                channel: row.get(4)?,
                command: row.get(5)?,
                raw: row.get(6)?,
                at: Moment(row.get(7)?),
            };
            of.entry((row.get(0)?, row.get(1)?))
                .or_default()
                .push(sample);
            Ok(())
        })?;
        Ok(of)
    }
}
