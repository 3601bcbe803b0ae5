//! Examines a history without changing it: opening a reader would migrate an older schema, and opening a writer would
//! create a missing file.

use super::error::{Doing, Result};
use super::source::Source;
use super::{Archive, CalibrationRecord, SCHEMA, open};
use rusqlite::OptionalExtension;
use std::path::Path;

/// Facts about a history, read after a check that no page of its file is damaged.
#[derive(Debug)]
pub struct Examination {
    /// Schema of the file, from 1 to [`SCHEMA`]; 0 for an empty file.
    pub schema: i64,
    /// True when the history belongs to the simulated rig; `None` before its first run, and with an older schema.
    pub is_simulated: Option<bool>,
    /// Newest calibration of the real rig for each coil voltage; empty with an older schema.
    pub calibrations: Vec<CalibrationRecord>,
}

/// Checks the pages of the file and reads its facts, while other processes may write.
///
/// # Errors
/// Fails when the file is missing, locked or damaged, belongs to another program, or has a schema of a later version.
pub fn examine(path: &Path) -> Result<Examination> {
    let (connection, schema) = open::unchanged(path)?;
    let archive = Archive {
        source: Source::File(connection),
        path: path.to_owned(),
    };
    archive.quick_check()?;
    if schema < SCHEMA {
        return Ok(Examination {
            schema,
            is_simulated: None,
            calibrations: Vec::new(),
        });
    }
    let source = "SELECT source = 'simulated' FROM rig";
    let is_simulated = archive
        .source
        .file()?
        .query_row(source, [], |row| row.get(0));
    Ok(Examination {
        schema,
        is_simulated: is_simulated
            .optional()
            .doing("reading the rig of the history")?,
        calibrations: archive.calibrations(false)?,
    })
}
