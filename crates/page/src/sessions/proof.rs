//! Opens sessions for a right password, for the set-up code of the first engineer, and after a change of one's own
//! password.
//! The audit of orders notes every wrong password or code, with the typed name only if a person has it: people type
//! passwords into the wrong field. An attempt that must wait leaves no line, so that guessing cannot fill the disk.

use super::super::access::{AccessError, Login, Person, Role, note};
use super::super::error::{ApiError, blocking};
use super::{Sessions, now_us};
use history::Store;
use machine::view::By;
use serde_json::json;

/// A person and the token of the person's session.
pub(crate) type Session = (Person, String);

impl Sessions {
    /// Opens a session. Fails for a wrong name or password, and after too many wrong passwords.
    pub(crate) async fn log_in(
        &self,
        name: String,
        password: String,
        origin: String,
    ) -> Result<Session, ApiError> {
        let _turn = self.0.login.lock().await;
        let by = by(name.clone(), None, origin);
        let answer = self
            .with(move |register| register.log_in(&name, &password, now_us()))
            .await?;
        self.answered(answer, by, ApiError::WrongPassword).await
    }

    /// Adds the first engineer and opens a session. Fails for a wrong code, and when there is an engineer.
    pub(crate) async fn set_up(
        &self,
        code: String,
        name: String,
        password: String,
        origin: String,
    ) -> Result<Session, ApiError> {
        let _turn = self.0.login.lock().await;
        let expected = self.0.setup.clone();
        let answer = self
            .with(move |register| register.prove_code(expected.as_ref(), &code, now_us()))
            .await?;
        let by = by(name.clone(), Some(Role::Engineer), origin);
        self.answered(answer, by.clone(), ApiError::WrongCode)
            .await?;
        let what = json!({ "order": "people", "change": "set_up", "name": name });
        let role = Role::Engineer;
        let person = Person { name, role };
        let added = person.clone();
        self.audited(by, what, move |register| {
            Ok(register.add(&added.name, role, &password, now_us())?)
        })
        .await?;
        self.open_session(person).await
    }

    /// Changes the password of `person`, whose other sessions end, and opens a session. Fails for a wrong present
    /// password.
    pub(crate) async fn change_own_password(
        &self,
        person: Person,
        present: String,
        new: String,
        origin: String,
    ) -> Result<Session, ApiError> {
        let _turn = self.0.login.lock().await;
        let by = by(person.name.clone(), Some(person.role), origin);
        let name = person.name.clone();
        let answer = self
            .with(move |register| register.prove(&name, &present, now_us()))
            .await?;
        self.answered(answer, by.clone(), ApiError::WrongPassword)
            .await?;
        let what = json!({ "order": "people", "change": "password", "name": person.name });
        let name = person.name.clone();
        self.audited(by, what, move |register| {
            Ok(register.set_password(&name, &new)?)
        })
        .await?;
        self.open_session(person).await
    }

    async fn open_session(&self, person: Person) -> Result<Session, ApiError> {
        self.with(move |register| {
            let token = register.open_session(&person.name, now_us())?;
            Ok::<_, AccessError>((person, token))
        })
        .await
    }

    /// Returns what the register gave for a right password or code. Notes a wrong one in the audit and fails with
    /// `wrong`; fails with 429 when the register refused to check.
    async fn answered<T>(
        &self,
        answer: Login<T>,
        mut by: By,
        wrong: ApiError,
    ) -> Result<T, ApiError> {
        let known = match answer {
            Login::Right(right) => return Ok(right),
            Login::Wait(wait) => return Err(ApiError::TooManyTries { wait }),
            Login::Wrong { known } => known,
        };
        if !known {
            by.who.clear();
            by.role.clear();
        }
        tracing::warn!("{wrong}: {:?} from {}", by.who, by.origin);
        let (history, why) = (self.0.history.clone(), Some(wrong.message()));
        let noted = blocking(move || {
            let mut audit = Store::open(&history)?;
            note(&mut audit, by, &json!({ "order": "login" }), why)
        });
        if let Err(error) = noted.await {
            tracing::warn!("the audit of orders lacks a wrong password: {error}");
        }
        Err(wrong)
    }
}

fn by(who: String, role: Option<Role>, origin: String) -> By {
    let role = role.map_or_else(String::new, |it| it.to_string());
    By { who, role, origin }
}
