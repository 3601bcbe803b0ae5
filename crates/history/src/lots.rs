//! Summaries of runs, and counts of verdicts in a span of time.

use super::error::{Doing, Result};
use super::{Archive, Filter, Moment};
use rusqlite::{OptionalExtension, params};
use serde::Serialize;
use utoipa::ToSchema;

/// A run, with counts of its production parts.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct LotSummary {
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
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
    /// How the run ended: `complete`, `stopped` or `alarm`; `None` when it has no end, and for runs older than schema
    /// 9.
    pub ended: Option<String>,
    /// Code of the alarm or program fault that ended the run; `None` when neither did.
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
    /// Returns the runs in the order in which the history received them, whatever the clock said; lot, recipe and run of the filter select them.
    pub fn lots(&self, filter: &Filter) -> Result<Vec<LotSummary>> {
        let mut select = filter.runs();
        select.sql = format!(
            "SELECT lot.name, run.number, recipe.name, recipe.hash, run.calibration_hash,
               run.source, run.seed, run.opened_at_us, run.closed_at_us, run.id,
               (SELECT consented_by FROM retest WHERE run_id = run.id),
               run_end.ended, run_end.cause, run_end.cause_text
             FROM run JOIN lot ON lot.id = run.lot_id JOIN recipe ON recipe.id = run.recipe_id
               LEFT JOIN run_end ON run_end.run_id = run.id
             WHERE run.id IN ({}) ORDER BY run.id",
            select.sql
        );
        let lots = select.rows(&self.connection, |row| {
            let mut summary = LotSummary {
                lot: row.get(0)?,
                run: row.get(1)?,
                recipe: row.get(2)?,
                recipe_hash: row.get(3)?,
                calibration_hash: row.get(4)?,
                source: row.get(5)?,
                seed: row.get(6)?,
                retest: row.get(10)?,
                opened: Moment(row.get(7)?),
                closed: row.get::<_, Option<i64>>(8)?.map(Moment),
                ended: row.get(11)?,
                cause: row.get(12)?,
                cause_text: row.get(13)?,
                counts: Yield::default(),
                golden: 0,
                alarms: 0,
                bins: std::collections::BTreeMap::new(),
            };
            self.count(row.get(9)?, &mut summary)?;
            Ok(summary)
        });
        lots.doing("reading the lots")
    }

    /// Returns the text of the recipe with this hash.
    pub fn recipe(&self, hash: &str) -> Result<Option<String>> {
        self.connection
            .prepare_cached("SELECT body FROM recipe WHERE hash = ?1")
            .and_then(|mut it| it.query_row([hash], |row| row.get(0)).optional())
            .doing("reading a recipe")
    }

    /// Returns true when lot, recipe and run of the filter select at least one run.
    pub fn has_runs(&self, filter: &Filter) -> Result<bool> {
        let runs = filter.runs();
        runs.exists(&self.connection).doing("looking for a run")
    }

    /// Counts the verdicts on production parts that were judged in a time span: `since` included, `until` excluded.
    pub fn yield_between(&self, since: Moment, until: Moment) -> Result<Yield> {
        let mut counts = Yield::default();
        self.connection
            .prepare_cached(YIELD)
            .and_then(|mut statement| {
                let mut rows = statement.query(params![since.0, until.0])?;
                while let Some(row) = rows.next()? {
                    counts.count(
                        &row.get::<_, String>(0)?,
                        row.get::<_, i64>(1)?.unsigned_abs(),
                    );
                }
                Ok(counts)
            })
            .doing("counting verdicts")
    }

    fn count(&self, run: i64, summary: &mut LotSummary) -> rusqlite::Result<()> {
        let mut statement = self.connection.prepare_cached(COUNTS)?;
        let mut rows = statement.query([run])?;
        while let Some(row) = rows.next()? {
            let parts = row.get::<_, i64>(3)?.unsigned_abs();
            if row.get::<_, String>(0)? == "golden" {
                summary.golden += parts;
                continue;
            }
            summary.counts.count(&row.get::<_, String>(1)?, parts);
            if let Some(bin) = row.get::<_, Option<String>>(2)? {
                *summary.bins.entry(bin).or_default() += parts;
            }
        }
        let alarms = "SELECT count(*) FROM alarm WHERE run_id = ?1";
        let alarms: i64 = self
            .connection
            .prepare_cached(alarms)?
            .query_row([run], |row| row.get(0))?;
        summary.alarms = alarms.unsigned_abs();
        Ok(())
    }
}
