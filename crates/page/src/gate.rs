//! Who is asking: sessions at the door of every request that changes something.
//!
//! | who | brings | may |
//! |---|---|---|
//! | a stranger | nothing | look |
//! | the page | cookie `relayrig_session`: `HttpOnly`, `SameSite=Strict` | what the role may |
//! | a script | `Authorization: Bearer TOKEN` from the answer to `POST /api/login` | what the role may |
//!
//! A session that is over counts as none: 401. One whose role is too weak: 403 with the role it takes.
//! The cookie never travels with a request that another site started, and `origin.rs` refuses those
//! besides. There is no `Secure`: the screen listens on loopback, and elsewhere behind a proxy of the
//! plant, which adds it.

use super::access::{AccessError, Limiter, Person, Register, Role, SESSION_S};
use super::error::HmiError;
use axum::http::{HeaderMap, header};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use tokio::task::spawn_blocking;

const COOKIE: &str = "relayrig_session";
const NOT_IN: &str = "nobody is logged in here";

/// The people of this rig, behind one lock: a login takes its turn, so that a crowd of them cannot
/// take memory and both cores.
#[derive(Debug, Clone)]
pub struct Gate(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    register: Mutex<Register>,
    limiter: Mutex<Limiter>,
}

impl Gate {
    /// Opens the file of people, made when missing; the second is name and password of the engineer
    /// that a first start makes.
    ///
    /// # Errors
    /// A file that is no list of people of this program.
    pub fn open(path: &Path) -> Result<(Self, Option<(String, String)>), AccessError> {
        let mut register = Register::open(path)?;
        let first = register.first_engineer(now_us())?;
        let inner = Inner {
            register: Mutex::new(register),
            limiter: Mutex::default(),
        };
        Ok((Self(Arc::new(inner)), first))
    }

    /// A session, or why not.
    pub(super) async fn log_in(
        &self,
        name: String,
        password: String,
    ) -> Result<(Person, String), HmiError> {
        let key = name.clone();
        self.check_pace(&key)?;
        let answer = self
            .with(move |register| register.log_in(&name, &password, now_us()))
            .await?;
        let mut limiter = held(&self.0.limiter);
        if answer.is_some() {
            limiter.succeeded(&key);
        } else {
            limiter.failed(&key, Instant::now());
        }
        answer.ok_or(HmiError::WrongPassword)
    }

    /// Ends the session that the request brings, if any.
    pub(super) async fn log_out(&self, headers: &HeaderMap) -> Result<(), HmiError> {
        let Some(token) = token(headers) else {
            return Ok(());
        };
        self.with(move |register| register.log_out(&token)).await
    }

    /// Who is asking; `None` for a stranger.
    pub(super) async fn who(&self, headers: &HeaderMap) -> Result<Option<Person>, HmiError> {
        let Some(token) = token(headers) else {
            return Ok(None);
        };
        self.with(move |register| register.holder(&token, now_us()))
            .await
    }

    /// Who is asking, at least with this role.
    pub(super) async fn at_least(
        &self,
        role: Role,
        headers: &HeaderMap,
    ) -> Result<Person, HmiError> {
        let person = self.who(headers).await?;
        let person = person.ok_or(HmiError::NotLoggedIn { reason: NOT_IN })?;
        trusted(&person, role)?;
        Ok(person)
    }

    fn check_pace(&self, name: &str) -> Result<(), HmiError> {
        match held(&self.0.limiter).wait(name, Instant::now()) {
            Some(wait) => Err(HmiError::TooManyTries { wait }),
            None => Ok(()),
        }
    }

    async fn with<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut Register) -> Result<T, AccessError> + Send + 'static,
    ) -> Result<T, HmiError> {
        let inner = Arc::clone(&self.0);
        let done = spawn_blocking(move || work(&mut held(&inner.register))).await;
        Ok(done.map_err(|_| HmiError::ReaderLost)??)
    }
}

/// Refuses a person whose role is weaker than `needed`.
pub(super) fn trusted(person: &Person, needed: Role) -> Result<(), HmiError> {
    let found = person.role;
    if found < needed {
        return Err(HmiError::NotAllowed { found, needed });
    }
    Ok(())
}

/// The value of `Set-Cookie` that opens a session, or ends it without a token.
pub(super) fn cookie(token: Option<&str>) -> String {
    let age = if token.is_some() { SESSION_S } else { 0 };
    let token = token.unwrap_or_default();
    format!("{COOKIE}={token}; Path=/; HttpOnly; SameSite=Strict; Max-Age={age}")
}

/// A header that says something wins over the cookie.
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

/// The data behind a lock is whole at every instant; a panic elsewhere does not spoil it.
fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

fn now_us() -> i64 {
    jiff::Timestamp::now().as_microsecond()
}
