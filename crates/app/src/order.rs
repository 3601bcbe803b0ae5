//! What a person or a program orders: a lot, and where its files are.

use std::path::PathBuf;

/// Which lot is to be run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LotOrder {
    /// Name of the lot that the parts belong to.
    pub lot: String,
    /// Name of a recipe in `recipes/` of the configuration.
    pub recipe: String,
    /// Parts of the lot; none: the lot goes on until it is stopped.
    pub count: Option<u64>,
    /// Who has agreed that parts of the lot are tested again; the first results stay.
    pub retest: Option<String>,
}

/// Where configuration and history are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    /// Folder of the configuration.
    pub config: PathBuf,
    /// History file.
    pub db: PathBuf,
}
