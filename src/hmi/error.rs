//! Every refusal of the screen's interface, with its status and a sentence for the one who asked.

use super::access::{AccessError, Role};
use crate::history::HistoryError;
use crate::inquiry::InquiryError;
use axum::Json;
use axum::extract::rejection::{JsonRejection, QueryRejection};
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use std::time::Duration;

/// Why a request was not fulfilled.
#[derive(Debug, thiserror::Error)]
pub(super) enum HmiError {
    /// 404.
    #[error("there is nothing at {path}")]
    NoSuchRoute {
        /// The path asked for.
        path: String,
    },
    /// 405; the header `Allow` says what is.
    #[error("{path} does not take {method}")]
    WrongMethod {
        /// The path asked for.
        path: String,
        /// The method used.
        method: Method,
    },
    /// 403: a page from elsewhere wants something done.
    #[error("orders are taken from this rig's own page only; found {found}")]
    CrossSite {
        /// The header that gave it away.
        found: String,
    },
    /// 401.
    #[error("{reason}: log in first")]
    NotLoggedIn {
        /// Why the request counts as a stranger's.
        reason: &'static str,
    },
    /// 401: which of them is not said.
    #[error("user name or password is wrong")]
    WrongPassword,
    /// 403: known, but not trusted with this.
    #[error("this takes the role {needed}; you are {found}")]
    NotAllowed {
        /// The role that the person has.
        found: Role,
        /// The weakest role that may.
        needed: Role,
    },
    /// 429; the header `Retry-After` says it in seconds.
    #[error("too many wrong passwords; try again in {} s", .wait.as_secs() + 1)]
    TooManyTries {
        /// Until the next try.
        wait: Duration,
    },
    /// 500: the people could not be looked up.
    #[error(transparent)]
    Access(#[from] AccessError),
    /// 400, 413, 415 or 422 of axum, all of them with its own text.
    #[error("{reason}")]
    Body {
        /// What is wrong with the body.
        reason: String,
        /// Which of them.
        status: StatusCode,
    },
    /// 400.
    #[error("there is no order {found:?}; known are {known}")]
    UnknownOrder {
        /// The word found.
        found: String,
        /// The words known.
        known: String,
    },
    /// 409: known, but not now or not here.
    #[error("{order}: {reason}")]
    NotNow {
        /// The order.
        order: &'static str,
        /// Why not.
        reason: String,
        /// The same in Chinese.
        reason_zh: String,
    },
    /// 400: a query string that is no filter.
    #[error("{reason}")]
    Query {
        /// Found and expected.
        reason: String,
    },
    /// 400 for what cannot be meant, 404 for what never was, else as the history itself.
    #[error(transparent)]
    Inquiry(#[from] InquiryError),
    /// 404, 503 or 500.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// 500: a reader ended without an answer.
    #[error("the reader of the history ended without an answer")]
    ReaderLost,
}

impl HmiError {
    fn status(&self) -> StatusCode {
        match self {
            Self::NoSuchRoute { .. } => StatusCode::NOT_FOUND,
            Self::WrongMethod { .. } => StatusCode::METHOD_NOT_ALLOWED,
            Self::CrossSite { .. } | Self::NotAllowed { .. } => StatusCode::FORBIDDEN,
            Self::NotLoggedIn { .. } | Self::WrongPassword => StatusCode::UNAUTHORIZED,
            Self::TooManyTries { .. } => StatusCode::TOO_MANY_REQUESTS,
            Self::Body { status, .. } => *status,
            Self::UnknownOrder { .. } | Self::Query { .. } => StatusCode::BAD_REQUEST,
            Self::NotNow { .. } => StatusCode::CONFLICT,
            Self::History(history) | Self::Inquiry(InquiryError::History(history)) => {
                unread(history)
            }
            Self::Inquiry(InquiryError::Member { .. }) => StatusCode::BAD_REQUEST,
            Self::Inquiry(InquiryError::NotThere { .. }) => StatusCode::NOT_FOUND,
            Self::Inquiry(InquiryError::Write(_) | InquiryError::Sheet(_))
            | Self::Access(_)
            | Self::ReaderLost => StatusCode::INTERNAL_SERVER_ERROR,
        }
    }
}

fn unread(history: &HistoryError) -> StatusCode {
    match history {
        HistoryError::Missing { .. } => StatusCode::NOT_FOUND,
        HistoryError::Locked { .. } => StatusCode::SERVICE_UNAVAILABLE,
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

impl IntoResponse for HmiError {
    fn into_response(self) -> Response {
        let status = self.status();
        let word = status.canonical_reason().unwrap_or("refused");
        let mut body = serde_json::json!({
            "error": word.to_ascii_lowercase(),
            "reason": self.to_string(),
        });
        if let Self::NotNow { reason_zh, .. } = &self {
            body["reason_zh"] = reason_zh.as_str().into();
        }
        let mut response = (status, Json(body)).into_response();
        if let Self::TooManyTries { wait } = self {
            let seconds = HeaderValue::from(wait.as_secs() + 1);
            response.headers_mut().insert(header::RETRY_AFTER, seconds);
        }
        response
    }
}

impl From<JsonRejection> for HmiError {
    fn from(found: JsonRejection) -> Self {
        let status = match found.status() {
            StatusCode::UNPROCESSABLE_ENTITY => StatusCode::BAD_REQUEST,
            status => status,
        };
        let reason = found.body_text();
        Self::Body { reason, status }
    }
}

impl From<QueryRejection> for HmiError {
    fn from(found: QueryRejection) -> Self {
        let reason = found.body_text();
        Self::Query { reason }
    }
}
