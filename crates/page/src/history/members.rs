//! Parts of the query strings of the history, and the filter made of them.

use super::super::error::ApiError;
use crate::asked::members;
use history::inquiry::checks::{KINDS, VERDICTS};
use history::report::Lang;
use history::{Filter, Moment};
use machine::dut::Characteristic;
use quality::rules::Rules;
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa::openapi::schema::Type;
use utoipa::openapi::{Object, ObjectBuilder};

/// Default of `last`, the number of points of a control chart.
const SHOWN: u64 = 200;
/// Greatest `last`.
const MOST_SHOWN: u64 = 10_000;

/// Runs of lots.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct Runs {
    /// Name of the lot.
    #[param(example = "L-1122")]
    lot: Option<String>,
    /// Number of the run within its lot.
    #[param(example = 1)]
    run: Option<u32>,
    /// Name of the recipe.
    #[param(example = "jzc-22f-012")]
    recipe: Option<String>,
}

/// Runs of one lot.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct OneLot {
    /// Name of the lot.
    #[param(example = "L-1122")]
    lot: String,
    /// Number of the run within its lot; all runs when absent.
    #[param(example = 1)]
    run: Option<u32>,
    /// Name of the recipe.
    #[param(example = "jzc-22f-012")]
    recipe: Option<String>,
}

/// A span of time.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct TimeSpan {
    /// Earliest time: RFC 3339, or local as `2026-11-22`, `today`, `-8h`.
    #[param(value_type = Option<String>, example = "2026-11-22T00:00:00Z")]
    pub since: Option<Moment>,
    /// Only entries before this time; same forms as `since`.
    #[param(value_type = Option<String>, example = "2026-11-23T00:00:00Z")]
    pub until: Option<Moment>,
}

/// Section of a long answer.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct Paging {
    /// Largest number of entries in the answer.
    #[param(example = 100)]
    limit: Option<u64>,
    /// Number of entries to skip.
    #[param(example = 0)]
    offset: Option<u64>,
}

/// Properties of parts.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct OfParts {
    /// Verdict.
    #[param(schema_with = verdicts)]
    verdict: Option<String>,
    /// Bin that the verdict assigns.
    #[param(example = "pass")]
    bin: Option<String>,
    /// Serial number.
    #[param(example = "L-1122-000017")]
    serial: Option<String>,
    /// `lot` (when absent), `golden` for reference parts, `all`.
    #[param(schema_with = kinds)]
    kind: Option<String>,
    /// True: only suspect parts, judged between a failed reference check and the reference check before it.
    #[param(example = false)]
    suspect: Option<bool>,
}

/// Parts with a value in a range.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct ValueRange {
    /// Parameter key with its unit, as in an export.
    #[param(example = some_parameter)]
    param: Option<String>,
    /// Least value of `param`.
    #[param(example = 1.0)]
    min: Option<f64>,
    /// Largest value of `param`.
    #[param(example = 20.0)]
    max: Option<f64>,
}

/// One parameter.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct OneParameter {
    /// Parameter key with its unit, as in an export.
    #[param(example = some_parameter)]
    pub param: String,
}

/// A control chart.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct Charting {
    /// Parameter key with its unit; when absent, the answer charts the share of each bin.
    #[param(example = some_parameter)]
    pub param: Option<String>,
    /// Parts of a subgroup, 1 to 10; 1 when absent.
    #[param(minimum = 1, maximum = 10, example = 1)]
    pub subgroup: Option<u8>,
    /// `nelson` (when absent) or `western-electric`.
    #[param(inline)]
    pub rules: Option<Rules>,
    /// Number of points in the answer, the last ones of the chart, 1 to 10,000; 200 when absent.
    #[param(minimum = 1, maximum = 10000, example = 100)]
    last: Option<u64>,
}

/// A printed page or a spreadsheet.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct Printed {
    /// Language, `zh` or `en`; when absent, the language of `Accept-Language`, else English.
    #[param(inline)]
    pub lang: Option<Lang>,
}

members!(
    Runs,
    OneLot,
    TimeSpan,
    Paging,
    OfParts,
    ValueRange,
    OneParameter,
    Charting,
    Printed
);

fn words(words: &[&'static str], about: &str) -> Object {
    ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some(words.iter().copied()))
        .description(Some(about))
        .build()
}

/// Returns the key of some parameter, for the examples of the OpenAPI document.
fn some_parameter() -> &'static str {
    Characteristic::all().next().map_or("", Characteristic::key)
}

fn verdicts() -> Object {
    words(&VERDICTS, "Verdict.")
}

fn kinds() -> Object {
    words(
        &KINDS,
        "`lot` (without it), `golden` for reference parts, `all`.",
    )
}

/// Part of a query string that restricts the filter.
pub(crate) trait Selects {
    fn select(self, filter: &mut Filter);
}

/// Returns the filter with the restrictions of all `parts`.
pub(crate) fn filter(parts: impl Selects) -> Filter {
    let mut filter = Filter::default();
    parts.select(&mut filter);
    filter
}

impl Selects for Runs {
    fn select(self, filter: &mut Filter) {
        (filter.lot, filter.run, filter.recipe) = (self.lot, self.run, self.recipe);
    }
}

impl Selects for OneLot {
    fn select(self, filter: &mut Filter) {
        (filter.lot, filter.run, filter.recipe) = (Some(self.lot), self.run, self.recipe);
    }
}

impl Selects for TimeSpan {
    fn select(self, filter: &mut Filter) {
        (filter.since, filter.until) = (self.since, self.until);
    }
}

impl Selects for Paging {
    fn select(self, filter: &mut Filter) {
        (filter.limit, filter.offset) = (self.limit, self.offset);
    }
}

impl Selects for OfParts {
    fn select(self, filter: &mut Filter) {
        (filter.verdict, filter.bin, filter.kind) = (self.verdict, self.bin, self.kind);
        filter.serial = self.serial;
        filter.suspect = self.suspect.unwrap_or(false);
    }
}

impl Selects for ValueRange {
    fn select(self, filter: &mut Filter) {
        (filter.param, filter.min, filter.max) = (self.param, self.min, self.max);
    }
}

macro_rules! tuples {
    ($($($kind:ident)+;)+) => {$(
        #[expect(non_snake_case, reason = "a variable per type parameter")]
        impl<$($kind: Selects),+> Selects for ($($kind,)+) {
            fn select(self, filter: &mut Filter) {
                let ($($kind,)+) = self;
                $($kind.select(filter);)+
            }
        }
    )+};
}
tuples! { A B; A B C; A B C D; A B C D E; }

impl Charting {
    /// Returns the number of points to send. Fails when `last` is not from 1 to [`MOST_SHOWN`].
    pub fn last(&self) -> Result<usize, ApiError> {
        let last = ApiError::ranged("last", self.last, SHOWN, MOST_SHOWN)?;
        Ok(usize::try_from(last).unwrap_or(usize::MAX))
    }
}
