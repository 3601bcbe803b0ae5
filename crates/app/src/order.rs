//! The order of a lot, and the files that a run uses.

use config::Folder;
use std::path::{Path, PathBuf};

/// Order of a lot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LotOrder {
    /// Name of the lot.
    pub lot: String,
    /// Name of a recipe in `recipes/` of the configuration.
    pub recipe: String,
    /// Number of parts; `None`: the lot continues until a person or a signal stops it.
    pub count: Option<u64>,
    /// Name of the person who agreed to test the lot's parts again; the history keeps the first results too. `None`: no
    /// retest.
    pub retest: Option<String>,
}

/// Configuration and history.
#[derive(Debug, Clone)]
pub struct Files {
    /// Files of the configuration.
    pub config: Folder,
    /// History file.
    pub db: PathBuf,
}

impl Files {
    /// Returns the folder of the history, which also holds the file of people and the traces of alarms.
    pub fn data_folder(&self) -> &Path {
        folder_of(&self.db)
    }
}

/// Returns the folder of a file, `.` for a bare name.
pub(crate) fn folder_of(file: &Path) -> &Path {
    let folder = file.parent().filter(|it| !it.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}
