//! Lots side by side: figures of one parameter, tests of equality, and shares in common classes.

use super::figures::{agreed, without_value};
use super::{InquiryError, Result, checks};
use crate::{Archive, Filter};
use quality::equality::{Equality, means, spreads};
use quality::ordered::Histogram;
use quality::{Limits, Ordered, Summary};
use serde::Serialize;
use utoipa::ToSchema;

/// Approximate number of classes.
const CLASSES: usize = 24;

/// Number of lots that can be compared.
pub const LOTS: std::ops::RangeInclusive<usize> = 2..=8;

/// One lot of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ComparedLot {
    /// Name of the lot.
    pub lot: String,
    /// Limits that all runs of the lot share; absent when limits differ.
    #[serde(flatten)]
    pub limits: Limits,
    /// Mean, spread and capability.
    #[serde(flatten)]
    pub summary: Summary,
    /// Share of the values in each class of the comparison, 0 to 1.
    pub shares: Vec<f64>,
}

/// Lots side by side.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Comparison {
    /// Parameter key.
    pub param: String,
    /// The lots in the order of the request.
    pub lots: Vec<ComparedLot>,
    /// Test whether the means are equal; `None` where a lot has no spread or fewer than two values.
    pub means: Option<Equality>,
    /// Test whether the spreads are equal; `None` where a lot has fewer than two values, or when all
    /// values of each lot lie equally far from its median.
    pub spreads: Option<Equality>,
    /// Lower edge of the first class; `None` when all values are equal.
    pub from: Option<f64>,
    /// Width of every class; `None` when all values are equal.
    pub width: Option<f64>,
}

/// Compares the values of `param` in the lots.
pub fn compare(archive: &Archive, param: &str, lots: &[String]) -> Result<Comparison> {
    if !LOTS.contains(&lots.len()) {
        let reason = format!("found {}, expected 2 to 8 lots", lots.len());
        return Err(InquiryError::member("lots", reason));
    }
    if let Some(twice) = (1..lots.len()).find(|at| lots[..*at].contains(&lots[*at])) {
        let reason = format!("found {:?} twice, expected different lots", lots[twice]);
        return Err(InquiryError::member("lots", reason));
    }
    checks::parameters(archive, Some(param))?;
    let of_lot = |lot: &String| {
        let filter = Filter {
            lot: Some(lot.clone()),
            ..Filter::default()
        };
        if !archive.has_runs(&filter)? {
            return Err(InquiryError::missing(format!("no lot {lot:?}")));
        }
        let found = archive.values(param, &filter)?;
        let without = without_value(archive, &filter, found.values.len() as u64)?;
        Ok((found, without))
    };
    let found = lots.iter().map(of_lot).collect::<Result<Vec<_>>>()?;
    let groups: Vec<&[f64]> = found.iter().map(|it| it.0.values.as_slice()).collect();
    let all = Ordered::of(&groups.concat()).histogram(CLASSES);
    let compared = lots.iter().zip(&found).map(|(lot, (found, without))| {
        let limits = agreed(found.limits);
        ComparedLot {
            lot: lot.clone(),
            limits,
            summary: Summary {
                without_value: *without,
                ..Summary::of(param, &found.values, limits)
            },
            shares: shares(all.as_ref(), &found.values),
        }
    });
    Ok(Comparison {
        param: param.to_owned(),
        lots: compared.collect(),
        means: means(&groups),
        spreads: spreads(&groups),
        from: all.as_ref().map(|it| it.from),
        width: all.as_ref().map(|it| it.width),
    })
}

/// Returns the share of the values in each class.
fn shares(classes: Option<&Histogram>, values: &[f64]) -> Vec<f64> {
    let Some(classes) = classes else {
        return Vec::new();
    };
    let mut shares = vec![0.0; classes.counts.len()];
    for value in values {
        shares[classes.class(*value)] += 1.0 / values.len() as f64;
    }
    shares
}
