//! Inputs of routes: query strings, bodies, logged-in persons. Each type both reads its part of the request and
//! describes it in the OpenAPI document, so that document and program cannot differ.

use super::access::Person;
use super::api::{Input, Operation};
use super::error::ApiError;
use super::origin;
use super::router::AppState;
use axum::body::to_bytes;
use axum::extract::{ConnectInfo, FromRequest, FromRequestParts, Path, Query, Request, State};
use axum::http::header::CONTENT_TYPE;
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode, Uri};
use config::strict::{self, Unreadable};
use machine::view::By;
use serde::de::DeserializeOwned;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::time::timeout;
use utoipa::openapi::path::{Parameter, ParameterIn};
use utoipa::{IntoParams, ToSchema};

/// Members of the query string: a struct, or a tuple of structs. The router refuses a member that no struct has.
#[derive(Debug)]
pub(super) struct Asked<T>(pub T);

/// Largest body of a request, bytes.
pub(super) const BODY_LIMIT: usize = 16 * 1024;
/// Longest time that a client may take to send the body of a request.
pub(super) const BODY_TIME: Duration = Duration::from_secs(10);
/// The character U+0000 in JSON.
const NUL: &[u8] = b"\\u0000";

/// JSON body of a request. A `T` that denies unknown fields refuses unknown members.
#[derive(Debug)]
pub(super) struct Body<T>(pub T);

/// The logged-in person who sends a change from this rig's own page or from a script.
#[derive(Debug)]
pub(super) struct Author {
    pub person: Person,
    /// Network address of the client; empty when unknown.
    pub origin: String,
}

impl Author {
    /// Returns person, role and address for the audit.
    pub fn by(&self) -> By {
        By {
            who: self.person.name.clone(),
            role: self.person.role.to_string(),
            origin: self.origin.clone(),
        }
    }
}

/// Proof that no page of another site sent the request.
#[derive(Debug)]
pub(super) struct OwnPage {
    /// Network address of the client; empty when unknown.
    pub address: String,
}

/// Part of a query string.
pub(super) trait Members: Sized {
    fn parameters() -> Vec<Parameter>;
    fn read(pairs: &[(String, String)]) -> Result<Self, Unreadable>;
}

/// Implements [`Members`] for structs.
macro_rules! members {
    ($($kind:ty),+ $(,)?) => {$(
        impl $crate::asked::Members for $kind {
            fn parameters() -> Vec<utoipa::openapi::path::Parameter> {
                $crate::asked::parameters::<Self>()
            }

            fn read(pairs: &[(String, String)]) -> Result<Self, config::strict::Unreadable> {
                $crate::asked::read(pairs)
            }
        }
    )+};
}
pub(super) use members;

pub(super) fn parameters<T: IntoParams>() -> Vec<Parameter> {
    T::into_params(|| Some(ParameterIn::Query))
}

/// Reads those pairs that are members of `T`.
pub(super) fn read<T: IntoParams + DeserializeOwned>(
    pairs: &[(String, String)],
) -> Result<T, Unreadable> {
    let own = parameters::<T>();
    let pairs = pairs
        .iter()
        .filter(|(name, _)| own.iter().any(|it| it.name == *name));
    strict::from_pairs(pairs.cloned())
}

macro_rules! tuples {
    ($($($kind:ident)+;)+) => {$(
        impl<$($kind: Members),+> Members for ($($kind,)+) {
            fn parameters() -> Vec<Parameter> {
                [$($kind::parameters()),+].concat()
            }

            fn read(pairs: &[(String, String)]) -> Result<Self, Unreadable> {
                Ok(($($kind::read(pairs)?,)+))
            }
        }
    )+};
}
tuples! { A B; A B C; A B C D; A B C D E; A B C D E F; }

/// Returns the members of a query string, decoded.
pub(super) fn pairs(uri: &Uri) -> Result<Vec<(String, String)>, ApiError> {
    Ok(Query::try_from_uri(uri)?.0)
}

impl<S: Sync, T: Members> FromRequestParts<S> for Asked<T> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, ApiError> {
        Ok(Self(T::read(&pairs(&parts.uri)?)?))
    }
}

impl<S: Sync, T: DeserializeOwned> FromRequest<S> for Body<T> {
    type Rejection = ApiError;

    async fn from_request(request: Request, _: &S) -> Result<Self, ApiError> {
        let refused = |status, reason| Err(ApiError::Body { reason, status });
        let media = request.headers().get(CONTENT_TYPE);
        let media = media.and_then(|it| it.to_str().ok()?.split(';').next());
        if !media.is_some_and(|it| it.trim().eq_ignore_ascii_case("application/json")) {
            let reason = "expected a request with `Content-Type: application/json`";
            return refused(StatusCode::UNSUPPORTED_MEDIA_TYPE, reason.to_owned());
        }
        match timeout(BODY_TIME, to_bytes(request.into_body(), BODY_LIMIT)).await {
            Ok(Ok(text)) if text.windows(NUL.len()).any(|it| it == NUL) => {
                let reason = "found the character U+0000, which databases refuse; expected none";
                refused(StatusCode::BAD_REQUEST, reason.to_owned())
            }
            Ok(Ok(text)) => Ok(Self(strict::from_slice(&text)?)),
            Ok(Err(_)) => {
                let reason = format!("expected a body of at most {BODY_LIMIT} bytes");
                refused(StatusCode::PAYLOAD_TOO_LARGE, reason)
            }
            Err(_) => {
                let reason = format!("expected the whole body within {} s", BODY_TIME.as_secs());
                refused(StatusCode::REQUEST_TIMEOUT, reason)
            }
        }
    }
}

impl FromRequestParts<AppState> for Author {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, app: &AppState) -> Result<Self, ApiError> {
        let person = app.shared.sessions.author(&parts.headers).await?;
        let origin = address(parts, app).await;
        Ok(Self { person, origin })
    }
}

impl FromRequestParts<AppState> for OwnPage {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, app: &AppState) -> Result<Self, ApiError> {
        origin::check(&parts.headers)?;
        let address = address(parts, app).await;
        Ok(Self { address })
    }
}

async fn address(parts: &mut Parts, app: &AppState) -> String {
    origin::address(ConnectInfo::<SocketAddr>::from_request_parts(parts, app).await)
}

impl<S> Input for State<S> {}
impl Input for HeaderMap {}

impl<T: Members> Input for Asked<T> {
    fn describe(operation: &mut Operation) {
        operation.parameters.extend(T::parameters());
    }
}

impl<T: IntoParams> Input for Path<T> {
    fn describe(operation: &mut Operation) {
        let own = T::into_params(|| Some(ParameterIn::Path));
        operation.parameters.extend(own);
        operation.refusals.insert(404);
    }
}

impl<T: ToSchema> Input for Body<T> {
    fn describe(operation: &mut Operation) {
        operation.body = Some(operation.schema_of::<T>());
        operation.refusals.extend([408, 413, 415]);
    }
}

impl Input for Author {
    fn describe(operation: &mut Operation) {
        operation.refusals.extend([401, 403, 500]);
    }
}

impl Input for OwnPage {
    fn describe(operation: &mut Operation) {
        operation.refusals.insert(403);
    }
}
