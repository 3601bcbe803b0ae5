//! Every refusal of the screen's interface, with its status and a sentence for the one who asked.

use super::access::{AccessError, Role};
use axum::Json;
use axum::extract::rejection::{JsonRejection, QueryRejection};
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use config::ConfigError;
use history::HistoryError;
use history::inquiry::InquiryError;
use serde_json::json;
use std::time::Duration;
use texts::{Lang, Message};

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
    #[error("{}", refusal("wrong_password").say(Lang::En))]
    WrongPassword,
    /// 403: known, but not trusted with this.
    #[error("{}", not_allowed(*.found, *.needed).say(Lang::En))]
    NotAllowed {
        /// The role that the person has.
        found: Role,
        /// The weakest role that may.
        needed: Role,
    },
    /// 429; the header `Retry-After` says it in seconds.
    #[error("{}", too_many_tries(*.wait).say(Lang::En))]
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
    #[error("{order}: {}", .why.say(Lang::En))]
    NotNow {
        /// The order.
        order: &'static str,
        /// Why not.
        why: Message,
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
    /// 404 for a recipe or revision that never was, else 500: the files of the plant are not as they should be.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// 400 with the key for a value, 404 for a recipe that never was, 409 for a change that came second.
    #[error("{refused}")]
    Revision {
        /// Why it was not saved.
        refused: ConfigError,
    },
    /// 500: done, but nobody will find it in the audit.
    #[error("the revision was saved, but not noted in the audit of orders: {source}")]
    Unnoted {
        /// Why not.
        source: HistoryError,
    },
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
            | Self::Unnoted { .. }
            | Self::ReaderLost => StatusCode::INTERNAL_SERVER_ERROR,
            Self::Config(found) => of_config(found, StatusCode::INTERNAL_SERVER_ERROR),
            Self::Revision { refused } => of_config(refused, StatusCode::BAD_REQUEST),
        }
    }

    /// What stands beside status and reason.
    fn more(&self) -> serde_json::Value {
        match self {
            Self::Revision {
                refused:
                    refused @ ConfigError::Value {
                        found, expected, ..
                    },
            } => json!({ "key": refused.key(), "found": found, "expected": expected }),
            _ => match self.message() {
                Some(why) => {
                    json!({ "reason_zh": why.say(Lang::Zh), "code": why.code(), "args": why.args() })
                }
                None => json!({}),
            },
        }
    }

    /// What an operator meets; the rest is met by scripts and by whoever mends the plant.
    fn message(&self) -> Option<Message> {
        Some(match self {
            Self::NotNow { why, .. } => why.clone(),
            Self::NotLoggedIn { .. } => refusal("not_logged_in"),
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

/// `wrong` is the status of a file whose text is refused.
fn of_config(found: &ConfigError, wrong: StatusCode) -> StatusCode {
    match found {
        ConfigError::UnknownRecipe { .. } | ConfigError::UnknownRevision { .. } => {
            StatusCode::NOT_FOUND
        }
        ConfigError::NotNewest { .. } => StatusCode::CONFLICT,
        ConfigError::Unreadable { .. } | ConfigError::Unwritten { .. } => {
            StatusCode::INTERNAL_SERVER_ERROR
        }
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

impl IntoResponse for HmiError {
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
