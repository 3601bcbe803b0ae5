//! Changes of people, each with its line in the audit of orders.

use super::error::{AccessError, Result};
use super::{Register, Role, password};
use history::{HistoryError, OrderRecord, Row, Store};
use jiff::Timestamp;
use machine::view::By;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::Path;
use texts::Message;
use utoipa::ToSchema;

/// A change of a person. No password reaches the audit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "change", rename_all = "lowercase", deny_unknown_fields)]
pub enum PersonChange {
    /// Adds a person.
    Add {
        /// Name for the login, 1 to 40 letters, digits, `.`, `-` or `_`.
        name: String,
        /// Role from now on.
        role: Role,
        /// 8 to 200 characters; the rig draws one when it is absent.
        #[serde(default, skip_serializing)]
        password: Option<String>,
    },
    /// Gives a person another role, also in open sessions.
    Role {
        /// Name of the person.
        name: String,
        /// Role from now on.
        role: Role,
    },
    /// Gives a person a new password, and ends the person's sessions.
    Password {
        /// Name of the person.
        name: String,
        /// 8 to 200 characters; the rig draws one when it is absent.
        #[serde(default, skip_serializing)]
        password: Option<String>,
    },
    /// Forgets the wrong passwords of a person, who may then log in at once.
    Unlock {
        /// Name of the person.
        name: String,
    },
    /// Removes a person with all sessions.
    Remove {
        /// Name of the person.
        name: String,
    },
}

impl PersonChange {
    /// Returns the change as the audit holds it.
    #[must_use]
    pub fn what(&self) -> Value {
        let mut what = json!(self);
        what["order"] = "people".into();
        what
    }

    /// Carries out the change; returns the new password if the rig drew it.
    ///
    /// # Errors
    /// Fails for an unknown person, a taken or malformed name, a password of a wrong length, and when no engineer would
    /// remain.
    pub fn apply(&self, register: &mut Register, now_us: i64) -> Result<Option<String>> {
        match self {
            Self::Add {
                name,
                role,
                password,
            } => {
                let (password, drawn) = given_or_drawn(password.as_ref())?;
                register.add(name, *role, &password, now_us)?;
                Ok(drawn)
            }
            Self::Role { name, role } => register.set_role(name, *role).map(|()| None),
            Self::Password { name, password } => {
                let (password, drawn) = given_or_drawn(password.as_ref())?;
                register.set_password(name, &password)?;
                Ok(drawn)
            }
            Self::Unlock { name } => register.unlock(name).map(|()| None),
            Self::Remove { name } => register.remove(name).map(|()| None),
        }
    }
}

fn given_or_drawn(given: Option<&String>) -> Result<(String, Option<String>)> {
    Ok(match given {
        Some(given) => (given.clone(), None),
        None => {
            let drawn = password::random_hex(8)?;
            (drawn.clone(), Some(drawn))
        }
    })
}

/// Runs `work`, notes it with its outcome in the audit of orders in the history `db`, and returns what `work` returned.
/// For the audit, `what` describes the result of `work` and `refusal` describes its error. Opens the audit first, and
/// does not run `work` when that fails.
///
/// # Errors
/// Fails when the audit does not open, and when `work` succeeds but the audit cannot be written.
pub fn audited<T, E>(
    db: &Path,
    by: By,
    what: impl FnOnce(Option<&T>) -> Value,
    refusal: impl FnOnce(&E) -> Message,
    work: impl FnOnce() -> Result<T, E>,
) -> Result<Result<T, E>> {
    let mut audit = Store::open(db).map_err(AccessError::NoAudit)?;
    let done = work();
    let (what, refused) = (what(done.as_ref().ok()), done.as_ref().err().map(refusal));
    match (note(&mut audit, by, &what, refused), done) {
        (Err(unwritten), Ok(_)) => Err(AccessError::NotAudited(unwritten)),
        (Ok(()) | Err(_), done) => Ok(done),
    }
}

/// Writes a line into the audit of orders.
pub(crate) fn note(
    audit: &mut Store,
    by: By,
    what: &Value,
    refused: Option<Message>,
) -> Result<(), HistoryError> {
    audit.record(&[Row::Order(OrderRecord {
        lot: None,
        at_us: Timestamp::now().as_microsecond(),
        who: by.who,
        role: by.role,
        origin: by.origin,
        what: what.to_string(),
        refused,
    })])
}
