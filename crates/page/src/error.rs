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
            _ => match self.in_chinese() {
                Some(reason_zh) => json!({ "reason_zh": reason_zh }),
                None => json!({}),
            },
        }
    }

    /// What an operator meets, in Chinese; the rest is met by scripts and by whoever mends the plant.
    fn in_chinese(&self) -> Option<String> {
        Some(match self {
            Self::NotNow { reason_zh, .. } => reason_zh.clone(),
            Self::NotLoggedIn { .. } => "请先登录".into(),
            Self::WrongPassword => "用户名或密码错误".into(),
            Self::NotAllowed { found, needed } => format!(
                "此操作需要{}权限，您的角色是{}",
                needed.in_chinese(),
                found.in_chinese()
            ),
            Self::TooManyTries { wait } => {
                format!("密码错误次数过多，请 {} 秒后再试", wait.as_secs() + 1)
            }
            Self::History(history) | Self::Inquiry(InquiryError::History(history)) => {
                of_history(history)?.into()
            }
            Self::Revision {
                refused: ConfigError::NotNewest { newest, .. },
            } => format!(
                "这份修改所依据的版本已不是最新版本（最新为第 {newest} 版），未保存任何内容"
            ),
            _ => return None,
        })
    }
}

fn of_history(history: &HistoryError) -> Option<&'static str> {
    match history {
        HistoryError::Missing { .. } => Some("尚无历史记录"),
        HistoryError::Locked { .. } => Some("历史文件被其他程序占用"),
        HistoryError::DiskFull { .. } => Some("磁盘已满"),
        HistoryError::ReadOnly { .. } => Some("历史文件为只读"),
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
