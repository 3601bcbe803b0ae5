//! Why a simulated rig cannot be set up.

use std::path::PathBuf;

use crate::config::ConfigError;

/// A rig or bench that cannot be built or served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// A file of the configuration is missing or wrong.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// `--fault` names something the rig cannot do.
    #[error("fault `{name}` is unknown; `sim --faults` lists them all")]
    UnknownFault {
        /// As given.
        name: String,
    },
    /// The value of a fault does not fit.
    #[error("fault `{name}`: found `{found}`, expected {expected}")]
    FaultValue {
        /// Name of the fault.
        name: String,
        /// Text after `=`.
        found: String,
        /// Form and range.
        expected: String,
    },
    /// No module of that name is simulated.
    #[error("module `{module}`: model `{model}` is not simulated")]
    UnknownModel {
        /// Key of the module's table.
        module: String,
        /// As written.
        model: String,
    },
    /// A key of a module's table has a value that the module cannot take.
    #[error("module `{module}`: `{key}` = {found}, expected {expected}")]
    Setting {
        /// Key of the module's table.
        module: String,
        /// Key inside the table.
        key: String,
        /// As written.
        found: String,
        /// Form and range.
        expected: &'static str,
    },
    /// A bench file cannot be read.
    #[error("bench file {}: {why}", file.display())]
    Bench {
        /// The file.
        file: PathBuf,
        /// What was found and what was expected.
        why: String,
    },
    /// The system gave no pseudo-terminal or link.
    #[error("cannot {what}")]
    Terminal {
        /// What was being done.
        what: String,
        /// The system's reason.
        source: std::io::Error,
    },
}
