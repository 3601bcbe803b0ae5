//! Enters results: checks them against recipe and parts of their lot, has the recipe judge them, writes all or none.

use crate::csv::CsvError;
use crate::error::{Doing, Result};
use crate::insert::signed;
use crate::{Moment, Store};
use machine::dut::External;
use machine::dut::external::{ExternalDemands, ExternalVerdict};
use machine::form::one_of;
use machine::gauge::{Limit, Rule};
use rusqlite::{OptionalExtension, Transaction, params};
use std::collections::HashSet;

const DOING: &str = "entering results from outside of the rig";

/// Sample of a lot on which a result was measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sample {
    /// The lot as a whole, or a sample that is not named.
    Lot,
    /// The part with this serial number.
    Serial(String),
    /// A part without serial number, by its number in a run.
    Part {
        /// Number of the run; `None` when only one run of the lot has such a part.
        run: Option<u32>,
        /// Number of the part.
        seq: u64,
    },
}

/// A result to enter.
#[derive(Debug, Clone, PartialEq)]
pub struct NewResult {
    /// Line of the file; `None` for a result that is typed in.
    pub line: Option<usize>,
    /// What was measured.
    pub sample: Sample,
    /// The quantity.
    pub key: External,
    /// Value in the unit of the key.
    pub value: f64,
    /// Expanded uncertainty (k = 2) in the same unit, if stated.
    pub u: Option<f64>,
    /// Time of the measurement, if stated.
    pub measured_at: Option<Moment>,
}

/// Results to enter at once.
#[derive(Debug, Clone)]
pub struct EnteredResults<'a> {
    /// Name of the lot.
    pub lot: &'a str,
    /// Recipe for which the results are meant; refused when the lot was run with another one.
    pub recipe: Option<&'a str>,
    /// Person who enters them.
    pub who: &'a str,
    /// Now.
    pub at: Moment,
    /// SHA-256 of the file, hexadecimal; `None` for results that are typed in.
    pub file_hash: Option<&'a str>,
    /// The results.
    pub results: &'a [NewResult],
}

/// Number of entered results by verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Entered {
    /// Results that keep their limit.
    pub pass: usize,
    /// Results that violate it.
    pub fail: usize,
    /// Results within U of it.
    pub undecided: usize,
}

/// Reason why no result of a file or a form is entered.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResultRefusal {
    /// The text is not CSV.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// A column or a cell is wrong.
    #[error("{}{column}: found {found}, expected {expected}", place(.line))]
    Wrong {
        /// Line of the file; `None` for a result that is typed in.
        line: Option<usize>,
        /// Column of the file, or member of the form.
        column: &'static str,
        /// What was found, in quotation marks, or nothing.
        found: String,
        /// What is accepted.
        expected: String,
    },
    /// The file was imported before.
    #[error(
        "this very file is in lot {lot:?} already, with {results} results; nothing was imported"
    )]
    Again {
        /// Name of the lot.
        lot: String,
        /// Number of its results.
        results: u64,
    },
}

fn place(line: &Option<usize>) -> String {
    line.map_or_else(String::new, |it| format!("line {it}, column "))
}

impl ResultRefusal {
    pub(super) fn wrong(
        line: Option<usize>,
        column: &'static str,
        found: impl ToString,
        expected: impl Into<String>,
    ) -> Self {
        let found = match found.to_string() {
            text if text.is_empty() => "nothing".to_owned(),
            text => format!("{text:?}"),
        };
        let expected = expected.into();
        Self::Wrong {
            line,
            column,
            found,
            expected,
        }
    }
}

/// A lot with the recipe that judges its results.
struct Lot {
    id: i64,
    recipe: String,
    hash: String,
    demands: ExternalDemands,
}

type Checked<T> = std::result::Result<T, ResultRefusal>;

impl Store {
    /// Enters results, all or none. The recipe of the last run of the lot judges them.
    ///
    /// # Errors
    /// Fails when the history cannot be written. The inner error is a refusal: an unknown lot or part, a quantity that
    /// the recipe of the lot does not demand, a value out of its range, an uncertainty that the rule of the recipe needs
    /// and that is missing, a time in the future, or a file that the lot has already.
    pub fn enter_results(&mut self, all: &EnteredResults<'_>) -> Result<Checked<Entered>> {
        let transaction = self.transaction(DOING)?;
        let entered = match lot_of(&transaction, all)? {
            Ok(lot) => enter(&transaction, all, &lot)?,
            Err(refused) => Err(refused),
        };
        if entered.is_ok() {
            transaction.commit().doing(DOING)?;
        }
        Ok(entered)
    }
}

/// Returns the lot with the recipe of its last run; refuses another recipe than the one expected.
fn lot_of(tx: &Transaction<'_>, all: &EnteredResults<'_>) -> Result<Checked<Lot>> {
    let wrong = |column, found: &str, expected: String| {
        Ok(Err(ResultRefusal::wrong(None, column, found, expected)))
    };
    let sql = "SELECT lot.id, recipe.name, recipe.hash, recipe.body FROM lot JOIN run ON run.lot_id = lot.id
          JOIN recipe ON recipe.id = run.recipe_id
        WHERE lot.name = ?1 ORDER BY run.source = 'import', run.number DESC LIMIT 1";
    let read = |row: &rusqlite::Row<'_>| {
        Ok(Lot {
            id: row.get(0)?,
            recipe: row.get(1)?,
            hash: row.get(2)?,
            demands: ExternalDemands::of_recipe(&row.get::<_, String>(3)?),
        })
    };
    let lot = tx.query_row(sql, [all.lot], read).optional().doing(DOING)?;
    let Some(lot) = lot else {
        return wrong("lot", all.lot, "a lot that was run".to_owned());
    };
    if let Some(meant) = all.recipe.filter(|it| *it != lot.recipe) {
        let expected = format!("{:?}, with which lot {:?} was run", lot.recipe, all.lot);
        return wrong("recipe", meant, expected);
    }
    if lot.demands.limits.is_empty() {
        let expected = "a lot whose recipe has [external]".to_owned();
        return wrong("recipe", &lot.recipe, expected);
    }
    Ok(Ok(lot))
}

fn enter(tx: &Transaction<'_>, all: &EnteredResults<'_>, lot: &Lot) -> Result<Checked<Entered>> {
    let before = "SELECT count(*) FROM external_result WHERE lot_id = ?1 AND file_hash = ?2";
    let before: i64 = tx
        .query_row(before, params![lot.id, all.file_hash], |row| row.get(0))
        .doing(DOING)?;
    if before > 0 {
        let (lot, results) = (all.lot.to_owned(), before.unsigned_abs());
        return Ok(Err(ResultRefusal::Again { lot, results }));
    }
    let (mut entered, mut seen) = (Entered::default(), HashSet::new());
    for result in all.results {
        match one(tx, all, (lot, result), &mut seen)? {
            Ok(ExternalVerdict::Pass) => entered.pass += 1,
            Ok(ExternalVerdict::Fail) => entered.fail += 1,
            Ok(ExternalVerdict::Undecided) => entered.undecided += 1,
            Err(refused) => return Ok(Err(refused)),
        }
    }
    Ok(Ok(entered))
}

/// Enters one result; `seen` has the samples and quantities of those before.
fn one(
    tx: &Transaction<'_>,
    all: &EnteredResults<'_>,
    (lot, result): (&Lot, &NewResult),
    seen: &mut HashSet<(Named, External)>,
) -> Result<Checked<ExternalVerdict>> {
    let limit = match check(all, lot, result) {
        Ok(limit) => limit,
        Err(refused) => return Ok(Err(refused)),
    };
    let sample = match found(tx, lot, result)? {
        Ok(sample) => sample,
        Err(refused) => return Ok(Err(refused)),
    };
    // Otherwise a good line could hide a bad one of the same file.
    if !seen.insert((sample.clone(), result.key)) {
        let expected = "each quantity of a sample once in a file";
        let refused = ResultRefusal::wrong(result.line, "key", result.key, expected);
        return Ok(Err(refused));
    }
    let verdict = lot.demands.judge(result.value, result.u, &limit);
    insert(tx, all, (lot, result), (sample, limit, verdict))?;
    Ok(Ok(verdict))
}

/// Checks key, value, uncertainty and time; returns the limit.
fn check(all: &EnteredResults<'_>, lot: &Lot, it: &NewResult) -> Checked<Limit> {
    let wrong = |column, found: String, expected: String| {
        Err(ResultRefusal::wrong(it.line, column, found, expected))
    };
    let Some(limit) = lot.demands.limits.of(it.key) else {
        let demanded: Vec<&str> = lot.demands.limits.demanded().map(External::key).collect();
        let expected = format!(
            "a key of [external] of {}: {}",
            lot.recipe,
            one_of(&demanded)
        );
        return wrong("key", it.key.to_string(), expected);
    };
    if !it.key.range().holds(it.value) {
        return wrong("value", it.value.to_string(), it.key.range().expected());
    }
    match it.u {
        Some(u) if !(u.is_finite() && u > 0.0) => {
            let expected = format!("an expanded uncertainty (k = 2) of {} above 0", limit.unit);
            return wrong("u", u.to_string(), expected);
        }
        None if lot.demands.rule() == Rule::GuardBand => {
            let expected = "an expanded uncertainty (k = 2), which rule \"guard_band\" needs";
            return wrong("u", String::new(), expected.to_owned());
        }
        Some(_) | None => {}
    }
    match it.measured_at.filter(|at| *at > all.at) {
        Some(at) => wrong(
            "at",
            at.to_string(),
            format!("at the latest now, {}", all.at),
        ),
        None => Ok(limit),
    }
}

/// Serial number, run and number of a sample.
type Named = (Option<String>, Option<u32>, Option<u64>);

/// Finds the sample among the parts of the lot; a part with a serial number is named by this number.
fn found(tx: &Transaction<'_>, lot: &Lot, it: &NewResult) -> Result<Checked<Named>> {
    let wrong = |column, found: String, expected: String| {
        Ok(Err(ResultRefusal::wrong(it.line, column, found, expected)))
    };
    let parts = |condition: &str, value: &dyn rusqlite::ToSql| {
        let sql = format!(
            "SELECT DISTINCT run.number, part.serial FROM part JOIN run ON run.id = part.run_id
             WHERE run.lot_id = ?1 AND part.kind = 'lot' AND {condition} ORDER BY run.number"
        );
        let read = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
        let mut find = tx.prepare_cached(&sql).doing(DOING)?;
        let found = find.query_map(params![lot.id, value], read);
        let found: rusqlite::Result<Vec<(u32, Option<String>)>> = found.and_then(Iterator::collect);
        found.doing(DOING)
    };
    match &it.sample {
        Sample::Lot => Ok(Ok((None, None, None))),
        Sample::Serial(serial) => {
            let known = parts("part.serial = ?2", serial)?;
            match known.is_empty() {
                true => wrong(
                    "serial",
                    serial.clone(),
                    "the serial number of a part of the lot".to_owned(),
                ),
                false => Ok(Ok((Some(serial.clone()), None, None))),
            }
        }
        Sample::Part { run, seq } => {
            let number = signed("the number of a part", *seq)?;
            let mut known = parts("part.seq = ?2", &number)?;
            known.retain(|(number, _)| run.is_none_or(|run| run == *number));
            match known.as_slice() {
                [] => wrong(
                    "seq",
                    seq.to_string(),
                    "the number of a part of the lot".to_owned(),
                ),
                [(_, Some(serial))] => Ok(Ok((Some(serial.clone()), None, None))),
                [(run, None)] => Ok(Ok((None, Some(*run), Some(*seq)))),
                many => {
                    let runs: Vec<String> = many.iter().map(|(run, _)| run.to_string()).collect();
                    let expected = format!("one of the runs with part {seq}: {}", runs.join(", "));
                    wrong("run", String::new(), expected)
                }
            }
        }
    }
}

fn insert(
    tx: &Transaction<'_>,
    all: &EnteredResults<'_>,
    (lot, it): (&Lot, &NewResult),
    ((serial, run, seq), limit, verdict): (Named, Limit, ExternalVerdict),
) -> Result<()> {
    assert_eq!(
        all.file_hash.is_some(),
        it.line.is_some(),
        "a line of no file"
    );
    assert!(!all.who.trim().is_empty(), "a result by nobody");
    let written = tx.execute(
        "INSERT INTO external_result (lot_id, serial, run, seq, key, value, uncertainty, low, high, verdict, recipe_hash,
           who, measured_at_us, entered_at_us, file_hash, line)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)",
        params![
            lot.id,
            serial,
            run,
            seq.map(|it| signed("the number of a part", it)).transpose()?,
            it.key.key(),
            it.value,
            it.u,
            limit.low,
            limit.high,
            verdict.name(),
            lot.hash,
            all.who.trim(),
            it.measured_at.unwrap_or(all.at).0,
            all.at.0,
            all.file_hash,
            it.line.map(|it| i64::try_from(it).unwrap_or(i64::MAX)),
        ],
    );
    written.map(drop).doing(DOING)
}
