//! A query string in two: the filter of the history, and what only one route knows.

use super::super::error::HmiError;
use axum::extract::Query;
use axum::http::Uri;
use history::Filter;
use history::report::Lang;
use quality::rules::Rules;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// Points of a control chart that are told when nobody says how many.
const SHOWN: usize = 200;
/// The most that may be asked for.
const MOST_SHOWN: usize = 10_000;

/// What a route takes beside the filter.
pub(super) trait Own: DeserializeOwned {
    /// Its members in the query string.
    const MEMBERS: &'static [&'static str];
}

/// Of a control chart.
#[derive(Debug, Deserialize)]
pub(super) struct Charting {
    /// Parts of a subgroup, 1 to 10; 1 when absent.
    pub subgroup: Option<u8>,
    /// `nelson` (when absent) or `western-electric`.
    pub rules: Option<Rules>,
    /// Only the last so many points; [`SHOWN`] when absent.
    last: Option<usize>,
    /// Of the page only: `zh` (when absent) or `en`.
    pub lang: Option<Lang>,
}

impl Own for Charting {
    const MEMBERS: &'static [&'static str] = &["subgroup", "rules", "last", "lang"];
}

impl Charting {
    /// How many points are told.
    pub fn last(&self) -> Result<usize, HmiError> {
        match self.last.unwrap_or(SHOWN) {
            last @ 1..=MOST_SHOWN => Ok(last),
            last => Err(HmiError::Query {
                reason: format!("last: found {last}, expected 1 to {MOST_SHOWN}"),
            }),
        }
    }
}

/// Of a page.
#[derive(Debug, Deserialize)]
pub(super) struct Printed {
    /// `zh` (when absent) or `en`.
    pub lang: Option<Lang>,
    /// Of a certificate: the part.
    pub seq: Option<u64>,
    /// Of a lot report: the shortest cycle the line can keep, s.
    pub ideal_cycle_s: Option<f64>,
}

impl Own for Printed {
    const MEMBERS: &'static [&'static str] = &["lang", "seq", "ideal_cycle_s"];
}

/// Of the audit of orders.
#[derive(Debug, Deserialize)]
pub(super) struct Audited {
    /// Orders of this person only.
    pub who: Option<String>,
}

impl Own for Audited {
    const MEMBERS: &'static [&'static str] = &["who"];
}

/// Lang of what is printed when nobody names one.
pub(super) fn language(asked: Option<Lang>) -> Lang {
    asked.unwrap_or(Lang::Zh)
}

/// The filter, and what is the route's own.
pub(super) fn asked<T: Own>(uri: &Uri) -> Result<(Filter, T), HmiError> {
    let own = |pair: &&str| {
        let name = pair.split('=').next().unwrap_or_default();
        T::MEMBERS.contains(&name)
    };
    let pairs = uri.query().unwrap_or_default().split('&');
    let (own, filter): (Vec<&str>, Vec<&str>) = pairs.partition(own);
    Ok((parsed(&filter)?, parsed(&own)?))
}

fn parsed<T: DeserializeOwned>(pairs: &[&str]) -> Result<T, HmiError> {
    let uri = format!("/?{}", pairs.join("&"));
    let uri: Uri = uri.parse().map_err(|_| HmiError::Query {
        reason: "found a query string that is none".to_owned(),
    })?;
    let Query(parsed) = Query::try_from_uri(&uri)?;
    Ok(parsed)
}
