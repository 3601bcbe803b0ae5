//! Every refusal of the HTTP interface, with its status and a sentence for the client.

use super::access::{AccessError, Role};
use axum::Json;
use axum::extract::Query;
use axum::extract::rejection::{JsonRejection, QueryRejection};
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use config::ConfigError;
use history::HistoryError;
use history::inquiry::InquiryError;
use serde_json::json;
use std::fmt::Display;
use std::time::Duration;
use texts::{Lang, Message};
use tokio::task::spawn_blocking;

/// Reason for the refusal of a request; each variant names its HTTP status.
#[derive(Debug, thiserror::Error)]
pub(super) enum ApiError {
    /// 404: no route has this path.
    #[error("there is nothing at {path}")]
    NoSuchRoute { path: String },
    /// 405; the header `Allow` lists the methods of the path.
    #[error("{path} does not take {method}")]
    WrongMethod { path: String, method: Method },
    /// 403: a page of another site sent an order; `found` is the header that shows it.
    #[error("orders are taken from this rig's own page only; found {found}")]
    CrossSite { found: String },
    /// 401: the request has no valid session.
    #[error("{}", refusal("not_logged_in").say(Lang::En))]
    NotLoggedIn,
    /// 401: name or password is wrong; the answer does not say which.
    #[error("{}", refusal("wrong_password").say(Lang::En))]
    WrongPassword,
    /// 403: the role of the person, `found`, is weaker than `needed`.
    #[error("{}", not_allowed(*.found, *.needed).say(Lang::En))]
    NotAllowed { found: Role, needed: Role },
    /// 429; the header `Retry-After` gives the time in seconds.
    #[error("{}", too_many_tries(*.wait).say(Lang::En))]
    TooManyTries { wait: Duration },
    /// 500: the file of people failed.
    #[error(transparent)]
    Access(#[from] AccessError),
    /// 400, 413 or 415: axum cannot read the body.
    #[error("{reason}")]
    Body { reason: String, status: StatusCode },
    /// 400: no order has the name `found`; `known` lists all names.
    #[error("there is no order {found:?}; known are {known}")]
    UnknownOrder { found: String, known: String },
    /// 409: the station refuses the order now.
    #[error("{order}: {}", .why.say(Lang::En))]
    NotNow { order: &'static str, why: Message },
    /// 400: the query string is malformed.
    #[error("{reason}")]
    Query { reason: String },
    /// 400 for a malformed question, 404 for a lot, run or part that does not exist, otherwise as [`Self::History`].
    #[error(transparent)]
    Inquiry(#[from] InquiryError),
    /// 404 without a history file, 503 when it is locked, otherwise 500.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// 404 for an unknown recipe or revision, otherwise 500: a file of the configuration is faulty.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// 400 with the key of a refused value, 404 for an unknown recipe, 409 when the change is not based on the newest
    /// revision.
    #[error("{refused}")]
    Revision { refused: ConfigError },
    /// 500: the program saved the revision but could not write it to the audit.
    #[error("the revision was saved, but not noted in the audit of orders: {source}")]
    NotAudited { source: HistoryError },
    /// 500: a blocking task panicked or was cancelled.
    #[error("the reader of the history ended without an answer")]
    ReaderLost,
}

/// JSON answer, or the refusal of the request.
pub(super) type JsonResult<T> = Result<Json<T>, ApiError>;

/// Members of a query string, or the reason why they are malformed.
pub(super) type Members<T> = Result<Query<T>, QueryRejection>;

/// Runs `work` on a blocking thread.
pub(super) async fn blocking<T, E>(
    work: impl FnOnce() -> Result<T, E> + Send + 'static,
) -> Result<T, ApiError>
where
    T: Send + 'static,
    E: Into<ApiError> + Send + 'static,
{
    let done = spawn_blocking(work).await;
    done.map_err(|_| ApiError::ReaderLost)?.map_err(Into::into)
}

impl ApiError {
    /// Returns `value`, or `default` when the client gives none. Fails when the result is not from 1 to `most`.
    pub fn ranged<N: PartialOrd + From<u8> + Display>(
        member: &str,
        value: Option<N>,
        default: N,
        most: N,
    ) -> Result<N, Self> {
        let value = value.unwrap_or(default);
        if value >= N::from(1) && value <= most {
            return Ok(value);
        }
        let reason = format!("{member}: found {value}, expected 1 to {most}");
        Err(Self::Query { reason })
    }

    fn status(&self) -> StatusCode {
        match self {
            Self::NoSuchRoute { .. } => StatusCode::NOT_FOUND,
            Self::WrongMethod { .. } => StatusCode::METHOD_NOT_ALLOWED,
            Self::CrossSite { .. } | Self::NotAllowed { .. } => StatusCode::FORBIDDEN,
            Self::NotLoggedIn | Self::WrongPassword => StatusCode::UNAUTHORIZED,
            Self::TooManyTries { .. } => StatusCode::TOO_MANY_REQUESTS,
            Self::Body { status, .. } => *status,
            Self::UnknownOrder { .. } | Self::Query { .. } => StatusCode::BAD_REQUEST,
            Self::NotNow { .. } => StatusCode::CONFLICT,
            Self::History(history) | Self::Inquiry(InquiryError::History(history)) => {
                unread(history)
            }
            Self::Inquiry(InquiryError::Member { .. }) => StatusCode::BAD_REQUEST,
            Self::Inquiry(InquiryError::Missing { .. }) => StatusCode::NOT_FOUND,
            Self::Inquiry(InquiryError::Write(_) | InquiryError::Sheet(_))
            | Self::Access(_)
            | Self::NotAudited { .. }
            | Self::ReaderLost => StatusCode::INTERNAL_SERVER_ERROR,
            Self::Config(found) => of_config(found, StatusCode::INTERNAL_SERVER_ERROR),
            Self::Revision { refused } => of_config(refused, StatusCode::BAD_REQUEST),
        }
    }

    /// Returns further members of the JSON answer, besides `error` and `reason`.
    fn more(&self) -> serde_json::Value {
        match self {
            Self::Revision {
                refused:
                    refused @ ConfigError::Value {
                        found,
                        expected,
                        requirement,
                        ..
                    },
            } => {
                json!({ "key": refused.key(), "found": found, "expected": expected, "requirement": requirement })
            }
            _ => match self.message() {
                Some(why) => {
                    json!({ "reason_zh": why.say(Lang::Zh), "code": why.code(), "args": why.args() })
                }
                None => json!({}),
            },
        }
    }

    /// Returns the refusal in both languages if an operator may get it; other refusals are English only.
    fn message(&self) -> Option<Message> {
        Some(match self {
            Self::NotNow { why, .. } => why.clone(),
            Self::NotLoggedIn => refusal("not_logged_in"),
            Self::WrongPassword => refusal("wrong_password"),
            Self::NotAllowed { found, needed } => not_allowed(*found, *needed),
            Self::TooManyTries { wait } => too_many_tries(*wait),
            Self::History(history) | Self::Inquiry(InquiryError::History(history)) => {
                refusal(of_history(history)?)
            }
            Self::Revision {
                refused: ConfigError::NotNewest { newest, .. },
            } => refusal("not_newest").with("newest", newest),
            _ => return None,
        })
    }
}

fn refusal(code: &'static str) -> Message {
    Message::new("refusal", code)
}

fn not_allowed(found: Role, needed: Role) -> Message {
    refusal("not_allowed")
        .with("found_role", found)
        .with("needed_role", needed)
}

fn too_many_tries(wait: Duration) -> Message {
    refusal("too_many_tries").with("wait_s", wait.as_secs() + 1)
}

fn of_history(history: &HistoryError) -> Option<&'static str> {
    match history {
        HistoryError::Missing { .. } => Some("history_missing"),
        HistoryError::Locked { .. } => Some("history_locked"),
        HistoryError::DiskFull { .. } => Some("disk_full"),
        HistoryError::ReadOnly { .. } => Some("history_read_only"),
        _ => None,
    }
}

/// Returns the status of a configuration error; `wrong` is the status for a text that the configuration refuses.
fn of_config(found: &ConfigError, wrong: StatusCode) -> StatusCode {
    match found {
        ConfigError::UnknownRecipe { .. } | ConfigError::UnknownRevision { .. } => {
            StatusCode::NOT_FOUND
        }
        ConfigError::NotNewest { .. } => StatusCode::CONFLICT,
        ConfigError::NoFolder { .. }
        | ConfigError::Unreadable { .. }
        | ConfigError::Unwritten { .. } => StatusCode::INTERNAL_SERVER_ERROR,
        ConfigError::Syntax { .. }
        | ConfigError::Value { .. }
        | ConfigError::Rule { .. }
        | ConfigError::NothingChanged { .. } => wrong,
    }
}

fn unread(history: &HistoryError) -> StatusCode {
    match history {
        HistoryError::Missing { .. } => StatusCode::NOT_FOUND,
        HistoryError::Locked { .. } => StatusCode::SERVICE_UNAVAILABLE,
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let status = self.status();
        let word = status.canonical_reason().unwrap_or("refused");
        let mut body = self.more();
        body["error"] = word.to_ascii_lowercase().into();
        body["reason"] = self.to_string().into();
        let mut response = (status, Json(body)).into_response();
        if let Self::TooManyTries { wait } = self {
            let seconds = HeaderValue::from(wait.as_secs() + 1);
            response.headers_mut().insert(header::RETRY_AFTER, seconds);
        }
        response
    }
}

impl From<JsonRejection> for ApiError {
    fn from(found: JsonRejection) -> Self {
        let status = match found.status() {
            StatusCode::UNPROCESSABLE_ENTITY => StatusCode::BAD_REQUEST,
            status => status,
        };
        let reason = found.body_text();
        Self::Body { reason, status }
    }
}

impl From<QueryRejection> for ApiError {
    fn from(found: QueryRejection) -> Self {
        let reason = found.body_text();
        Self::Query { reason }
    }
}
