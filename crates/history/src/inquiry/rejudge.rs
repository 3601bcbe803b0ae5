//! Judges the parts of a lot by another recipe; writes no row.

use super::{InquiryError, Result, checks};
use crate::{Archive, Filter, Part, rejudged};
use machine::dut::rejudge::{Basis, Misfit};
use machine::dut::{Reason, Recipe};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// A part, judged again.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct RejudgedPart {
    /// Always `part`.
    #[serde(rename = "type")]
    pub tag: &'static str,
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// Number of the part: it was the `seq`-th of its kind to enter the nest in this run.
    pub seq: u64,
    /// Name of the other recipe.
    pub recipe: String,
    /// Verdict that the run gave.
    pub verdict_was: String,
    /// Verdict by the other recipe.
    pub verdict: &'static str,
    /// Bin that the new verdict assigns.
    pub bin: String,
    /// Reasons why the part does not pass by the other recipe, as texts.
    pub reasons: Vec<String>,
    /// Reasons why the part does not pass by the other recipe, as codes.
    pub reason_codes: Vec<Reason>,
}

impl RejudgedPart {
    /// Returns true when old and new verdict differ.
    pub fn changes(&self) -> bool {
        self.verdict != self.verdict_was
    }
}

/// Number of parts by old and new verdict, with the other recipe.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Changes {
    /// Always `summary`.
    #[serde(rename = "type")]
    pub tag: &'static str,
    /// Name of the other recipe.
    pub recipe: String,
    /// SHA-256 of the text of the other recipe.
    pub recipe_hash: String,
    /// Number of parts for each pair of old and new verdict.
    pub changes: Vec<Change>,
}

/// Number of parts with one pair of old and new verdict.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = VerdictChange)]
pub struct Change {
    /// Verdict that the run gave.
    pub was: String,
    /// Verdict by the other recipe.
    pub now: &'static str,
    /// Number of parts.
    pub parts: u64,
}

/// A lot to be judged again, and a recipe that fits what was measured on its parts.
#[derive(Debug)]
pub struct Rejudging {
    recipe: Recipe,
    filter: Filter,
    /// Data of the recipe by which the parts of a run were measured, by number of the run; for an import without a
    /// recipe, data of `recipe`.
    bases: BTreeMap<u32, Basis>,
}

impl Rejudging {
    /// Selects the parts of `lot`, or those of one `run`, to be judged by `recipe`.
    ///
    /// # Errors
    /// Fails when the lot or run does not exist, holds another kind of part, or was measured at another nominal
    /// voltage.
    pub fn of(archive: &Archive, lot: String, run: Option<u32>, recipe: Recipe) -> Result<Self> {
        let filter = Filter {
            lot: Some(lot),
            run,
            ..Filter::default()
        };
        checks::known_runs(archive, &filter)?;
        let mut bases = BTreeMap::new();
        let runs = archive.lots(&filter)?;
        checks::one_rig(&runs)?;
        for run in runs {
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

    /// Calls `each` for every part in order of judgement and returns the summary. Stops at the first error of `each`
    /// and returns it.
    ///
    /// # Errors
    /// Fails when the history cannot be read.
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
