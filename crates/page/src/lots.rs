//! `/api/lots` and `/api/wear`, for the page of lots.
//!
//! `why_not` maps each order about lots to null, or to the reason (`code`, `args`, `en`, `zh`) why the state of the lot
//! forbids the order. For the lot under way, the buttons in the view tell which orders are possible.

use super::asked::{Asked, members};
use super::error::{ApiError, JsonResult};
use super::router::App;
use axum::Json;
use axum::extract::State;
use history::{Archive, Decision, LotEntry, LotState, Wear};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use texts::Message;
use utoipa::openapi::schema::Type;
use utoipa::openapi::{Object, ObjectBuilder, OneOfBuilder, Ref, Schema};
use utoipa::{IntoParams, ToSchema};

/// Default of `limit`.
const SHOWN: u32 = 20;
/// Greatest `limit`, because the server counts all parts of each listed lot.
const MOST: u32 = 200;

/// A lot with the orders that its state allows.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct ListedLot {
    #[serde(flatten)]
    line: LotEntry,
    /// For each order about lots, the reason why the state of this lot forbids it; null when the state allows it.
    #[schema(schema_with = reasons)]
    why_not: BTreeMap<&'static str, Option<Message>>,
}

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct BookQuery {
    /// Largest number of lots in the answer, 1 to 200; 20 when absent.
    #[param(minimum = 1, maximum = 200, example = 20)]
    limit: Option<u32>,
    /// Number of lots to skip.
    #[param(example = 0)]
    offset: Option<u32>,
}

members!(BookQuery);

/// `GET /api/lots`.
pub(super) async fn lots(
    State(app): App,
    Asked(BookQuery { limit, offset }): Asked<BookQuery>,
) -> JsonResult<Vec<ListedLot>> {
    let limit = ApiError::ranged("limit", limit, SHOWN, MOST)?;
    let read = move |archive: &Archive| Ok(archive.lot_book(limit, offset.unwrap_or(0))?);
    let book = app.readers.read(read).await?;
    let listed = book.into_iter().map(|line| ListedLot {
        why_not: why_not(line.standing.state),
        line,
    });
    Ok(Json(listed.collect()))
}

fn reasons() -> Object {
    let none = ObjectBuilder::new().schema_type(Type::Null);
    let message = Ref::from_schema_name("Message");
    let either = OneOfBuilder::new().item(none).item(message).build();
    let each = Some(Schema::OneOf(either));
    ObjectBuilder::new().additional_properties(each).build()
}

fn why_not(state: LotState) -> BTreeMap<&'static str, Option<Message>> {
    let decisions = Decision::ALL
        .into_iter()
        .map(|it| (it.order(), it.refusal(state)));
    let held = (state == LotState::Held).then(|| Message::new("refusal", "release_first"));
    decisions.chain([("start", held)]).collect()
}

/// `GET /api/wear`.
pub(super) async fn wear(State(app): App) -> JsonResult<Vec<Wear>> {
    let simulated = app.shared.view.borrow().simulated;
    let read = move |archive: &Archive| Ok(archive.wear(simulated)?);
    app.readers.read(read).await.map(Json)
}
