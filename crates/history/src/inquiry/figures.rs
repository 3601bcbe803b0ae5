//! Statistics of one parameter over the selected parts.

use super::{Result, checks};
use crate::{Archive, Filter, LimitsSeen};
use quality::ordered::Histogram;
use quality::{Limits, Ordered, Summary};
use serde::Serialize;
use utoipa::ToSchema;

/// Approximate number of classes of a histogram.
const CLASSES: usize = 30;

/// Statistics of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// Mean, spread and capability.
    pub summary: Summary,
    /// True when the runs have different limits; then capability is absent.
    pub limits_differ: bool,
}

/// Computes the statistics of `param`; uses the stored limits of the selected runs unless the caller gives others.
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
        summary: Summary {
            without_value: without_value(archive, filter, found.values.len() as u64)?,
            ..Summary::of(param, &found.values, limits)
        },
        limits_differ: differ,
    })
}

/// Counts the selected parts without a value, when `n` parts have one. Returns `None` when the filter names neither lot
/// nor recipe, because other recipes may measure other parameters, and when it has `min`, `max`, `limit` or `offset`.
pub(super) fn without_value(archive: &Archive, filter: &Filter, n: u64) -> Result<Option<u64>> {
    let by_value = filter.min.is_some() || filter.max.is_some();
    let paged = filter.limit.is_some() || filter.offset.is_some();
    if by_value || paged || (filter.lot.is_none() && filter.recipe.is_none()) {
        return Ok(None);
    }
    let tests = archive.count_parts(&Filter {
        param: None,
        ..filter.clone()
    })?;
    Ok(Some(tests.saturating_sub(n)))
}

/// Members of a [`Histogram`] that may be absent, for the schema of [`Classes`].
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes an optional histogram")]
struct SomeHistogram {
    /// Lower edge of the first class.
    #[schema(nullable = false)]
    from: Option<f64>,
    /// Width of every class: 1, 2 or 5 times a power of ten.
    #[schema(nullable = false)]
    width: Option<f64>,
    /// Number of values per class; a value on an edge belongs to the class above it.
    #[schema(nullable = false)]
    counts: Option<Vec<u64>>,
}

/// A histogram, with limits.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Classes {
    /// Classes of equal width; `None` when the values have no spread.
    #[serde(flatten)]
    #[schema(value_type = SomeHistogram)]
    pub histogram: Option<Histogram>,
    /// Limits that all runs share; absent when limits differ.
    #[serde(flatten)]
    pub limits: Limits,
}

/// Computes a histogram of `param` with about thirty classes, which begin at round numbers.
pub fn histogram(archive: &Archive, param: &str, filter: &Filter) -> Result<Classes> {
    checks::parameters(archive, Some(param))?;
    checks::known_runs(archive, filter)?;
    let found = archive.values(param, filter)?;
    Ok(Classes {
        histogram: Ordered::of(&found.values).histogram(CLASSES),
        limits: agreed(found.limits),
    })
}

/// Returns the limits that all runs share; none when they differ, because a capability would then have no meaning.
pub(super) fn agreed(seen: LimitsSeen) -> Limits {
    match seen {
        LimitsSeen::Same { low, high } => Limits { low, high },
        LimitsSeen::None | LimitsSeen::Differ => Limits::default(),
    }
}
