//! Imports results that a plant measured outside of the rig: a file, CSV or spreadsheet, is imported whole or not at all,
//! and only once into the same lot.

use super::{Source, records};
use anyhow::Context;
use history::{Entered, EnteredResults, Moment, Store, parse_results, snapshot_hash};
use std::path::Path;

/// Where the results of a file belong.
#[derive(Debug, Clone, Copy)]
pub struct Purpose<'a> {
    /// Name of the lot.
    pub lot: &'a str,
    /// Recipe for which the results are meant; refused when the lot was run with another one.
    pub recipe: Option<&'a str>,
    /// Person who enters them.
    pub who: &'a str,
}

/// Enters the results of a file; the recipe of the lot judges them.
///
/// # Errors
/// Fails with file and line on an unknown column or an invalid cell, on a result that the lot cannot take, on a file that
/// the lot has already, and when the history cannot be written. Then nothing is entered.
pub fn import_results(
    db: &Path,
    source: &Source<'_>,
    purpose: Purpose<'_>,
) -> anyhow::Result<Entered> {
    let name = || source.file.display().to_string();
    let results = parse_results(&records(source).with_context(name)?).with_context(name)?;
    let hash = snapshot_hash(source.bytes);
    let entered = Store::open(db)?.enter_results(&EnteredResults {
        lot: purpose.lot,
        recipe: purpose.recipe,
        who: purpose.who,
        at: Moment(jiff::Timestamp::now().as_microsecond()),
        file_hash: Some(&hash),
        results: &results,
    })?;
    entered.with_context(name)
}
