//! Reasons why a simulated rig cannot be built or served.

use crate::config::ConfigError;

/// A rig or bench that cannot be built or served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// A file of the configuration is missing or wrong.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// `--fault` names an unknown fault.
    #[error("fault `{name}` is unknown; `sim --faults` lists them all")]
    UnknownFault {
        /// Name from the command line.
        name: String,
    },
    /// The value of a fault has the wrong form or range.
    #[error("fault `{name}`: found `{found}`, expected {expected}")]
    FaultValue {
        /// Name of the fault.
        name: String,
        /// Value from the command line, the text after `=`.
        found: String,
        /// Expected form and range.
        expected: String,
    },
    /// The operating system refuses a pseudo-terminal or a link.
    #[error("cannot {what}")]
    Terminal {
        /// Action that failed.
        what: String,
        /// Reason that the operating system gives.
        source: std::io::Error,
    },
}
