//! What another recipe would have said of the parts of a lot. The history stays as it is.

use super::{InquiryError, Result, checks};
use crate::{Archive, Filter, Part, rejudged};
use machine::dut::rejudge::{Basis, Misfit};
use machine::dut::{Reason, Recipe};
use serde::Serialize;
use std::collections::BTreeMap;

/// A part, judged again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RejudgedPart {
    /// Always `part`.
    #[serde(rename = "type")]
    pub tag: &'static str,
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// Count of parts that entered the nest.
    pub seq: u64,
    /// Name of the recipe judged by.
    pub recipe: String,
    /// The verdict that stands.
    pub verdict_was: String,
    /// The one by this recipe.
    pub verdict: &'static str,
    /// The bin it asks for.
    pub bin: String,
    /// Why it is not a pass.
    pub reasons: Vec<String>,
    /// Their codes, in the same order.
    pub reason_codes: Vec<Reason>,
}

impl RejudgedPart {
    /// Whether the verdicts differ.
    pub fn changes(&self) -> bool {
        self.verdict != self.verdict_was
    }
}

/// All parts together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Changes {
    /// Always `summary`.
    #[serde(rename = "type")]
    pub tag: &'static str,
    /// Name of the recipe judged by.
    pub recipe: String,
    /// SHA-256 of its text.
    pub recipe_hash: String,
    /// How many went from which verdict to which.
    pub changes: Vec<Change>,
}

/// Parts with the same two verdicts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// The verdict that stands.
    pub was: String,
    /// The one by the other recipe.
    pub now: &'static str,
    /// How many.
    pub parts: u64,
}

/// A question that can be answered: its lot is there, and the recipe fits what was measured.
#[derive(Debug)]
pub struct Rejudging {
    recipe: Recipe,
    filter: Filter,
    /// What the values of each run refer to; an import without a recipe is taken to refer to the same.
    bases: BTreeMap<u32, Basis>,
}

impl Rejudging {
    /// The parts of `lot`, or only those of one `run`, held against `recipe`.
    ///
    /// # Errors
    /// A lot or run that never was; one that holds another kind of part, or was measured at another nominal voltage.
    pub fn of(archive: &Archive, lot: String, run: Option<u32>, recipe: Recipe) -> Result<Self> {
        let filter = Filter {
            lot: Some(lot),
            run,
            ..Filter::default()
        };
        checks::known_runs(archive, &filter)?;
        let mut bases = BTreeMap::new();
        for run in archive.lots(&filter)? {
            let text = archive.recipe(&run.recipe_hash)?;
            let Some(basis) = text.as_deref().and_then(Basis::of) else {
                continue;
            };
            if let Some(Misfit { wanted, found }) = basis.misfit(&recipe) {
                let reason = format!("{wanted}, run {} of lot {:?} {found}", run.run, run.lot);
                return Err(InquiryError::member("recipe", reason));
            }
            bases.insert(run.run, basis);
        }
        Ok(Self {
            recipe,
            filter,
            bases,
        })
    }

    /// Hands every part to `each`, in order of judgement, and sums up. Ends early when `each` fails, with its error.
    ///
    /// # Errors
    /// Of the history.
    pub fn each<E>(
        &self,
        archive: &Archive,
        mut each: impl FnMut(RejudgedPart) -> std::result::Result<(), E>,
    ) -> Result<std::result::Result<Changes, E>>
    where
        E: From<InquiryError>,
    {
        let mut counts: BTreeMap<(String, &'static str), u64> = BTreeMap::new();
        let end = archive.each(&self.filter, |part| {
            let again = self.again(archive, part)?;
            *counts
                .entry((again.verdict_was.clone(), again.verdict))
                .or_default() += 1;
            each(again)
        })?;
        let change = |((was, now), parts)| Change { was, now, parts };
        Ok(end.map(|()| Changes {
            tag: "summary",
            recipe: self.recipe.name.clone(),
            recipe_hash: self.recipe.hash.clone(),
            changes: counts.into_iter().map(change).collect(),
        }))
    }

    fn again(&self, archive: &Archive, part: Part) -> Result<RejudgedPart> {
        let basis = self.bases.get(&part.run).copied();
        let basis = basis.unwrap_or_else(|| Basis::of_recipe(&self.recipe));
        let curves = archive.curves(&part)?;
        let verdict = rejudged(&part, &curves, basis, &self.recipe);
        Ok(RejudgedPart {
            tag: "part",
            lot: part.lot,
            run: part.run,
            seq: part.seq,
            recipe: self.recipe.name.clone(),
            verdict: verdict.name(),
            bin: verdict.bin().to_string(),
            reasons: verdict.texts(),
            reason_codes: verdict.reasons().to_vec(),
            verdict_was: part.verdict,
        })
    }
}
