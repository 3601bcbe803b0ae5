//! Sessions: the person behind a request, which every change needs.
//!
//! | client | sends | may |
//! |---|---|---|
//! | without login | nothing | read |
//! | page | cookie `relayrig_session`: `HttpOnly`, `SameSite=Strict` | what the role allows |
//! | script | `Authorization: Bearer TOKEN` from the answer to `POST /api/login` | what the role allows |
//!
//! An expired session counts as none: 401. A role that is too weak gets 403 with the role needed. Browsers do not send
//! the cookie with requests of other sites, and `origin.rs` refuses those as well. The cookie has no `Secure`, because
//! the program serves plain HTTP on loopback; elsewhere the plant's proxy adds it.

use super::access::{AccessError, Limiter, Person, Register, Role, SESSION_S};
use super::error::{ApiError, blocking};
use super::origin;
use axum::http::{HeaderMap, header};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

const COOKIE: &str = "relayrig_session";

/// People and sessions of this rig, behind one lock: logins run one after another, because each takes 19 MiB and 20 ms
/// of a core.
#[derive(Debug, Clone)]
pub struct Sessions(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    register: Mutex<Register>,
    limiter: Mutex<Limiter>,
}

impl Sessions {
    /// Opens or creates the file of people; returns also name and password of the engineer that the first start adds.
    ///
    /// # Errors
    /// Fails when the file belongs to another program or to a later version, or SQLite fails.
    pub fn open(path: &Path) -> Result<(Self, Option<(String, String)>), AccessError> {
        let mut register = Register::open(path)?;
        let first = register.first_engineer(now_us())?;
        let inner = Inner {
            register: Mutex::new(register),
            limiter: Mutex::default(),
        };
        Ok((Self(Arc::new(inner)), first))
    }

    /// Opens a session; returns the person and the token. Fails for a wrong name or password, and after too many tries.
    pub(super) async fn log_in(
        &self,
        name: String,
        password: String,
    ) -> Result<(Person, String), ApiError> {
        let key = name.clone();
        self.check_pace(&key)?;
        let answer = self
            .with(move |register| register.log_in(&name, &password, now_us()))
            .await?;
        let mut limiter = locked(&self.0.limiter);
        if answer.is_some() {
            limiter.succeeded(&key);
        } else {
            limiter.failed(&key, Instant::now());
        }
        answer.ok_or(ApiError::WrongPassword)
    }

    /// Ends the session of the request; does nothing without one.
    pub(super) async fn log_out(&self, headers: &HeaderMap) -> Result<(), ApiError> {
        let Some(token) = token(headers) else {
            return Ok(());
        };
        self.with(move |register| register.log_out(&token)).await
    }

    /// Returns the person of the session; `None` without a valid one.
    pub(super) async fn who(&self, headers: &HeaderMap) -> Result<Option<Person>, ApiError> {
        let Some(token) = token(headers) else {
            return Ok(None);
        };
        self.with(move |register| register.holder(&token, now_us()))
            .await
    }

    /// Returns the person who sends a change. Fails without a valid session, and for a request of another site.
    pub(super) async fn author(&self, headers: &HeaderMap) -> Result<Person, ApiError> {
        origin::check(headers)?;
        self.who(headers).await?.ok_or(ApiError::NotLoggedIn)
    }

    fn check_pace(&self, name: &str) -> Result<(), ApiError> {
        match locked(&self.0.limiter).wait(name, Instant::now()) {
            Some(wait) => Err(ApiError::TooManyTries { wait }),
            None => Ok(()),
        }
    }

    async fn with<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut Register) -> Result<T, AccessError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let inner = Arc::clone(&self.0);
        blocking(move || work(&mut locked(&inner.register))).await
    }
}

/// Fails when the role of `person` is weaker than `needed`.
pub(super) fn require_role(person: &Person, needed: Role) -> Result<(), ApiError> {
    let found = person.role;
    if found < needed {
        return Err(ApiError::NotAllowed { found, needed });
    }
    Ok(())
}

/// Returns the value of `Set-Cookie` that sets the token, or deletes the cookie when there is none.
pub(super) fn cookie(token: Option<&str>) -> String {
    let age = if token.is_some() { SESSION_S } else { 0 };
    let token = token.unwrap_or_default();
    format!("{COOKIE}={token}; Path=/; HttpOnly; SameSite=Strict; Max-Age={age}")
}

/// Returns the token of the request; `Authorization` takes precedence over the cookie.
fn token(headers: &HeaderMap) -> Option<String> {
    if let Some(value) = headers.get(header::AUTHORIZATION) {
        let token = value.to_str().ok()?.strip_prefix("Bearer ")?;
        return Some(token.trim().to_owned());
    }
    let cookies = headers.get_all(header::COOKIE).into_iter();
    let pairs = cookies
        .filter_map(|it| it.to_str().ok())
        .flat_map(|it| it.split(';'));
    let mut named = pairs.filter_map(|it| it.trim().strip_prefix(COOKIE)?.strip_prefix('='));
    named.next().map(str::to_owned)
}

/// Locks even after another holder panicked: no panic leaves the data half changed.
fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

fn now_us() -> i64 {
    jiff::Timestamp::now().as_microsecond()
}
