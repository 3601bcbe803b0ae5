//! Results that a plant measures outside of the rig: `GET /api/history/external` reads those of a lot, `POST
//! /api/lots/external` enters one that an engineer types in. The audit of orders records every attempt.

use super::access::{Role, audited};
use super::asked::{Asked, Author, Body, members};
use super::error::{ApiError, JsonResult, blocking};
use super::history::Readers;
use super::router::App;
use super::sessions::{now_us, require_role};
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use history::inquiry::{InquiryError, checks};
use history::{
    Archive, EnteredResults, ExternalResult, ExternalSample, ExternalStanding, Filter, Moment,
    NewResult, ResultRefusal, Store,
};
use machine::dut::External;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;
use texts::Message;
use utoipa::{IntoParams, ToSchema};

/// Results of a lot from outside of the rig.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct ResultsOfLot {
    /// Whether the lot is acceptable by them; null for a lot that has and needs none.
    standing: Option<ExternalStanding>,
    /// The results in order of entry.
    results: Vec<ExternalResult>,
}

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct LotQuery {
    /// Name of the lot.
    #[param(example = "L-1122")]
    lot: String,
}

members!(LotQuery);

/// `GET /api/history/external`.
pub(super) async fn results(
    readers: Readers,
    Asked(LotQuery { lot }): Asked<LotQuery>,
) -> JsonResult<ResultsOfLot> {
    let read = move |archive: &Archive| of_lot(archive, &lot).map(Json);
    readers.read(read).await
}

fn of_lot(archive: &Archive, lot: &str) -> Result<ResultsOfLot, ApiError> {
    let runs = Filter {
        lot: Some(lot.to_owned()),
        ..Filter::default()
    };
    checks::known_runs(archive, &runs)?;
    Ok(ResultsOfLot {
        standing: archive.external_standing(lot)?,
        results: archive.external_results(lot)?,
    })
}

/// A result that a person types in.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TypedResult {
    /// Name of the lot.
    #[schema(example = "L-1122")]
    lot: String,
    /// Serial number of the sample; without it and without `seq` the result is one of the lot.
    #[schema(example = "L-1122-000017")]
    serial: Option<String>,
    /// Run of a sample without serial number.
    #[schema(example = 1)]
    run: Option<u32>,
    /// Number of that sample in its run.
    #[schema(example = 17)]
    seq: Option<u64>,
    /// The quantity.
    key: External,
    /// Value in the unit of the key.
    #[schema(example = 4.2e10)]
    value: f64,
    /// Expanded uncertainty (k = 2) in the same unit; the rule `guard_band` needs it.
    #[schema(example = 4e9)]
    u: Option<f64>,
    /// Time of the measurement; now when absent.
    at: Option<Moment>,
}

impl TypedResult {
    fn sample(&self) -> Result<ExternalSample, ApiError> {
        let wrong = |field| {
            let reason =
                "found a run or the number of a part, expected the serial number or run and seq";
            Err(InquiryError::member(field, reason).into())
        };
        match (&self.serial, self.seq) {
            (Some(_), Some(_)) => wrong("seq"),
            (_, None) if self.run.is_some() => wrong("run"),
            (Some(serial), None) => Ok(ExternalSample::Serial(serial.clone())),
            (None, Some(seq)) => Ok(ExternalSample::Part { run: self.run, seq }),
            (None, None) => Ok(ExternalSample::Lot),
        }
    }
}

/// `POST /api/lots/external`.
pub(super) async fn enter(
    State(app): App,
    author: Author,
    Body(typed): Body<TypedResult>,
) -> JsonResult<ResultsOfLot> {
    let db = app.shared.db.clone();
    blocking(move || {
        let what = json!({ "order": "external_result", "lot": typed.lot, "serial": typed.serial, "run": typed.run,
            "seq": typed.seq, "key": typed.key, "value": typed.value });
        let work = || {
            require_role(&author.person, Role::Engineer)?;
            write(&db, &author.person.name, &typed)
        };
        audited(&db, author.by(), |_| what, ApiError::message, work)??;
        of_lot(&Archive::open(&db)?, &typed.lot).map(Json)
    })
    .await
}

fn write(db: &Path, who: &str, typed: &TypedResult) -> Result<(), ApiError> {
    let result = NewResult {
        line: None,
        sample: typed.sample()?,
        key: typed.key,
        value: typed.value,
        u: typed.u,
        measured_at: typed.at,
    };
    let entered = Store::open(db)?.enter_results(&EnteredResults {
        lot: &typed.lot,
        recipe: None,
        who,
        at: Moment(now_us()),
        file_hash: None,
        results: &[result],
    })?;
    entered.map(drop).map_err(refused)
}

/// Returns the code of the refusal of a column.
fn code(column: &str) -> &'static str {
    match column {
        "recipe" => "external_recipe",
        "key" => "external_key",
        "u" => "external_u",
        "serial" => "external_serial",
        "seq" => "external_seq",
        "run" => "external_run",
        "at" => "external_at",
        _value => "external_value",
    }
}

fn refused(why: ResultRefusal) -> ApiError {
    match why {
        ResultRefusal::Wrong {
            column: "lot",
            found,
            ..
        } => InquiryError::missing(format!("no lot {found}")).into(),
        ResultRefusal::Wrong {
            column,
            found,
            expected,
            ..
        } => {
            let said = format!("{column}: found {found}, expected {expected}");
            let why = Message::new("refusal", code(column));
            ApiError::Plan {
                status: StatusCode::BAD_REQUEST,
                why: why.with("said", said).with("found", found),
            }
        }
        ResultRefusal::Csv(_) | ResultRefusal::Again { .. } => {
            InquiryError::member("value", why.to_string()).into()
        }
    }
}
