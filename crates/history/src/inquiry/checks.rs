//! Checks the members of a filter: a misspelt value gives an error that names the member instead of an empty result.

use super::{InquiryError, Result};
use crate::{Archive, Filter, LotSummary};

/// Values of the member `verdict`.
pub const VERDICTS: [&str; 4] = ["pass", "fail", "void", "unjudged"];
/// Values of the member `kind`.
pub const KINDS: [&str; 3] = ["lot", "golden", "all"];

/// Fails on an unknown word or an empty range.
pub fn validate(filter: &Filter) -> Result<()> {
    one_of("verdict", filter.verdict.as_deref(), &VERDICTS)?;
    one_of("kind", filter.kind.as_deref(), &KINDS)?;
    for (field, value) in [("min", filter.min), ("max", filter.max)] {
        if let Some(value) = value.filter(|it| !it.is_finite()) {
            let reason = format!("found {value}, expected a finite number");
            return Err(InquiryError::member(field, reason));
        }
        if value.is_some() && filter.param.is_none() {
            return Err(InquiryError::member(field, "needs param"));
        }
    }
    match (filter.min, filter.max) {
        (Some(min), Some(max)) if min > max => Err(InquiryError::member(
            "min",
            format!("{min} is above max {max}"),
        )),
        _ => Ok(()),
    }
}

/// Fails on a word that is not among `known`; the message shows its first 40 characters.
pub fn one_of(field: &'static str, found: Option<&str>, known: &[&str]) -> Result<()> {
    match found {
        Some(found) if !known.contains(&found) => {
            let found: String = found.chars().take(40).collect();
            let reason = format!("found {found:?}, expected one of {}", known.join(", "));
            Err(InquiryError::member(field, reason))
        }
        Some(_) | None => Ok(()),
    }
}

/// Fails on a parameter that the history does not have. Returns all keys in the order of columns.
pub fn parameters(archive: &Archive, asked: Option<&str>) -> Result<Vec<String>> {
    let known = archive.parameters()?;
    let names: Vec<&str> = known.iter().map(String::as_str).collect();
    one_of("param", asked, &names)?;
    Ok(known)
}

/// Fails when the runs come from several rigs, because a lot belongs to one rig; only a server has several.
pub fn one_rig(runs: &[LotSummary]) -> Result<()> {
    let first = runs.first().and_then(|it| it.rig.as_ref());
    let other = runs
        .iter()
        .filter_map(|it| it.rig.as_ref())
        .find(|it| Some(*it) != first);
    match (first, other) {
        (Some(first), Some(other)) => {
            let reason = format!("runs of {first} and of {other} have this lot; choose one rig");
            Err(InquiryError::member("rig", reason))
        }
        _ => Ok(()),
    }
}

/// Fails when no run has the filter's lot, run and recipe.
pub fn known_runs(archive: &Archive, filter: &Filter) -> Result<()> {
    let named = filter.lot.is_some() || filter.recipe.is_some() || filter.run.is_some();
    if named && !archive.has_runs(filter)? {
        let what = "no run has this lot, run and recipe; `history list` shows those there are";
        return Err(InquiryError::missing(what));
    }
    Ok(())
}
