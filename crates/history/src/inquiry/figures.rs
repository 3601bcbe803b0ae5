//! Statistics of one parameter over the selected parts.

use super::{Result, checks};
use crate::{Archive, Filter, LimitsSeen};
use quality::ordered::Histogram;
use quality::{Limits, Ordered, Summary};
use serde::Serialize;

/// Approximate number of classes of a histogram.
const CLASSES: usize = 30;

/// Statistics of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// Moments and capability.
    pub summary: Summary,
    /// True when the runs have different limits, so that there is no capability.
    pub limits_differ: bool,
}

/// Computes the statistics of `param`, by the limits of its runs unless others are given.
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

/// A histogram with limits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Classes {
    /// Classes of equal width; `None` without spread.
    #[serde(flatten)]
    pub histogram: Option<Histogram>,
    /// Limits, when all runs have the same.
    #[serde(flatten)]
    pub limits: Limits,
}

/// Computes a histogram of `param` in about thirty classes at round numbers.
pub fn histogram(archive: &Archive, param: &str, filter: &Filter) -> Result<Classes> {
    checks::parameters(archive, Some(param))?;
    checks::known_runs(archive, filter)?;
    let found = archive.values(param, filter)?;
    Ok(Classes {
        histogram: Ordered::of(&found.values).histogram(CLASSES),
        limits: agreed(found.limits),
    })
}

/// Returns the limits that all runs share; none when they differ, since a capability then has no meaning.
pub(super) fn agreed(seen: LimitsSeen) -> Limits {
    match seen {
        LimitsSeen::Same { low, high } => Limits { low, high },
        LimitsSeen::None | LimitsSeen::Differ => Limits::default(),
    }
}
