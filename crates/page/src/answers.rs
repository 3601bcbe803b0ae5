//! Types of answers. Each type describes its media type and its schema in the OpenAPI document.

use super::api::Operation;
use super::error::ApiError;
use axum::Json;
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};
use std::marker::PhantomData;
use utoipa::ToSchema;

/// An answer that describes itself in the OpenAPI document.
pub(super) trait Answer {
    fn describe(operation: &mut Operation);
}

/// Media type and schema of an answer that is not [`Json`].
pub(super) trait Kind {
    const MEDIA: &str;

    fn schema(_: &mut Operation) -> Value {
        json!({"type": "string"})
    }
}

/// An answer `R` of kind `K`.
pub(super) struct As<K, R = Response>(R, PhantomData<K>);

impl<K, R> As<K, R> {
    pub fn new(answer: R) -> Self {
        Self(answer, PhantomData)
    }
}

impl<K, R: IntoResponse> IntoResponse for As<K, R> {
    fn into_response(self) -> Response {
        self.0.into_response()
    }
}

impl<K: Kind, R> Answer for As<K, R> {
    fn describe(operation: &mut Operation) {
        let schema = K::schema(operation);
        operation.answer = (K::MEDIA, schema);
    }
}

impl<T: ToSchema> Answer for Json<T> {
    fn describe(operation: &mut Operation) {
        operation.answer = ("application/json", operation.schema_of::<T>());
    }
}

impl<T: Answer> Answer for Result<T, ApiError> {
    fn describe(operation: &mut Operation) {
        T::describe(operation);
    }
}

impl<H, T: Answer> Answer for (H, T) {
    fn describe(operation: &mut Operation) {
        T::describe(operation);
    }
}

/// A page of HTML.
pub(super) struct Html;
/// A script of a page.
pub(super) struct Script;
/// A drawing.
pub(super) struct Svg;
/// Figures for Prometheus.
pub(super) struct Prometheus;
/// Rows as CSV.
pub(super) struct Csv;
/// A spreadsheet.
pub(super) struct Sheet;
/// Server-sent events.
pub(super) struct Events;
/// A JSON array of `T`, which the route sends while it reads the history.
pub(super) struct Stream<T>(PhantomData<T>);

impl Kind for Html {
    const MEDIA: &str = "text/html";
}

impl Kind for Script {
    const MEDIA: &str = "text/javascript";
}

impl Kind for Svg {
    const MEDIA: &str = "image/svg+xml";
}

impl Kind for Prometheus {
    const MEDIA: &str = "text/plain";
}

impl Kind for Csv {
    const MEDIA: &str = "text/csv";
}

impl Kind for Sheet {
    const MEDIA: &str = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet";

    fn schema(_: &mut Operation) -> Value {
        json!({})
    }
}

impl Kind for Events {
    const MEDIA: &str = "text/event-stream";
}

impl<T: ToSchema> Kind for Stream<T> {
    const MEDIA: &str = "application/json";

    fn schema(operation: &mut Operation) -> Value {
        json!({"type": "array", "items": operation.schema_of::<T>()})
    }
}
