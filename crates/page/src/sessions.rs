//! Sessions. A session tells which person sent a request; every change needs a session.
//!
//! | client | sends | may |
//! |---|---|---|
//! | without login | nothing | read |
//! | page | cookie `relayrig_session`: `HttpOnly`, `SameSite=Strict` | what the role allows |
//! | script | `Authorization: Bearer TOKEN` from the answer to `POST /api/login` | what the role allows |
//!
//! An expired session counts as no session: 401. A role that is too weak gets 403 with the role needed. Browsers do not
//! send the cookie with requests of other sites, and `origin.rs` refuses such requests as well. The cookie of a login
//! over https is `Secure`.
//!
//! `sessions/proof.rs` opens a session when a person proves a password or the set-up code.

mod proof;

pub(super) use proof::Session;

use super::access::{
    AccessError, Person, Register, Role, SESSION_S, SetupCode, access_path, audited,
};
use super::error::{ApiError, blocking};
use super::origin;
use axum::http::{HeaderMap, header};
use machine::view::By;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

const COOKIE: &str = "relayrig_session";

/// People and sessions of this rig, behind one lock.
#[derive(Debug, Clone)]
pub struct Sessions(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    register: Mutex<Register>,
    /// Lock that a login holds while it takes 19 MiB and 20 ms of a core. Logins run one at a time, so that another
    /// request waits for one login at most.
    login: tokio::sync::Mutex<()>,
    /// Path of the history, which holds the audit of orders.
    history: PathBuf,
    setup: Option<SetupCode>,
}

impl Sessions {
    /// Opens or creates the file of people that lies beside `history`; the audit in `history` records changes of
    /// people. While there is no engineer, also returns the code that adds the first one.
    ///
    /// # Errors
    /// Fails when the file belongs to another program or to a later version, or SQLite fails.
    pub fn open(history: &Path) -> Result<(Self, Option<SetupCode>), AccessError> {
        let register = Register::open(&access_path(history))?;
        let setup = register.setup_code()?;
        let inner = Inner {
            register: Mutex::new(register),
            login: tokio::sync::Mutex::default(),
            history: history.to_owned(),
            setup: setup.clone(),
        };
        Ok((Self(Arc::new(inner)), setup))
    }

    /// Returns true while a set-up code may add the first engineer.
    pub(super) async fn needs_setup(&self) -> Result<bool, ApiError> {
        let engineer = self.with(|register| register.has_engineer()).await?;
        Ok(self.0.setup.is_some() && !engineer)
    }

    /// Ends the session of the request; does nothing for a request without a session.
    pub(super) async fn log_out(&self, headers: &HeaderMap) -> Result<(), ApiError> {
        let Some(token) = token(headers) else {
            return Ok(());
        };
        self.with(move |register| register.log_out(&token)).await
    }

    /// Returns the person of the session; `None` without a valid session.
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

    /// Runs `work` over the file of people, on a blocking thread.
    pub(super) async fn with<T, E>(
        &self,
        work: impl FnOnce(&mut Register) -> Result<T, E> + Send + 'static,
    ) -> Result<T, ApiError>
    where
        T: Send + 'static,
        E: Into<ApiError> + Send + 'static,
    {
        let inner = Arc::clone(&self.0);
        blocking(move || work(&mut inner.register())).await
    }

    /// Runs `work` over the file of people, and notes it in the audit of orders as [`audited`] does. Locks the file of
    /// people only during `work`, so that requests find their sessions while the audit waits for a locked history.
    pub(super) async fn audited<T: Send + 'static>(
        &self,
        by: By,
        what: Value,
        work: impl FnOnce(&mut Register) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let inner = Arc::clone(&self.0);
        blocking(move || {
            let work = || work(&mut inner.register());
            audited(&inner.history, by, |_| what, ApiError::message, work)?
        })
        .await
    }
}

impl Inner {
    /// Locks the file of people even after another holder panicked, because no panic leaves data half changed.
    fn register(&self) -> MutexGuard<'_, Register> {
        self.register.lock().unwrap_or_else(PoisonError::into_inner)
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

/// Returns the value of `Set-Cookie` that sets the token, or deletes the cookie when `token` is `None`. A browser sends
/// a cookie that it got over https back over https only.
pub(super) fn cookie(token: Option<&str>, headers: &HeaderMap) -> String {
    let age = if token.is_some() { SESSION_S } else { 0 };
    let token = token.unwrap_or_default();
    let secure = if origin::is_https(headers) {
        "; Secure"
    } else {
        ""
    };
    format!("{COOKIE}={token}; Path=/; HttpOnly; SameSite=Strict; Max-Age={age}{secure}")
}

/// Returns the token of the request; `Authorization` takes precedence over the cookie.
pub(super) fn token(headers: &HeaderMap) -> Option<String> {
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

pub(super) fn now_us() -> i64 {
    jiff::Timestamp::now().as_microsecond()
}
