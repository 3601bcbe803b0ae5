//! Summaries of runs, and counts of verdicts in a span of time.

use super::error::{Doing, Result};
use super::source::Read;
use super::{Archive, ExternalStanding, Filter, Moment};
use rusqlite::types::Value;
use serde::Serialize;
use utoipa::ToSchema;

/// A run, with counts of its production parts.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct LotSummary {
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// Plant and name of the rig, where the answer may be of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<String>,
    /// Name of the recipe.
    pub recipe: String,
    /// Hash of the recipe.
    pub recipe_hash: String,
    /// Hash of the calibration that the run used, if any.
    pub calibration_hash: Option<String>,
    /// `rig`, `simulated` or `import`.
    pub source: String,
    /// Seed of the simulated rig; `None` on a real one.
    pub seed: Option<String>,
    /// Person who agreed to a retest; `None` for a first test.
    pub retest: Option<String>,
    /// Start of the run.
    pub opened: Moment,
    /// End of the run; `None` while it is under way, and for a run that was cut off.
    pub closed: Option<Moment>,
    /// How the run ended: `complete`, `stopped` or `alarm`; `None` for a run without an end, and for runs older than
    /// schema 9.
    pub ended: Option<String>,
    /// Code of the alarm or program fault that ended the run; `None` for any other end.
    pub cause: Option<String>,
    /// Text of the cause, English.
    pub cause_text: Option<String>,
    /// Counts of production parts.
    #[serde(flatten)]
    pub counts: Yield,
    /// Number of tests of reference parts.
    pub golden: u64,
    /// Number of alarms.
    pub alarms: u64,
    /// Number of production parts by the bin that the verdict assigns.
    pub bins: std::collections::BTreeMap<String, u64>,
    /// Whether the lot is acceptable by its results from outside of the rig; absent for a lot that has and needs none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub external: Option<ExternalStanding>,
}

/// Number of parts by verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, ToSchema)]
pub struct Yield {
    /// Number of all parts, judged or not.
    pub parts: u64,
    /// Passed parts.
    pub pass: u64,
    /// Failed parts.
    pub fail: u64,
    /// Parts that could not be judged.
    pub void: u64,
    /// Parts that were imported without a verdict.
    pub unjudged: u64,
}

impl Yield {
    /// Returns the passed share of the judged parts, %; `None` without judged parts.
    pub fn percent(&self) -> Option<f64> {
        let judged = self.parts - self.unjudged;
        (judged > 0).then(|| 100.0 * self.pass as f64 / judged as f64)
    }

    fn count(&mut self, verdict: &str, parts: u64) {
        self.parts += parts;
        match verdict {
            "pass" => self.pass += parts,
            "fail" => self.fail += parts,
            "void" => self.void += parts,
            _ => self.unjudged += parts,
        }
        let judged = self.pass + self.fail + self.void;
        assert_eq!(self.parts, judged + self.unjudged, "a part counted twice");
    }
}

/// Counts the verdicts on production parts in a span of time.
pub(super) const YIELD: &str = "SELECT verdict, count(*) FROM part INDEXED BY part_time
    WHERE judged_at_us >= ?1 AND judged_at_us < ?2 AND kind = 'lot' GROUP BY verdict";
/// Counts the parts of one run by kind, verdict and bin.
pub(super) const COUNTS: &str =
    "SELECT kind, verdict, bin, count(*) FROM part WHERE run_id = ?1 GROUP BY 1, 2, 3";

impl Archive {
    /// Returns the runs that lot, recipe and run of the filter select, in the order in which the history received them,
    /// whatever the clock said.
    pub fn lots(&self, filter: &Filter) -> Result<Vec<LotSummary>> {
        self.lots_since(filter, None)
    }

    /// Returns the runs of [`Archive::lots`] that were opened at `opened` or later; `None` returns all.
    pub fn lots_since(&self, filter: &Filter, opened: Option<Moment>) -> Result<Vec<LotSummary>> {
        let mut select = filter.runs();
        if let Some(opened) = opened {
            select.add(" AND run.opened_at_us >= ?", opened.0);
        }
        select.sql = format!(
            "SELECT lot.name, run.number, recipe.name, recipe.hash, run.calibration_hash,
               run.source, run.seed, run.opened_at_us, run.closed_at_us, run.id,
               (SELECT consented_by FROM retest WHERE run_id = run.id),
               run_end.ended, run_end.cause, run_end.cause_text, {}, recipe.body LIKE '%external%'
             FROM run JOIN lot ON lot.id = run.lot_id JOIN recipe ON recipe.id = run.recipe_id
               LEFT JOIN run_end ON run_end.run_id = run.id
             WHERE run.id IN ({}) ORDER BY run.id",
            self.source.dialect().rig(),
            select.sql
        );
        let lots = select.rows(&self.source, |row| {
            let mut summary = LotSummary {
                lot: row.get(0)?,
                run: row.get(1)?,
                rig: row.get(14)?,
                recipe: row.get(2)?,
                recipe_hash: row.get(3)?,
                calibration_hash: row.get(4)?,
                source: row.get(5)?,
                seed: row.get(6)?,
                retest: row.get(10)?,
                opened: Moment(row.get(7)?),
                closed: row.get::<Option<i64>>(8)?.map(Moment),
                ended: row.get(11)?,
                cause: row.get(12)?,
                cause_text: row.get(13)?,
                counts: Yield::default(),
                golden: 0,
                alarms: 0,
                bins: std::collections::BTreeMap::new(),
                external: None,
            };
            self.count(row.get(9)?, &mut summary)?;
            Ok((summary, row.get::<bool>(15)?))
        });
        let with_standing = |(mut summary, may_need): (LotSummary, bool)| {
            if may_need {
                summary.external = self.external_standing(&summary.lot)?;
            }
            Ok(summary)
        };
        lots.doing("reading the lots")?
            .into_iter()
            .map(with_standing)
            .collect()
    }

    /// Returns the text of the recipe with this hash.
    pub fn recipe(&self, hash: &str) -> Result<Option<String>> {
        let hash = Value::Text(hash.to_owned());
        self.source
            .first("SELECT body FROM recipe WHERE hash = ?", &[hash], |row| {
                row.get(0)
            })
            .doing("reading a recipe")
    }

    /// Returns true when lot, recipe and run of the filter select at least one run.
    pub fn has_runs(&self, filter: &Filter) -> Result<bool> {
        let runs = filter.runs();
        runs.exists(&self.source).doing("looking for a run")
    }

    /// Counts the verdicts on production parts that were judged in a time span: `since` included, `until` excluded.
    pub fn yield_between(&self, since: Moment, until: Moment) -> Result<Yield> {
        let mut counts = Yield::default();
        let span = [Value::Integer(since.0), Value::Integer(until.0)];
        self.source
            .rows(YIELD, &span, |row| {
                let verdict: String = row.get(0)?;
                counts.count(&verdict, row.get::<i64>(1)?.unsigned_abs());
                Ok(())
            })
            .doing("counting verdicts")?;
        Ok(counts)
    }

    fn count(&self, run: i64, summary: &mut LotSummary) -> Read<()> {
        let run = [Value::Integer(run)];
        self.source.rows(COUNTS, &run, |row| {
            let parts = row.get::<i64>(3)?.unsigned_abs();
            if row.get::<String>(0)? == "golden" {
                summary.golden += parts;
                return Ok(());
            }
            summary.counts.count(&row.get::<String>(1)?, parts);
            if let Some(bin) = row.get::<Option<String>>(2)? {
                *summary.bins.entry(bin).or_default() += parts;
            }
            Ok(())
        })?;
        let alarms = "SELECT count(*) FROM alarm WHERE run_id = ?";
        let alarms = self.source.first(alarms, &run, |row| row.get::<i64>(0))?;
        summary.alarms = alarms.unwrap_or(0).unsigned_abs();
        Ok(())
    }
}
