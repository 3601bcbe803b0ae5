//! Engineers who saved or approved the text of a recipe, read from the audit of orders.

use super::error::{Doing, Result};
use super::{Archive, Moment};
use serde::Serialize;
use std::path::Path;
use utoipa::ToSchema;

/// Number of engineers who must have saved or approved a text, in a plant that requires a second person.
pub const SIGNATURES: usize = 2;

/// Signature of an engineer under the text of a recipe.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Signature {
    /// Name of the engineer.
    pub who: String,
    /// Time at which the engineer first saved or approved the text.
    pub at: Moment,
}

/// Returns the engineers who saved or approved the text with this `hash` as `recipe`, each once, in order of time; none
/// when the file `db` does not exist. A revision made on the command line does not count, because the command line
/// takes a name without a password.
///
/// # Errors
/// Fails when the history in `db` cannot be read.
pub fn signatures(db: &Path, recipe: &str, hash: &str) -> Result<Vec<Signature>> {
    if !db.exists() {
        return Ok(Vec::new());
    }
    let select = "SELECT who, min(at_us) FROM ordered WHERE refused IS NULL AND role = 'engineer'
        AND what ->> '$.order' IN ('revise', 'new_recipe', 'approve')
        AND what ->> '$.recipe' = ?1 AND what ->> '$.hash' = ?2 GROUP BY who ORDER BY 2, 1";
    let read = |row: &rusqlite::Row<'_>| {
        let (who, at_us) = (row.get(0)?, row.get(1)?);
        let at = Moment(at_us);
        Ok(Signature { who, at })
    };
    let archive = Archive::open(db)?;
    (archive.source.file()?.prepare(select))
        .and_then(|mut statement| statement.query_map([recipe, hash], read)?.collect())
        .doing("reading approvals of a recipe")
}
