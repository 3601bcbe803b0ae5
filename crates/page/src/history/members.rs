//! Splits a query string into the filter of the history and the members of one route.

use super::super::error::ApiError;
use axum::extract::Query;
use axum::http::Uri;
use history::Filter;
use history::report::Lang;
use quality::rules::Rules;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// Default of `last`, the number of points of a control chart.
const SHOWN: usize = 200;
/// Greatest `last`.
const MOST_SHOWN: usize = 10_000;

/// Members that a route takes besides the filter.
pub(super) trait RouteMembers: DeserializeOwned {
    /// Names of the members.
    const MEMBERS: &'static [&'static str];
}

/// Members of a control chart.
#[derive(Debug, Deserialize)]
pub(super) struct ChartMembers {
    /// Parts in a subgroup, 1 to 10; 1 when absent.
    pub subgroup: Option<u8>,
    /// `nelson` (when absent) or `western-electric`.
    pub rules: Option<Rules>,
    /// Number of points, counted from the last; [`SHOWN`] when absent.
    last: Option<usize>,
    /// Language of a printed chart: `zh` (when absent) or `en`.
    pub lang: Option<Lang>,
}

impl RouteMembers for ChartMembers {
    const MEMBERS: &'static [&'static str] = &["subgroup", "rules", "last", "lang"];
}

impl ChartMembers {
    /// Returns the number of points to send. Fails when it is not from 1 to [`MOST_SHOWN`].
    pub fn last(&self) -> Result<usize, ApiError> {
        ApiError::ranged("last", self.last, SHOWN, MOST_SHOWN)
    }
}

/// Members of a printed report.
#[derive(Debug, Deserialize)]
pub(super) struct ReportMembers {
    /// `zh` (when absent) or `en`.
    pub lang: Option<Lang>,
    /// Number of the part that the certificate is for; only `report/certificate` takes it.
    pub seq: Option<u64>,
    /// Shortest possible cycle of the line, s, for the OEE; only `report/lot` takes it.
    pub ideal_cycle_s: Option<f64>,
}

impl RouteMembers for ReportMembers {
    const MEMBERS: &'static [&'static str] = &["lang", "seq", "ideal_cycle_s"];
}

/// Members of `orders`, the audit of orders.
#[derive(Debug, Deserialize)]
pub(super) struct AuditMembers {
    /// Name of the person whose orders to list; all when absent.
    pub who: Option<String>,
}

impl RouteMembers for AuditMembers {
    const MEMBERS: &'static [&'static str] = &["who"];
}

/// Returns the language of a printed report, Chinese by default.
pub(crate) fn language(asked: Option<Lang>) -> Lang {
    asked.unwrap_or(Lang::Zh)
}

/// Returns the filter and the members of the route. Fails on an unknown or malformed member.
pub(super) fn split<T: RouteMembers>(uri: &Uri) -> Result<(Filter, T), ApiError> {
    let own = |pair: &&str| {
        let name = pair.split('=').next().unwrap_or_default();
        T::MEMBERS.contains(&name)
    };
    let pairs = uri.query().unwrap_or_default().split('&');
    let (own, filter): (Vec<&str>, Vec<&str>) = pairs.partition(own);
    Ok((parsed(&filter)?, parsed(&own)?))
}

fn parsed<T: DeserializeOwned>(pairs: &[&str]) -> Result<T, ApiError> {
    let uri = format!("/?{}", pairs.join("&"));
    let uri: Uri = uri.parse().map_err(|_| ApiError::Query {
        reason: "found a malformed query string".to_owned(),
    })?;
    let Query(parsed) = Query::try_from_uri(&uri)?;
    Ok(parsed)
}
