//! Orders of a person or a program: a lot, and the paths of its files.

use std::path::PathBuf;

/// Order of a lot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LotOrder {
    /// Name of the lot.
    pub lot: String,
    /// Name of a recipe in `recipes/` of the configuration.
    pub recipe: String,
    /// Number of parts; `None`: the lot continues until a stop.
    pub count: Option<u64>,
    /// Name of the person who agreed to a retest of the lot's parts; the history keeps the first results.
    pub retest: Option<String>,
}

/// Paths of configuration and history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    /// Folder of the configuration.
    pub config: PathBuf,
    /// History file.
    pub db: PathBuf,
}
