//! Reads results from outside of the rig, and whether a lot is acceptable by them.

use crate::error::{Doing, Result};
use crate::source::{Read, Row};
use crate::{Archive, Moment, Part};
use machine::dut::External;
use machine::dut::external::{ExternalDemands, ExternalVerdict};
use rusqlite::types::Value;
use serde::Serialize;
use std::collections::{BTreeSet, HashSet};
use utoipa::ToSchema;

/// A result from outside of the rig.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ExternalResult {
    /// Name of the lot.
    pub lot: String,
    /// Serial number of the sample; null for a part without one, and for a result of the lot.
    pub serial: Option<String>,
    /// Run of a sample without serial number.
    pub run: Option<u32>,
    /// Number of that sample in its run.
    pub seq: Option<u64>,
    /// Key of the quantity, which ends with its unit.
    pub key: String,
    /// Value, in the unit of the key.
    pub value: f64,
    /// Expanded uncertainty (k = 2), in the unit of `value`; null when it was not stated.
    pub uncertainty: Option<f64>,
    /// Lower limit of the recipe, if any.
    pub low: Option<f64>,
    /// Upper limit of the recipe, if any.
    pub high: Option<f64>,
    /// Judgement by limit and rule of the recipe.
    pub verdict: ExternalVerdict,
    /// True when a later result on the same sample and quantity counts instead.
    pub superseded: bool,
    /// Hash of the recipe that judged.
    pub recipe_hash: String,
    /// Person who entered the result.
    pub who: String,
    /// Time of the measurement.
    pub measured: Moment,
    /// Time of the entry.
    pub entered: Moment,
    /// SHA-256 of the imported file, hexadecimal; null for a result that was typed in.
    pub file_hash: Option<String>,
    /// Line in that file.
    pub line: Option<u32>,
}

impl ExternalResult {
    /// Returns true for a result on this part; false for a result of the lot.
    pub fn is_on(&self, part: &Part) -> bool {
        match &self.serial {
            _ if part.kind != "lot" => false,
            Some(serial) => part.serial.as_ref() == Some(serial),
            None => self.seq == Some(part.seq) && self.run == Some(part.run),
        }
    }

    /// Returns true for a result of the lot as a whole.
    pub const fn is_of_lot(&self) -> bool {
        self.serial.is_none() && self.seq.is_none()
    }

    /// Returns the sample as text: a serial number, or run and number of a part; `None` for the lot.
    pub fn sample(&self) -> Option<String> {
        let part = || Some(format!("{} / {}", self.run?, self.seq?));
        self.serial.clone().or_else(part)
    }
}

/// Whether a lot is acceptable by its results from outside of the rig; those that a later one supersedes do not count.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct ExternalStanding {
    /// True when no quantity is missing and every result passes.
    pub acceptable: bool,
    /// Results that keep their limit.
    pub pass: usize,
    /// Results that violate it.
    pub fail: usize,
    /// Results within U of it.
    pub undecided: usize,
    /// Keys that the recipe demands and of which the lot has no result.
    pub missing: Vec<String>,
}

impl ExternalStanding {
    fn new(demands: &ExternalDemands, results: &[ExternalResult]) -> Option<Self> {
        if demands.limits.is_empty() && results.is_empty() {
            return None;
        }
        let counting = || results.iter().filter(|it| !it.superseded);
        let count = |verdict| counting().filter(|it| it.verdict == verdict).count();
        let there: BTreeSet<&str> = counting().map(|it| it.key.as_str()).collect();
        let demanded = demands.limits.demanded().map(External::key);
        let missing: Vec<String> = demanded
            .filter(|it| !there.contains(it))
            .map(str::to_owned)
            .collect();
        let (fail, undecided) = (
            count(ExternalVerdict::Fail),
            count(ExternalVerdict::Undecided),
        );
        Some(Self {
            acceptable: missing.is_empty() && fail + undecided == 0,
            pass: count(ExternalVerdict::Pass),
            fail,
            undecided,
            missing,
        })
    }
}

/// Selects the results of the lots that a condition names, in order of entry.
const RESULTS: &str = "SELECT it.id, lot.name, it.serial, it.run, it.seq, it.key, it.value, it.uncertainty, it.low, it.high,
      it.verdict, it.recipe_hash, it.who, it.measured_at_us, it.entered_at_us, it.file_hash, it.line
    FROM external_result AS it JOIN lot ON lot.id = it.lot_id";

/// Selects the recipe of the last run of a lot.
const RECIPE: &str = "SELECT recipe.body FROM lot JOIN run ON run.lot_id = lot.id JOIN recipe ON recipe.id = run.recipe_id
    WHERE lot.name = ? ORDER BY run.source = 'import', run.number DESC LIMIT 1";

impl Archive {
    /// Returns the results from outside of the rig of a lot, in order of entry.
    pub fn external_results(&self, lot: &str) -> Result<Vec<ExternalResult>> {
        self.results_of([lot])
            .doing("reading results from outside of the rig")
    }

    /// Returns whether a lot is acceptable by its results from outside of the rig; `None` for a lot that has and needs
    /// none.
    pub fn external_standing(&self, lot: &str) -> Result<Option<ExternalStanding>> {
        let results = self.external_results(lot)?;
        let body = self
            .source
            .first(RECIPE, &[Value::Text(lot.to_owned())], |row| {
                row.get::<String>(0)
            });
        let body = body
            .doing("reading the recipe of a lot")?
            .unwrap_or_default();
        let demands = ExternalDemands::of_recipe(&body);
        Ok(ExternalStanding::new(&demands, &results))
    }

    /// Returns the results on parts of these lots, and of the lots themselves.
    pub(crate) fn results_of<'a>(
        &self,
        lots: impl IntoIterator<Item = &'a str>,
    ) -> Read<Vec<ExternalResult>> {
        let mut all = Vec::new();
        for lot in lots {
            let sql = format!("{RESULTS} WHERE lot.name = ? ORDER BY it.id");
            let lot = [Value::Text(lot.to_owned())];
            all.extend(superseding(self.source.rows(&sql, &lot, result)?));
        }
        Ok(all)
    }
}

/// Reads a row of [`RESULTS`], with the number of its history: 0 in a file.
fn result(row: &Row<'_>) -> Read<(i64, ExternalResult)> {
    let result = ExternalResult {
        lot: row.get(1)?,
        serial: row.get(2)?,
        run: row.get(3)?,
        seq: row.get::<Option<i64>>(4)?.map(i64::unsigned_abs),
        key: row.get(5)?,
        value: row.get(6)?,
        uncertainty: row.get(7)?,
        low: row.get(8)?,
        high: row.get(9)?,
        verdict: ExternalVerdict::from_name(&row.get::<String>(10)?),
        superseded: false,
        recipe_hash: row.get(11)?,
        who: row.get(12)?,
        measured: Moment(row.get(13)?),
        entered: Moment(row.get(14)?),
        file_hash: row.get(15)?,
        line: row.get(16)?,
    };
    Ok((row.get::<i64>(0)? >> 40, result))
}

/// Marks the results that a later one supersedes. On a server, results of different rigs stand beside each other.
fn superseding(mut rows: Vec<(i64, ExternalResult)>) -> Vec<ExternalResult> {
    let mut later = HashSet::new();
    for (history, it) in rows.iter_mut().rev() {
        let sample = (*history, it.key.clone(), it.serial.clone(), it.run, it.seq);
        it.superseded = !later.insert(sample);
    }
    rows.into_iter().map(|(_, it)| it).collect()
}
