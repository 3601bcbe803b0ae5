//! Figures of one parameter over the parts that a filter leaves.

use super::{Result, checks};
use crate::{Archive, Filter, LimitsSeen};
use quality::ordered::Histogram;
use quality::{Limits, Ordered, Summary};
use serde::Serialize;

/// Classes of a histogram, about.
const CLASSES: usize = 30;

/// The figures, and whether a capability could be told.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// Moments and capability.
    pub summary: Summary,
    /// The runs were judged by different limits: no capability over all of them.
    pub limits_differ: bool,
}

/// Figures of `param`, by the limits of its runs unless others are given.
pub fn figures(
    archive: &Archive,
    param: &str,
    filter: &Filter,
    limits: Option<Limits>,
) -> Result<Figures> {
    checks::parameters(archive, Some(param))?;
    checks::known_runs(archive, filter)?;
    let found = archive.values(param, filter)?;
    let differ = limits.is_none() && found.limits == LimitsSeen::Differ;
    let limits = limits.unwrap_or_else(|| agreed(found.limits));
    Ok(Figures {
        summary: Summary::of(param, &found.values, limits),
        limits_differ: differ,
    })
}

/// A histogram with the limits beside it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Classes {
    /// Classes of equal width; absent without spread.
    #[serde(flatten)]
    pub histogram: Option<Histogram>,
    /// Limits that all runs agree on.
    #[serde(flatten)]
    pub limits: Limits,
}

/// How the values of `param` are spread, in some thirty classes on round numbers.
pub fn histogram(archive: &Archive, param: &str, filter: &Filter) -> Result<Classes> {
    checks::parameters(archive, Some(param))?;
    checks::known_runs(archive, filter)?;
    let found = archive.values(param, filter)?;
    Ok(Classes {
        histogram: Ordered::of(&found.values).histogram(CLASSES),
        limits: agreed(found.limits),
    })
}

/// The limits that all runs agree on; none when they differ, for then a capability means nothing.
pub(super) fn agreed(seen: LimitsSeen) -> Limits {
    match seen {
        LimitsSeen::Same { low, high } => Limits { low, high },
        LimitsSeen::None | LimitsSeen::Differ => Limits::default(),
    }
}
