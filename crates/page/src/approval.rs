//! Approval of a recipe by a second engineer, where `[recipes] approval` of `rig.toml` requires it.
//!
//! The text of a recipe needs the signatures of two engineers: one who saved the text and another who approved it, or,
//! for a file edited by hand, two who approved it. Signatures are lines of the audit of orders with the hash of the
//! text, so a text that changes in any way has none. `admission.rs` of crate `app` checks the signatures when a lot
//! starts.

use super::access::{Login, Register, Role, access_path, audited, note};
use super::asked::{Author, Body};
use super::error::{ApiError, JsonResult, blocking};
use super::recipes::ShownRevision;
use super::router::App;
use super::sessions::{now_us, require_role};
use axum::Json;
use axum::extract::State;
use config::{Approval, Folder, Revision};
use history::{SIGNATURES, Signature, Store, signatures};
use machine::view::By;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;
use texts::Message;
use utoipa::ToSchema;

/// Request to approve the newest revision of a recipe.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Approve {
    /// Name of the recipe.
    #[schema(example = "jzc-22f-012")]
    name: String,
    /// Hash of the text that the engineer has read: `hash` of `GET /api/recipes/show`.
    hash: String,
}

/// State of the approval of a revision: the engineers who saved or approved the revision.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct ApprovalState {
    /// True when a lot may use the revision, because enough engineers saved or approved it.
    approved: bool,
    /// Engineers who saved or approved the revision, in order of time.
    signatures: Vec<Signature>,
}

impl ApprovalState {
    /// Returns the approval of a revision; `None` in a plant that requires no approval.
    pub fn read(wanted: Approval, db: &Path, of: &Revision) -> Result<Option<Self>, ApiError> {
        match wanted {
            Approval::None => return Ok(None),
            Approval::SecondPerson => {}
        }
        let signatures = signatures(db, &of.name, &of.hash)?;
        let approved = signatures.len() >= SIGNATURES;
        Ok(Some(Self {
            approved,
            signatures,
        }))
    }

    /// Returns true when a lot may use the revision.
    pub fn is_approved(&self) -> bool {
        self.approved
    }
}

/// `POST /api/recipes/approve`.
pub(super) async fn approve(
    State(app): App,
    author: Author,
    Body(asked): Body<Approve>,
) -> JsonResult<ShownRevision> {
    let (folder, db) = (app.shared.config.clone(), app.shared.db.clone());
    blocking(move || {
        let newest = sign(&folder, &db, &author, &asked)?;
        ShownRevision::read(&folder, &db, newest).map(Json)
    })
    .await
}

/// Approves the newest revision of `recipe` on the command line; returns its number.
///
/// # Errors
/// Fails for a wrong password, a person without the role engineer, an engineer who signed the revision already, and
/// when the revision or the audit of orders cannot be read or written.
pub fn approve_with_password(
    folder: &Folder,
    db: &Path,
    recipe: &str,
    (name, password): (&str, &str),
) -> Result<u32, Message> {
    let approved = || {
        let hash = config::revision(folder, recipe, None)?.hash;
        let mut register = Register::open(&access_path(db))?;
        let origin = "command line".to_owned();
        let person = match register.prove(name, password, now_us())? {
            Login::Right(person) => person,
            Login::Wait(wait) => return Err(ApiError::TooManyTries { wait }),
            Login::Wrong { known } => {
                let who = if known { name } else { "" }.to_owned();
                let role = String::new();
                let why = Some(ApiError::WrongPassword.message());
                let by = By { who, role, origin };
                note(&mut Store::open(db)?, by, &json!({ "order": "login" }), why)?;
                return Err(ApiError::WrongPassword);
            }
        };
        let name = recipe.to_owned();
        sign(
            folder,
            db,
            &Author { person, origin },
            &Approve { name, hash },
        )
    };
    approved().map_or_else(|why| Err(why.message()), |it| Ok(it.number))
}

/// Writes the signature of a person into the audit of orders; returns the approved revision.
fn sign(
    folder: &Folder,
    db: &Path,
    author: &Author,
    asked: &Approve,
) -> Result<Revision, ApiError> {
    let Approve { name, hash } = asked;
    let newest = config::revision(folder, name, None)?;
    let number = newest.number;
    let what = json!({ "order": "approve", "recipe": name, "revision": number, "hash": hash });
    audited(
        db,
        author.by(),
        |_| what,
        ApiError::message,
        || {
            require_role(&author.person, Role::Engineer)?;
            let refused = |code| Err(ApiError::NotApproved { code });
            if newest.hash != *hash {
                return refused("read_newest");
            }
            let signed = signatures(db, name, hash)?;
            match signed.iter().any(|it| it.who == author.person.name) {
                true => refused("signed_already"),
                false => Ok(()),
            }
        },
    )??;
    Ok(newest)
}
