//! Every refusal of the HTTP interface, with its status and a sentence for the client.

use super::access::{AccessError, Role};
use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use config::ConfigError;
use config::strict::Unreadable;
use history::HistoryError;
use history::inquiry::InquiryError;
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::Display;
use std::time::Duration;
use texts::{Args, Lang, Message};
use tokio::task::spawn_blocking;
use utoipa::ToSchema;

/// Reason for the refusal of a request; each variant names its HTTP status.
#[derive(Debug, thiserror::Error)]
pub(super) enum ApiError {
    /// 404: no route has this path.
    #[error("there is nothing at {path}")]
    NoSuchRoute { path: String },
    /// 405; the header `Allow` lists the methods of the path.
    #[error("{path} does not take {method}")]
    WrongMethod { path: String, method: Method },
    /// 403: a page of another site sent an order; `found` is the header that reveals this.
    #[error("orders are taken from this rig's own page only; found {found}")]
    CrossSite { found: String },
    /// 401: the request has no valid session.
    #[error("{}", refusal("not_logged_in").say(Lang::En))]
    NotLoggedIn,
    /// 401: name or password is wrong; the answer does not say which.
    #[error("{}", refusal("wrong_password").say(Lang::En))]
    WrongPassword,
    /// 401: the set-up code is wrong, or an engineer exists already.
    #[error("{}", refusal("wrong_code").say(Lang::En))]
    WrongCode,
    /// 403: the role of the person, `found`, is weaker than `needed`.
    #[error("{}", not_allowed(*.found, *.needed).say(Lang::En))]
    NotAllowed { found: Role, needed: Role },
    /// 429: too many wrong passwords; the header `Retry-After` gives the wait in seconds.
    #[error("{}", too_many_tries(*.wait).say(Lang::En))]
    TooManyTries { wait: Duration },
    /// 400 for a malformed name or password, 404 for an unknown person, 409 for a taken name and for the last engineer;
    /// the status of [`Self::History`] when the audit of orders does not open; otherwise 500.
    #[error(transparent)]
    Access(#[from] AccessError),
    /// 400, 408, 413 or 415: the body cannot be read.
    #[error("{reason}")]
    Body { reason: String, status: StatusCode },
    /// 400: a member of body or query string is unknown, missing or malformed.
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    /// 409: the station refuses the order now.
    #[error("{order}: {}", .why.say(Lang::En))]
    NotNow { order: String, why: Message },
    /// 400: the query string is malformed.
    #[error("{reason}")]
    Query { reason: String },
    /// 400 for a malformed question, 404 for a lot, run or part that does not exist, otherwise as [`Self::History`].
    #[error(transparent)]
    Inquiry(#[from] InquiryError),
    /// 404 without a history file, 503 when the file is locked or the database does not answer, otherwise 500.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// 404 for an unknown recipe or revision; 500 for a faulty file of the configuration.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// 400 with the key of a refused value, 404 for an unknown recipe, 409 when the change is not based on the newest
    /// revision or the name is taken, 500 when a file cannot be read or written.
    #[error("{refused}")]
    Revision { refused: ConfigError },
    /// 409: the person may not approve this revision; `code` says why.
    #[error("{}", refusal(.code).say(Lang::En))]
    NotApproved { code: &'static str },
    /// 400, 404, 409 or 503: the server refuses a plan for tooling, a change of a plan, or a result from outside.
    #[error("{}", .why.say(Lang::En))]
    Plan { status: StatusCode, why: Message },
    /// 500: a blocking task panicked or was cancelled.
    #[error("the reader of the history ended without an answer")]
    ReaderLost,
}

/// JSON answer, or the refusal of the request.
pub(super) type JsonResult<T> = Result<Json<T>, ApiError>;

/// Body of every refusal.
#[derive(Debug, Default, Serialize, ToSchema)]
pub(super) struct Refusal {
    /// The status in words, for example `bad request`.
    error: String,
    /// The reason as a sentence, English.
    reason: String,
    /// The reason as a sentence, Chinese.
    reason_zh: String,
    /// The reason as a code.
    code: String,
    /// Arguments of the code.
    args: Args,
    /// Member of the request at fault.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    member: Option<String>,
    /// Key in the recipe whose value the rig refuses.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    key: Option<String>,
    /// The refused value.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    found: Option<String>,
    /// What the key accepts.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    expected: Option<String>,
    /// The accepted values, as a code with its argument.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    requirement: Option<Value>,
}

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
            Self::NotLoggedIn | Self::WrongPassword | Self::WrongCode => StatusCode::UNAUTHORIZED,
            Self::TooManyTries { .. } => StatusCode::TOO_MANY_REQUESTS,
            Self::Body { status, .. } | Self::Plan { status, .. } => *status,
            Self::Unreadable(_) | Self::Query { .. } => StatusCode::BAD_REQUEST,
            Self::NotNow { .. } | Self::NotApproved { .. } => StatusCode::CONFLICT,
            Self::History(history) | Self::Inquiry(InquiryError::History(history)) => {
                unread(history)
            }
            Self::Inquiry(InquiryError::Member { .. }) => StatusCode::BAD_REQUEST,
            Self::Inquiry(InquiryError::Missing { .. }) => StatusCode::NOT_FOUND,
            Self::Inquiry(InquiryError::Write(_) | InquiryError::Sheet(_)) | Self::ReaderLost => {
                StatusCode::INTERNAL_SERVER_ERROR
            }
            Self::Access(found) => of_access(found),
            Self::Config(found) => config_status(found, StatusCode::INTERNAL_SERVER_ERROR),
            Self::Revision { refused } => config_status(refused, StatusCode::BAD_REQUEST),
        }
    }

    fn body(&self) -> Refusal {
        let word = self.status().canonical_reason().unwrap_or("refused");
        let why = self.message();
        let refusal = Refusal {
            error: word.to_ascii_lowercase(),
            reason: self.to_string(),
            reason_zh: why.say(Lang::Zh),
            code: why.code().to_owned(),
            args: why.args().clone(),
            ..Refusal::default()
        };
        match self {
            Self::Unreadable(Unreadable { member, .. }) => Refusal {
                member: (!member.is_empty()).then(|| member.clone()),
                ..refusal
            },
            Self::Revision {
                refused:
                    refused @ ConfigError::Value {
                        found,
                        expected,
                        requirement,
                        ..
                    },
            } => Refusal {
                key: refused.key(),
                found: Some(found.clone()),
                expected: Some(expected.clone()),
                requirement: Some(json!(requirement)),
                ..refusal
            },
            _ => refusal,
        }
    }

    /// Returns the refusal in both languages. All mistakes that only a program can make share one Chinese text.
    pub fn message(&self) -> Message {
        let said = |code| refusal(code).with("said", self);
        match self {
            Self::NotNow { why, .. } | Self::Plan { why, .. } => why.clone(),
            Self::NotLoggedIn => refusal("not_logged_in"),
            Self::WrongPassword => refusal("wrong_password"),
            Self::WrongCode => refusal("wrong_code"),
            Self::Access(found) => found.message(),
            Self::NotAllowed { found, needed } => not_allowed(*found, *needed),
            Self::TooManyTries { wait } => too_many_tries(*wait),
            Self::History(history) | Self::Inquiry(InquiryError::History(history)) => {
                said(history.refusal())
            }
            Self::Inquiry(InquiryError::Member { field, .. }) => {
                said("member").with("member", field)
            }
            Self::Inquiry(InquiryError::Missing { .. }) => said("nothing_found"),
            Self::Config(refused) | Self::Revision { refused } => refused.message(),
            Self::NotApproved { code } => refusal(code),
            Self::NoSuchRoute { .. }
            | Self::WrongMethod { .. }
            | Self::CrossSite { .. }
            | Self::Body { .. }
            | Self::Unreadable(_)
            | Self::Query { .. } => said("bad_request"),
            Self::Inquiry(InquiryError::Write(_) | InquiryError::Sheet(_)) | Self::ReaderLost => {
                said("program_trouble")
            }
        }
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

/// Returns the status of a configuration error; `wrong` is the status for a text that the configuration refuses.
fn config_status(found: &ConfigError, wrong: StatusCode) -> StatusCode {
    match found {
        ConfigError::UnknownRecipe { .. }
        | ConfigError::UnknownInstrument { .. }
        | ConfigError::UnknownRevision { .. } => StatusCode::NOT_FOUND,
        ConfigError::NotNewest { .. } | ConfigError::RecipeTaken { .. } => StatusCode::CONFLICT,
        ConfigError::NoFolder { .. }
        | ConfigError::Unreadable { .. }
        | ConfigError::Unwritten { .. } => StatusCode::INTERNAL_SERVER_ERROR,
        ConfigError::Syntax { .. }
        | ConfigError::Value { .. }
        | ConfigError::Rule { .. }
        | ConfigError::NothingChanged { .. }
        | ConfigError::RecipeName { .. }
        | ConfigError::NoReason => wrong,
    }
}

fn of_access(found: &AccessError) -> StatusCode {
    match found {
        AccessError::Name { .. } | AccessError::Password { .. } => StatusCode::BAD_REQUEST,
        AccessError::Unknown { .. } => StatusCode::NOT_FOUND,
        AccessError::Taken { .. } | AccessError::LastEngineer { .. } => StatusCode::CONFLICT,
        AccessError::NoAudit(source) => unread(source),
        AccessError::NotAudited(_)
        | AccessError::Foreign { .. }
        | AccessError::Damaged { .. }
        | AccessError::Database { .. }
        | AccessError::Crypto { .. } => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

fn unread(history: &HistoryError) -> StatusCode {
    match history {
        HistoryError::Missing { .. } => StatusCode::NOT_FOUND,
        HistoryError::Locked { .. } | HistoryError::Server(_) => StatusCode::SERVICE_UNAVAILABLE,
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = (self.status(), Json(self.body())).into_response();
        if let Self::TooManyTries { wait } = self {
            let seconds = HeaderValue::from(wait.as_secs() + 1);
            response.headers_mut().insert(header::RETRY_AFTER, seconds);
        }
        response
    }
}

impl From<QueryRejection> for ApiError {
    fn from(found: QueryRejection) -> Self {
        let reason = found.body_text();
        Self::Query { reason }
    }
}
